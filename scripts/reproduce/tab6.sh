#!/usr/bin/env bash
# Table 6: speed-up of FastABLE over OpenABLE.
#   tab6.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" tab6 "$@"
