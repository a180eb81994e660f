#!/usr/bin/env bash
# Times of section 5 and of figures 10, 11 and 16: frames, places, and the length of the query.
#   times.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" times "$@"
