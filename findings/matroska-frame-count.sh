#!/usr/bin/env bash
# CAP_PROP_FRAME_COUNT of a Matroska video counts frames that do not exist.
#
# Guess: the number of frames, or 0 or -1 if the container does not store it.
# Seen (Debian 12, OpenCV 4.6.0, FFmpeg 5.1.9): 18 frames in 5.3 s at a nominal rate of 10 give 53 in Matroska and 18 in MP4, with the
# same packets; reading ends after 18 in both. FFmpeg itself states no number (nb_frames N/A). OpenCV 4.10 is the same.
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


def ffmpeg(*words):
    subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-y", *words], check=True, stderr=subprocess.DEVNULL)


os.chdir(tempfile.mkdtemp())
ffmpeg("-f", "lavfi", "-i", "testsrc2=s=160x120:r=10:d=6", "-vf", "select='lt(mod(n,10),3)'", "-fps_mode", "vfr",
       "-pix_fmt", "yuv420p", "-c:v", "libx264", "v.mkv")
ffmpeg("-i", "v.mkv", "-c", "copy", "v.mp4")
seen = {}
for name in ("v.mkv", "v.mp4"):
    video, frames = cv2.VideoCapture(name), 0
    count = video.get(cv2.CAP_PROP_FRAME_COUNT)
    while video.grab():
        frames += 1
    probe = subprocess.run(["ffprobe", "-v", "error", "-show_entries", "stream=nb_frames", "-of", "csv=p=0", name],
                           capture_output=True, text=True).stdout.strip()
    seen[name] = (count, frames, probe)
print("seen:", seen)
assert cv2.__version__ == "4.6.0", cv2.__version__
assert seen == {"v.mkv": (53.0, 18, "N/A"), "v.mp4": (18.0, 18, "18")}, "differs from the statement above"
PYTHON
