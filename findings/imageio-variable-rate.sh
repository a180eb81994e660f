#!/usr/bin/env bash
# imageio reads 60 frames of a video that has 42.
#   Package: python3-imageio 2.4.1-5 (Debian 12), with ffmpeg.
#   Guess: the frames of the file, as OpenCV reads them.
#   Seen: phones record at a variable rate. Gaps are filled with copies of earlier frames, to a
#   constant rate of 30 per second, so frame numbers differ from those of OpenCV and ffprobe.
#
# Makes a minimal Debian 12 with these packages in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-imageio,python3-opencv,ffmpeg bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
[[ $(chroot "$root" dpkg-query -W -f='${Version}' python3-imageio) == 2.4.1-5 ]]
echo "python3-imageio 2.4.1-5"
chroot "$root" python3 - <<'PYTHON'
import os
import subprocess
import sys
import tempfile

import cv2
import imageio

os.chdir(tempfile.mkdtemp())
gaps = "select='not(between(mod(n\\,10)\\,4\\,6))'"
subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-f", "lavfi", "-i", "testsrc2=s=64x48:r=30:d=2", "-vf", gaps,
                "-vsync", "vfr", "v.mp4"], check=True)
stored = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames", "-of",
                         "csv=p=0", "v.mp4"], check=True, capture_output=True, text=True)
video = cv2.VideoCapture("v.mp4")
found = {"ffprobe": int(stored.stdout), "OpenCV": 0, "imageio": 0}
while video.read()[0]:
    found["OpenCV"] += 1
frames = list(imageio.get_reader("v.mp4", "ffmpeg"))
found["imageio"] = len(frames)
copies = sum((a == b).all() for a, b in zip(frames, frames[1:]))
print(f"frames: {found}; {copies} of imageio's equal the one before")
sys.exit(0 if found == {"ffprobe": 42, "OpenCV": 42, "imageio": 60} and copies >= 18 else 1)
PYTHON
