#!/usr/bin/env bash
# Table 4: OpenABLE on PUT MC, with and without people.
#   tab4.sh [--data DIR]
exec "$(dirname "$0")/run.sh" tab4 "$@"
