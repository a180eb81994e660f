#!/usr/bin/env bash
# The paper's figures of recognitions along the path, on the plan: out/figures. tab6.sh and times.sh
# draw the figures of times.
#   figures.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
exec "$(dirname "$0")/run.sh" figures "$@"
