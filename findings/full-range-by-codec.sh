#!/usr/bin/env bash
# OpenCV applies the full range of a video for H.264 and HEVC, and ignores it for VP9, AV1 and FFV1.
#
# Guess: the flag of the range is applied for all codecs, or for none.
# Seen (Debian 12, OpenCV 4.6.0, FFmpeg 5.1.9): gray of luma 60 in a video that states full range is read as 60 from H.264 and HEVC,
# but as 51 from VP9, AV1 and FFV1: only the first two have a pixel format of their own for the range. The command
# ffmpeg writes 60 for all. OpenCV 4.10 with FFmpeg 7.1 reads the same.
#
# Makes a minimal Debian 12 with these packages in a temporary folder. Needs root and the package mmdebstrap.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=ffmpeg,python3-opencv bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
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
np.full((3 * 64 * 64) // 2, 128, np.uint8).tofile("raw")
planes = np.fromfile("raw", np.uint8)
planes[:64 * 64] = 60
np.tile(planes, 3).tofile("raw")
for name, encoder in (("H.264", ["libx264", "-qp", "0"]), ("HEVC", ["libx265", "-x265-params", "lossless=1:log-level=none"]),
                      ("VP9", ["libvpx-vp9", "-lossless", "1"]), ("AV1", ["libaom-av1", "-crf", "0", "-cpu-used", "8"]),
                      ("FFV1", ["ffv1"])):
    ffmpeg("-f", "rawvideo", "-pix_fmt", "yuv420p", "-color_range", "pc", "-s", "64x64", "-r", "10", "-i", "raw",
           "-color_range", "pc", "-c:v", *encoder, "v.mkv")
    ffmpeg("-i", "v.mkv", "-frames:v", "1", "v.png")
    seen[name] = (int(cv2.VideoCapture("v.mkv").read()[1][32, 32, 0]), int(cv2.imread("v.png")[32, 32, 0]))
print("seen:", seen)
assert cv2.__version__ == "4.6.0", cv2.__version__
assert seen == {"H.264": (60, 60), "HEVC": (60, 60), "VP9": (51, 60), "AV1": (51, 60), "FFV1": (51, 60)}, "differs from the statement above"
PYTHON
