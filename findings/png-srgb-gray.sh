#!/usr/bin/env bash
# The chunk sRGB of a PNG changes what imread returns in gray, but not in color.
#
# Guess: the chunk changes nothing, or both: reading in gray is reading in color and converting.
# Seen (Debian 12, OpenCV 4.6.0): the same pixels with and without the chunk are equal in color. In gray, they differ by
# -11 to +60 levels (random colors), because libpng converts to gray in linear light if the file states its gamma.
# OpenCV 4.10 is the same.
#
# Makes a minimal Debian 12 with these packages in a temporary folder. Needs root and the package mmdebstrap.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-opencv bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
chroot "$root" dpkg-query -W -f '${Package} ${Version}\n' python3-opencv
chroot "$root" python3 - <<'PYTHON'
import os, struct, tempfile, zlib
import cv2
import numpy as np

os.chdir(tempfile.mkdtemp())
image = np.random.default_rng(1).integers(0, 256, (64, 64, 3), dtype=np.uint8)
cv2.imwrite("plain.png", image)
png = open("plain.png", "rb").read()
at = png.index(b"IDAT") - 4
open("srgb.png", "wb").write(png[:at] + b"\0\0\0\1sRGB\0" + struct.pack(">I", zlib.crc32(b"sRGB\0")) + png[at:])
converted = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(int)
seen = {}
for name in ("plain.png", "srgb.png"):
    difference = cv2.imread(name, cv2.IMREAD_GRAYSCALE).astype(int) - converted
    seen[name] = (bool((cv2.imread(name) == image).all()), int(difference.min()), int(difference.max()))
print("seen:", seen)
assert cv2.__version__ == "4.6.0", cv2.__version__
assert seen == {"plain.png": (True, -1, 0), "srgb.png": (True, -11, 60)}, "differs from the statement above"
PYTHON
