#!/usr/bin/env bash
# OpenCV scales a PGM or PPM whose white is less than 255 if it is text (P2, P3), but not if it is binary (P5, P6).
#
# Guess: the same image gives the same pixels in both forms: scaled, or as stored.
# Seen (Debian 12, OpenCV 4.6.0): values 0, 5, 10 and 15 of 15 are read as 0, 85, 170 and 255 from text, and as 0, 5, 10 and 15
# from bytes. OpenCV 4.10 is the same.
#
# Makes a minimal Debian 12 with these packages in a temporary folder. Needs root and the package mmdebstrap.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-opencv bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
chroot "$root" dpkg-query -W -f '${Package} ${Version}\n' python3-opencv
chroot "$root" python3 - <<'PYTHON'
import os, tempfile
import cv2

os.chdir(tempfile.mkdtemp())
levels = [0, 5, 10, 15]
numbers = " ".join(map(str, levels)).encode()
files = {"P2": b"P2 4 1 15\n" + numbers, "P5": b"P5 4 1 15\n" + bytes(levels),
         "P3": b"P3 4 1 15\n" + b" ".join(b"%d" % v for v in levels for _ in range(3)),
         "P6": b"P6 4 1 15\n" + bytes(v for v in levels for _ in range(3))}
seen = {}
for kind, text in files.items():
    open("image.pnm", "wb").write(text + (b"\n" if kind in ("P2", "P3") else b""))
    seen[kind] = cv2.imread("image.pnm", cv2.IMREAD_GRAYSCALE)[0].tolist()
print("seen:", seen)
assert cv2.__version__ == "4.6.0", cv2.__version__
scaled = [0, 85, 170, 255]
assert seen == {"P2": scaled, "P5": levels, "P3": scaled, "P6": levels}, "differs from the statement above"
PYTHON
