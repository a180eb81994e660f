#!/usr/bin/env bash
# CAP_PROP_POS_MSEC is 0 for the last frames of H.264, HEVC and AV1 in their default encoding.
#
# Guess: the times rise to the last frame, or all of them are wrong.
# Seen (Debian 12, OpenCV 4.6.0, FFmpeg 5.1.9): the times of all frames are right, but those that the decoder returns after the
# last packet have 0: two of x264 and x265, one of SVT-AV1, none without B-frames and of VP9. OpenCV 4.10 is right.
#
# Makes a minimal Debian 12 with these packages in a temporary folder. Needs root and the package mmdebstrap.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=ffmpeg,python3-opencv bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
chroot "$root" dpkg-query -W -f '${Package} ${Version}\n' ffmpeg python3-opencv
chroot "$root" env SVT_LOG=0 python3 - <<'PYTHON'
import os, subprocess, tempfile
import cv2
import numpy as np


def ffmpeg(*words):
    subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-y", *words], check=True, stderr=subprocess.DEVNULL)


os.chdir(tempfile.mkdtemp())
seen = {}
for name, encoder in (("x264", ["libx264"]), ("x264 without B-frames", ["libx264", "-bf", "0"]),
                      ("x265", ["libx265", "-x265-params", "log-level=none"]), ("SVT-AV1", ["libsvtav1"]),
                      ("VP9", ["libvpx-vp9"])):
    ffmpeg("-f", "lavfi", "-i", "testsrc2=s=160x120:r=10:d=6", "-pix_fmt", "yuv420p", "-c:v", *encoder, "v.mp4")
    video, times = cv2.VideoCapture("v.mp4"), []
    while video.grab():
        times.append(round(video.get(cv2.CAP_PROP_POS_MSEC)))
    right = [100 * i for i in range(60)]
    wrong = [i for i in range(60) if times[i] != right[i]]
    assert len(times) == 60 and all(times[i] == 0 for i in wrong)
    seen[name] = wrong
print("seen:", seen)
assert cv2.__version__ == "4.6.0", cv2.__version__
assert seen == {"x264": [58, 59], "x264 without B-frames": [], "x265": [58, 59], "SVT-AV1": [59], "VP9": []}, "differs from the statement above"
PYTHON
