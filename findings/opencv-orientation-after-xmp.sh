#!/usr/bin/env bash
# OpenCV ignores the EXIF orientation of a JPEG that has XMP before it.
#
# Guess: the orientation is applied wherever the segment with EXIF is, as ExifTool and Pillow read it.
# Seen (Debian 12, OpenCV 4.6.0, Pillow 9.4.0): both segments are APP1. With EXIF first, imread turns the image; with XMP first, it
# does not. Pillow reads the orientation 6 in both. OpenCV 4.10 is the same.
#
# Makes a minimal Debian 12 with these packages in a temporary folder. Needs root and the package mmdebstrap.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-opencv,python3-pil bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
chroot "$root" dpkg-query -W -f '${Package} ${Version}\n' python3-opencv python3-pil
chroot "$root" python3 - <<'PYTHON'
import os, tempfile
import cv2
from PIL import Image

os.chdir(tempfile.mkdtemp())
exif = Image.Exif()
exif[274] = 6  # turned by 90 degrees
Image.new("L", (32, 16), 128).save("exif.jpg", exif=exif)
jpeg = open("exif.jpg", "rb").read()
at = jpeg.index(b"\xff\xe1")
xmp = b"http://ns.adobe.com/xap/1.0/\0<x:xmpmeta xmlns:x='adobe:ns:meta/'/>"
open("xmp.jpg", "wb").write(jpeg[:at] + b"\xff\xe1" + (len(xmp) + 2).to_bytes(2, "big") + xmp + jpeg[at:])
seen = {name: (Image.open(name).getexif()[274], cv2.imread(name).shape[:2]) for name in ("exif.jpg", "xmp.jpg")}
print("seen:", seen)
assert cv2.__version__ == "4.6.0", cv2.__version__
assert seen == {"exif.jpg": (6, (32, 16)), "xmp.jpg": (6, (16, 32))}, "differs from the statement above"
PYTHON
