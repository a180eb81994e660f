#!/usr/bin/env bash
# From nothing to a table of counts:
#   scripts/demo.sh                  on a small generated walk
#   scripts/demo.sh DATASET.json     on a data set description of your own
# Results stay in out/demo.
set -euo pipefail
dataset=${1:+$(realpath "$1")}
cd "$(dirname "$0")/.."
scripts/install-deps.sh
cmake --preset release >/dev/null
cmake --build --preset release
bin=build/release/bin
out=out/demo
mkdir -p "$out"

if [[ -z $dataset ]]; then
  echo; echo "== generate a walk past corridor walls"
  "$bin/vpr-synth" configs/worlds/demo.json -o "$out/walk" --force
  dataset=$out/walk/dataset.json
fi

echo; echo "== train"
"$bin/vpr-train" fastable --dataset "$dataset" -o "$out/demo.vprdb" --force
# A single training sequence has no automatic threshold.
threshold=()
[[ $(python3 -c 'import json,sys; print(len(json.load(open(sys.argv[1]))["train"]))' "$dataset") == 1 ]] &&
  threshold=(--t-r 0.4)

mapfile -t queries < <(python3 -c '
import json, sys
for query in json.load(open(sys.argv[1]))["queries"]: print(query["name"])' "$dataset")
for query in "${queries[@]}"; do
  echo; echo "== query $query, and evaluate"
  "$bin/vpr-query" "$out/demo.vprdb" --dataset "$dataset" --query "$query" "${threshold[@]}" \
    --verify 1000 --save-matrix "$out/$query.png" -o "$out/$query.json" --force
  "$bin/vpr-eval" "$out/$query.json" --dataset "$dataset" -o "$out/$query.report.json" --force
done
echo; echo "Results, reports and pictures of the distances are in $out"
