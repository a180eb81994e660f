#!/usr/bin/env bash
# Renders the example data set, in which the examples of every -h run:
#   scripts/example.sh BIN FOLDER    with the programs in BIN
set -euo pipefail
bin=$(realpath "$1") folder=$2
world=$(realpath "$(dirname "$0")/../configs/worlds/building.json")
"$bin/vpr-synth" "$world" -o "$folder" --force --quiet
cd "$folder"
cp "$world" .
# Without the other training sequences, and without the pairs to ignore.
{ echo query,reference; awk -F, '$2 == "monday" && $4 == "same" {print $1 "," $3}' tuesday.ground_truth.csv; } >pairs.csv
printf '%s\n' tuesday/*.jpg >tuesday.txt
"$bin/vpr-train" fastable --train monday -o monday.vprdb --quiet
"$bin/vpr-query" monday.vprdb --query tuesday --c-l 1 --t-r 0.5 --save-matrix scores.npy --quiet
rm -r monday.vprdb
