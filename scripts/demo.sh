#!/usr/bin/env bash
# The whole path from images to a table of counts:
#   scripts/demo.sh                  on the photographs of data/example, then on a rendered building with maps
#   scripts/demo.sh DATASET.json     on a data set description of your own
# Results stay in out/demo.
set -euo pipefail
dataset=${1:+$(realpath "$1")}
cd "$(dirname "$0")/.."
scripts/install-deps.sh --build
cmake --preset release >/dev/null
cmake --build --preset release --parallel "$(nproc)" --target vpr-synth vpr-train vpr-query vpr-eval vpr-tune vpr-bench
bin=build/release/bin
out=out/demo
mkdir -p "$out"

if [[ -z $dataset ]]; then
  echo; echo "== photographs of an office corridor: train the first lap, recognize the second, evaluate"
  "$bin/vpr-train" images --train data/example/monday -o "$out/example.vprdb" --force
  "$bin/vpr-query" "$out/example.vprdb" --query data/example/tuesday -o "$out/example.json" --force
  "$bin/vpr-eval" "$out/example.json" --ground-truth data/example/pairs.csv --html "$out/example.html" --force
  echo; echo "== render walks through a small building, for maps"
  "$bin/vpr-synth" configs/worlds/small.json -o "$out/building" --force
  dataset=$out/building/dataset.json
fi

echo; echo "== train"
"$bin/vpr-train" images --dataset "$dataset" -o "$out/demo.vprdb" --force

# Each query's name, and whether it has a ground truth.
mapfile -t queries < <(python3 -c '
import json, sys
for query in json.load(open(sys.argv[1])).get("queries", []):
    print(query["name"], "yes" if "ground_truth" in query else "no", sep="\t")' "$dataset")
for line in "${queries[@]}"; do
  IFS=$'\t' read -r query has_truth <<<"$line"
  file=$out/${query//\//_}
  # A map needs positions of frames.
  map=()
  grep -q '"plan"' "$dataset" && map=(--map "$file.map")
  echo; echo "== query $query, and evaluate"
  "$bin/vpr-query" "$out/demo.vprdb" --dataset "$dataset" --query "$query" -o "$file.json" --force
  if [[ $has_truth == yes ]]; then
    "$bin/vpr-eval" "$file.json" --dataset "$dataset" --html "$file.html" "${map[@]}" -o "$file.report.json" --force
  else
    echo "no ground truth for the evaluation"
  fi
done
echo; echo "Results, reports, maps and pages (*.html) are in $out"
