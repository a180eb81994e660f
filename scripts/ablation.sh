#!/usr/bin/env bash
# The effect of each step of z-score normalization, as a table of docs/experiments/zscores.md:
# percent of correct best matches / of windows before the first incorrect one in order of score.
#   scripts/ablation.sh DATA [BIN]     DATA: folder with corridor/ and nordland/
set -euo pipefail
here=$(dirname "$0")
data=$(realpath "${1:?pass the folder with corridor/ and nordland/}")
bin=${2:-$here/../build/release/bin}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# name, training sequence, query, tolerance, window lengths
sets="corridor $data/corridor/ref $data/corridor/query 3 5,10,20
slow $out/slow-ref.txt $out/slow-query.txt 12 20,40
nordland $data/nordland/summer $data/nordland/winter 2 10,20,50
moving $out/moving-summer.txt $out/moving-winter.txt 2 10,20"

for walk in ref query; do # a quarter of the speed: every frame four times
  for frame in "$data/corridor/$walk"/*; do
    printf '%s\n' "$frame" "$frame" "$frame" "$frame"
  done >"$out/slow-$walk.txt"
done
for season in summer winter; do
  "$bin/vpr-train" fastable --train "$data/nordland/$season" -o "$out/$season.vprdb" --quiet
done
python3 "$here/leave_out_stops.py" "$data/nordland" "$out" summer winter
while read -r name train _; do
  "$bin/vpr-train" fastable --train "$train" -o "$out/$name.vprdb" --quiet
done <<<"$sets"

variant() { # NAME SCORE [SETTING...]: one row
  local row=$1 score=$2
  shift 2
  echo "{\"zscore\": {$(IFS=,; echo "$*")}}" >"$out/config.json"
  printf '| %s' "$row"
  while read -r name _ query tolerance lengths; do
    for length in ${lengths//,/ }; do
      "$bin/vpr-query" "$out/$name.vprdb" --query "$query" --config "$out/config.json" \
        --score "$score" --t-r 0 --c-l "$length" -o "$out/r.json" --force --quiet
      python3 "$here/recognized_early.py" "$out/r" "$tolerance"
    done
  done <<<"$sets"
  echo ' |'
}

echo '| | corridor, c_l 5 | 10 | 20 | slow corridor, 20 | 40 | Nordland, 10 | 20 | 50 | moving, 10 | 20 |'
echo '|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|'
variant 'raw distances' raw
variant '`zscore`' zscore
variant '1 off: rows not centered' zscore '"center": false'
variant '2 off: no components' zscore '"components": 0'
variant '3 off: nothing learned' zscore '"learn": false'
variant '3 off: no start' zscore '"start_weight": 0'
variant '3: all of the bias' zscore '"start_bias": 1'
variant '4 off: one deviation for all' zscore '"divide": false'
variant 'every frame a view' zscore '"keyframe_change": 0'
variant 'every frame a view, lag 1' zscore '"keyframe_change": 0' '"lag_keyframes": 1'
variant 'lag of one view' zscore '"lag_keyframes": 1'
variant 'forgetting 0.99' zscore '"forgetting": 0.99'
variant '`zscore-offline`' zscore-offline
