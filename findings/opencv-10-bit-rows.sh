#!/usr/bin/env bash
# OpenCV 4.10 leaves the last three rows of 10-bit 4:2:0 frames unwritten.
#
# Guess: 10-bit color is reduced to 8 bits in all rows, or not read.
# Seen (Debian 13, OpenCV 4.10.0, FFmpeg 7.1): if the height is not a multiple of the coding block (1080, 120), the last three rows
# hold what was in memory before; with 128 rows, all rows are those of ffmpeg. OpenCV 4.6 with FFmpeg 5.1 writes all
# rows, the last three with up to 5 levels of the padding below.
#
# Makes a minimal Debian 13 with these packages in a temporary folder. Needs root and the package mmdebstrap.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=ffmpeg,python3-opencv trixie "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
chroot "$root" dpkg-query -W -f '${Package} ${Version}\n' ffmpeg python3-opencv
chroot "$root" python3 - <<'PYTHON'
import os, subprocess, tempfile
import cv2
import numpy as np


def ffmpeg(*words):
    subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-y", *words], check=True, stderr=subprocess.DEVNULL)


os.chdir(tempfile.mkdtemp())
seen = {}
for size in ("1920x1080", "160x120", "160x128"):
    ffmpeg("-f", "lavfi", "-i", f"testsrc2=s={size}:r=10:d=0.5", "-pix_fmt", "yuv420p10le", "-c:v", "libx264", "v.mp4")
    ffmpeg("-i", "v.mp4", "-f", "rawvideo", "-pix_fmt", "bgr24", "raw")
    width, height = map(int, size.split("x"))
    right = np.fromfile("raw", np.uint8).reshape(-1, height, width, 3)
    video = cv2.VideoCapture("v.mp4")
    frames = np.array([video.read()[1] for _ in right])
    far = np.abs(frames.astype(int) - right) > 20
    seen[size] = [int(row) for row in np.flatnonzero(far.any(axis=(0, 2, 3)))]
print("seen:", seen)
assert cv2.__version__ == "4.10.0", cv2.__version__
assert seen == {"1920x1080": [1077, 1078, 1079], "160x120": [117, 118, 119], "160x128": []}, "differs from the statement above"
PYTHON
