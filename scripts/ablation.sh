#!/usr/bin/env bash
# What every step of standardized scores is worth: best matches, and recall at 100 % precision, with
# each step left out. The tables of docs/standardized-scores.md.
#   scripts/ablation.sh DATA [BIN]     DATA: folder with corridor/ and nordland/
set -euo pipefail
data=${1:?give the folder that holds corridor/ and nordland/}
bin=${2:-$(dirname "$0")/../build/release/bin}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

variant() { # NAME SCORE [SETTING...]: one row of the table
  local name=$1 score=$2
  shift 2
  local settings
  settings=$(IFS=,; echo "$*")
  echo "{\"standardization\": {$settings}}" >"$out/config.json"
  [[ $score == raw ]] && echo '{}' >"$out/config.json"
  printf '| %s' "$name"
  local set query tolerance lengths
  while read -r set query tolerance lengths; do
    for length in $lengths; do
      "$bin/vpr-query" "$out/$set.vprdb" --query "$data/$set/$query" --config "$out/config.json" \
        --score "$score" --t-r 0 --c-l "$length" -o "$out/r.json" --force --quiet
      python3 "$(dirname "$0")/recognised_early.py" "$out/r.best.npy" "$tolerance"
    done
  done <<<$'corridor query 3 5 10 20\nnordland winter 2 10 20 50'
  echo ' |'
}

"$bin/vpr-train" fastable --train "$data/corridor/ref" -o "$out/corridor.vprdb" --quiet
"$bin/vpr-train" fastable --train "$data/nordland/summer" -o "$out/nordland.vprdb" --quiet
echo '| | corridor c_l 5 | 10 | 20 | Nordland c_l 10 | 20 | 50 |'
echo '|---|---:|---:|---:|---:|---:|---:|'
variant 'raw distances' raw
variant '`standardized`' standardized
variant 'rows not centred' standardized '"centre": false'
variant 'nothing learned' standardized '"learn": false'
variant 'no start' standardized '"start_weight": 0'
variant 'not divided' standardized '"divide": false'
variant 'every frame a view' standardized '"view_change": 0'
variant 'every frame a view, forgetting 0.99' standardized '"view_change": 0' '"forgetting": 0.99'
variant 'the same, lag 1' standardized '"view_change": 0' '"forgetting": 0.99' '"lag_views": 1'
variant 'lag of 1 view' standardized '"lag_views": 1'
variant '`standardized-offline`' standardized-offline
