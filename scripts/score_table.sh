#!/usr/bin/env bash
# Raw distances and z-scores on every set of real images, in both directions: percent of correct
# best matches / of windows before the first incorrect one in order of score, as in
# docs/experiments/zscores.md.
#   scripts/score_table.sh DATA [BIN] [SCORE...]   DATA: holds corridor/, nordland/ and loop/
set -euo pipefail
here=$(dirname "$0")
data=$(realpath "${1:?pass the folder with corridor/, nordland/ and loop/}")
bin=${2:-$here/../build/release/bin}
scores=("${@:3}")
[ ${#scores[@]} -gt 0 ] || scores=(raw zscore zscore-offline)
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# name, training sequence, query, tolerance, window lengths
sets="corridor:_ref_trained $data/corridor/ref $data/corridor/query 3 1,2,5,10,20,40,50
corridor:_query_trained $data/corridor/query $data/corridor/ref 3 1,2,5,10,20,40,50
Nordland:_summer_trained $data/nordland/summer $data/nordland/winter 2 1,2,5,10,20,40,50
Nordland:_winter_trained $data/nordland/winter $data/nordland/summer 2 1,2,5,10,20,40,50
Nordland_600-899:_summer_trained $data/nordland/summer@600:900 $data/nordland/winter@600:900 2 1,2,5,10,20,40,50
Nordland_600-899:_winter_trained $data/nordland/winter@600:900 $data/nordland/summer@600:900 2 1,2,5,10,20,40,50
loop:_first_lap_trained $data/loop/images@0:40 $data/loop/images@40:80 3 1,2,5,10,20
loop:_second_lap_trained $data/loop/images@40:80 $data/loop/images@0:40 3 1,2,5,10,20"

echo '| | c_l 1 | 2 | 5 | 10 | 20 | 40 | 50 |'
echo '|---|---:|---:|---:|---:|---:|---:|---:|'
while read -r name train query tolerance lengths; do
  "$bin/vpr-train" fastable --train "$train" -o "$out/train.vprdb" --force --quiet
  for score in "${scores[@]}"; do
    printf '| %s, %s' "${name//_/ }" "$score"
    for length in ${lengths//,/ }; do
      "$bin/vpr-query" "$out/train.vprdb" --query "$query" --score "$score" --t-r 0 \
        --c-l "$length" -o "$out/r.json" --force --quiet
      python3 "$here/recognized_early.py" "$out/r" "$tolerance"
    done
    echo ' |'
  done
done <<<"$sets"
