#!/usr/bin/env bash
# Writes a folder of golden files with the programs in BIN, of the recording in world.json: for a
# layout that is about to change.   test/golden/make.sh BIN FOLDER
set -euo pipefail
bin=$(realpath "$1") here=$(realpath "$(dirname "$0")")
mkdir "$2"
cd "$2"
"$bin/vpr-synth" "$here/world.json" -o recording --quiet
truth=(--ground-truth "$here/back.ground_truth.csv")
aligned=(--ground-truth aligned --tolerance 3)
"$bin/vpr-train" fastable --train recording/north --train recording/south --c-l 3 -o fastable.vprdb --quiet
"$bin/vpr-train" fabmap --pretrain recording/pretrain --train recording/north --features orb --words 12 \
  -o fabmap.vprdb --quiet
"$bin/vpr-query" fastable.vprdb --query recording/back --c-l 3 --t-r 0.5 -o fastable.json --quiet
"$bin/vpr-query" fabmap.vprdb --query recording/back --t-p 0.3 -o fabmap.json --quiet
"$bin/vpr-eval" fastable.json "${truth[@]}" -o fastable-report.json --quiet
"$bin/vpr-eval" fabmap.json "${aligned[@]}" -o fabmap-report.json --quiet
"$bin/vpr-tune" fastable fastable.vprdb --query recording/back "${truth[@]}" --c-l 2,3 --t-r 0.2,0.3,0.5 \
  -o fastable-sweep.json --quiet
"$bin/vpr-tune" fabmap fabmap.vprdb --query recording/back "${aligned[@]}" --c-w 1,2 --t-p 0.2,0.4 \
  -o fabmap-sweep.json --quiet
rm -r recording
