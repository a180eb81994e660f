#!/usr/bin/env bash
# Table 2: FAB-MAP on the test sequences.
#   tab2.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" tab2 "$@"
