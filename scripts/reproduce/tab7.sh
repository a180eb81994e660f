#!/usr/bin/env bash
# Table 7: FastABLE's time per query frame on Nordland.
#   tab7.sh [--data DIR]
exec "$(dirname "$0")/run.sh" tab7 "$@"
