#!/usr/bin/env bash
# Draws the images of README and docs from the rendered small building (configs/worlds/small.json):
#   scripts/docs-images.sh [BIN [DATA]]    programs in BIN (default: build/release/bin)
# With DATA (docs/benchmarks/datasets.md), also README's image, from the loop.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$(realpath "${1:-build/release/bin}")
images=$PWD/docs/images
data=${2:+$(realpath "$2")}
mkdir -p "$images"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$bin/vpr-synth" configs/worlds/small.json -o "$work/building" --quiet
cd "$work"
"$bin/vpr-train" fastable --dataset building/dataset.json -o small.vprdb --quiet

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

if [[ -n $data ]]; then
  ln -s "$data/loop/images" loop
  "$bin/vpr-train" fastable --train loop@0:40 -o loop.vprdb --quiet
  "$bin/vpr-query" loop.vprdb --query loop@40:80 -o loop.json --quiet
  /usr/bin/python3 - "$images/laps.jpg" <<'PYTHON'
import glob, sys
import numpy as np
from PIL import Image, ImageDraw, ImageFont

frames = sorted(glob.glob("loop/*"), key=lambda path: int(path.split("/")[1].split(".")[0]))
matches = {int(query): int(train) for query, train in np.load("loop.recognitions.npy")[:, [0, -1]]}
shown = [11, 14, 17, 23, 29]
width, height, label = 240, 180, 30
canvas = Image.new("RGB", (width * len(shown), 2 * (height + label)), "white")
draw = ImageDraw.Draw(canvas)
font = ImageFont.truetype("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", 15)
for column, query in enumerate(shown):
    for row, (frame, text) in enumerate([(40 + query, "second lap, frame"), (matches[query], "first lap, frame")]):
        at = (column * width, row * (height + label))
        canvas.paste(Image.open(frames[frame]).convert("RGB").resize((width - 4, height), Image.LANCZOS), at)
        draw.text((at[0] + 4, at[1] + height + 5), f"{text} {frame}", fill="black", font=font)
canvas.save(sys.argv[1], quality=85)
PYTHON
fi
du -cb "$images"/*
