#!/usr/bin/env bash
# Table 5: OpenABLE's time per query frame on Nordland.
#   tab5.sh [--data DIR]
exec "$(dirname "$0")/run.sh" tab5 "$@"
