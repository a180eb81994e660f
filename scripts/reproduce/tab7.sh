#!/usr/bin/env bash
# Table 7: FastABLE's time per query frame on Nordland.
#   tab7.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" tab7 "$@"
