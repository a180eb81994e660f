#!/usr/bin/env bash
# Checks what README claims about the images of data/example, in seconds:
#   scripts/check-claims.sh [BIN [EXAMPLE]]    programs in BIN (default: build/release/bin)
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
PATH=$(realpath "${1:-$root/build/release/bin}"):$PATH
example=$(realpath "${2:-$root/data/example}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$example/." "$work"
cd "$work"

failed=0
# claim TEXT PART COMMAND...: the command prints the part.
claim() {
  local text=$1 part=$2 printed
  shift 2
  printed=$("$@" 2>&1 | tr '\n' ' ' | tr -s ' ') || true
  if [[ $printed == *"$part"* ]]; then
    echo "yes  $text"
  else
    echo "NO   $text: expected \"$part\", found: $printed"
    failed=1
  fi
}
query() { vpr-query corridor.vprdb "$@"; }
# judge FLAG...: the numbers of a query with these flags.
judge() {
  query --query tuesday "$@" --quiet --force -o result.json
  vpr-eval result.json --ground-truth pairs.csv
}
same_bytes() {
  query --query tuesday --threads 1 --quiet --force -o one.json
  query --query tuesday --threads 4 --quiet --force -o four.json
  cmp one.npz four.npz
  echo equal
}
# A camera that stands still, at every fifth frame of the lap.
standing() {
  local frame recognized=0
  for frame in tuesday/*[05].jpg; do
    for _ in {1..60}; do echo "$frame"; done >still.txt
    [[ $(query --query still.txt) == "Recognized none of 60"* ]] || ((++recognized))
  done
  echo "$recognized recognized"
}

vpr-train images --train monday -o corridor.vprdb --quiet
claim "filter: 40 of 40 frames of the second lap, 0 wrong" \
  "40 of 40 frames recognized, all correctly" judge
claim "FastABLE (c_l 20, t_r 0.7): 19 of 40, 0 wrong" \
  "19 of 40 frames recognized, all correctly" judge --c-l 20 --t-r 0.7
claim "z-score windows (c_l 20): 15 of 40, 0 wrong" \
  "15 of 40 frames recognized, all correctly" judge --c-l 20 --score zscore --decide margin
claim "a sweep of windows names the filter's numbers" "the filter, recognizes 40 correctly and 0 incorrectly" \
  vpr-tune fastable corridor.vprdb --query tuesday --ground-truth pairs.csv
claim "half the speed: 80 of 80 frames, 0 wrong" "80 of 80 frames recognized, all correctly" judge --speed 0.5
claim "1.5 times the speed: none, the lap is too short" "None of 27 frames recognized" judge --speed 1.5
claim "the way back: none, and the query says so" "opposite direction" query --query tuesday --speed reversed
claim "a camera that stands still at 8 places, 60 frames each: none" "0 recognized" standing
vpr-synth "$root/configs/worlds/building.json" -o building --quiet
claim "another building (rendered, 121 frames): none" "Recognized none of 121" query --query building/tuesday
claim "1 and 4 threads: the same bytes" equal same_bytes
exit $failed
