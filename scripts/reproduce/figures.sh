#!/usr/bin/env bash
# The paper's figures of recognitions along the path, on the plan: out/figures. Those of times are
# drawn by tab6.sh and times.sh.
#   figures.sh [--data DIR]        (VPR_BIN=DIR takes built programs, see run.sh)
exec "$(dirname "$0")/run.sh" figures "$@"
