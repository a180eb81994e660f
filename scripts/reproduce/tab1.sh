#!/usr/bin/env bash
# Table 1 of the paper: FAB-MAP's c_w and t_p on the validation sequences.
#   tab1.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" tab1 "$@"
