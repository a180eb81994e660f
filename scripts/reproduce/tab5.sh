#!/usr/bin/env bash
# Table 5: OpenABLE's time per query frame on Nordland.
#   tab5.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" tab5 "$@"
