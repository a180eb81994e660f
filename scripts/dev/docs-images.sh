#!/usr/bin/env bash
# Draws README's image from data/example, and those of docs from the rendered small building:
#   scripts/dev/docs-images.sh [BIN]    programs in BIN (default: build/release/bin)
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD
bin=$(realpath "${1:-build/release/bin}")
images=$PWD/docs/images
mkdir -p "$images"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$bin/vpr-synth" configs/worlds/small.json -o "$work/building" --quiet
cd "$work"
"$bin/vpr-train" images --dataset building/dataset.json -o small.vprdb --quiet

# answer NAME FLAG...: queries the database, and evaluates the result with map and plots.
answer() {
  "$bin/vpr-query" small.vprdb --dataset building/dataset.json --query query -o "$1.json" --quiet "${@:2}"
  "$bin/vpr-eval" "$1.json" --dataset building/dataset.json --map "$1.map" --plot "$1.plot" --quiet
}

answer filter
answer varying --speed varying
"$bin/vpr-query" small.vprdb --dataset building/dataset.json --query query --c-l 20 --score zscore --decide margin \
  --save-matrix windows.npy -o windows.json --quiet
"$bin/vpr-eval" windows.json --dataset building/dataset.json --matrix windows.npy --plot windows.plot --quiet

cp filter.map/map.svg "$images/map.svg"
cp varying.plot/timeline.svg "$images/timeline.svg"
cp windows.plot/matrix.png "$images/matrix.png"

cd "$root"
/usr/bin/python3 scripts/dev/example_picture.py "$bin" "$images/example.jpg"
cp -r data/example "$work/example"
cd "$work/example"
"$bin/vpr-train" images --train monday -o corridor.vprdb --quiet
"$bin/vpr-query" corridor.vprdb --query tuesday -o result.json --quiet
"$bin/vpr-eval" result.json --ground-truth pairs.csv --html page.html --quiet
if command -v chromium >/dev/null; then
  chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1280,1470 \
    --screenshot="$work/page.png" "file://$work/example/page.html" >/dev/null 2>&1
  /usr/bin/python3 -c 'import sys; from PIL import Image; Image.open(sys.argv[1]).convert("RGB").save(sys.argv[2], quality=80)' \
    "$work/page.png" "$images/page.jpg"
else
  echo "chromium is missing: $images/page.jpg is not drawn" >&2
fi
du -cb "$images"/*
