#!/usr/bin/env bash
# Table 3: OpenABLE's c_l and t_r on PUT LC, with the recognitions of the text.
#   tab3.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" tab3 "$@"
