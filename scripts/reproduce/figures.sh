#!/usr/bin/env bash
# The paper's figures: recognition paths on the plan, and times against database size and window.
#   figures.sh [--data DIR]        (VPR_BIN=DIR takes built programs, see run.sh)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
"$here/run.sh" figures "$@"
bin=${VPR_BIN:-$root/build/release/bin}
out=$root/out/figures
mkdir -p "$out"
echo "timing FAB-MAP and OpenABLE for out/figures/fabmap-time and matching-time" >&2
# Time and frames a second against places (FAB-MAP), and against frames and c_l; CPU at 10 Hz.
"$bin/vpr-bench" fabmap --places 100,1000,10000,100000 --descriptors 0 --plot "$out/fabmap-time" -o "$out/fabmap-time.json" --force
"$bin/vpr-bench" matching --databases 500,1000,2000,4000,8000 --c-l 20,40,60,80 --plot "$out/matching-time" -o "$out/matching-time.json" --force
