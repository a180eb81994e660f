#!/usr/bin/env bash
# Table 4: OpenABLE on PUT MC, with and without people.
#   tab4.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" tab4 "$@"
