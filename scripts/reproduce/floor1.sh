#!/usr/bin/env bash
# The first floor of PUT MC with the automatic threshold, for four window lengths.
#   floor1.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" floor1 "$@"
