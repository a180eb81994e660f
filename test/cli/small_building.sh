#!/usr/bin/env bash
# The counts of the small building have not changed, for both methods, from pixels to report.
#   small_building.sh SOURCE BIN
set -euo pipefail
source=$1 bin=$2
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
data=$out/building/dataset.json
"$bin/vpr-synth" "$source/configs/worlds/small.json" -o "$out/building" --quiet
"$bin/vpr-train" fastable --dataset "$data" --c-l 20 -o "$out/s.vprdb" --quiet
"$bin/vpr-train" fabmap --dataset "$data" --words 300 -o "$out/f.vprdb" --quiet
for method in fastable openable; do
  "$bin/vpr-query" "$out/s.vprdb" --dataset "$data" --c-l 20 --method "$method" --verify 1000 -o "$out/$method.json" --quiet
  "$bin/vpr-eval" "$out/$method.json" --dataset "$data" --expect "$source/configs/expected/small-fastable.json"
done
"$bin/vpr-query" "$out/f.vprdb" --dataset "$data" --c-w 3 --t-p 0.99 -o "$out/f.json" --quiet
"$bin/vpr-eval" "$out/f.json" --dataset "$data" --expect "$source/configs/expected/small-fabmap.json" --html "$out/f.html"
