#!/usr/bin/env bash
# FFmpeg 5.1 shows the frames that an MP4 edit list hides, but only of AV1.
#
# Guess: hiding frames is the work of the container, so all codecs show the same frames of a trimmed video.
# Seen (Debian 12, OpenCV 4.6.0, FFmpeg 5.1.9): of 60 frames with 2 of 6 s trimmed, the command ffmpeg, ffprobe and OpenCV show 40
# for H.264, HEVC and VP9, but 60 for AV1 (libdav1d). FFmpeg 7.1 shows 40 for all.
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


def ffmpeg(*words):
    subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-y", *words], check=True, stderr=subprocess.DEVNULL)


os.chdir(tempfile.mkdtemp())
seen = {}
for name, encoder in (("H.264", ["libx264"]), ("HEVC", ["libx265", "-x265-params", "log-level=none"]),
                      ("VP9", ["libvpx-vp9"]), ("AV1", ["libsvtav1"])):
    ffmpeg("-f", "lavfi", "-i", "testsrc2=s=160x120:r=10:d=6", "-pix_fmt", "yuv420p", "-c:v", *encoder, "v.mp4")
    ffmpeg("-ss", "2", "-i", "v.mp4", "-c", "copy", "trimmed.mp4")
    ffmpeg("-i", "trimmed.mp4", "-fps_mode", "passthrough", "-f", "framemd5", "sums")
    video, frames = cv2.VideoCapture("trimmed.mp4"), 0
    while video.grab():
        frames += 1
    probe = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames",
                            "-of", "csv=p=0", "trimmed.mp4"], capture_output=True, text=True).stdout
    seen[name] = (sum(not line.startswith("#") for line in open("sums")), int(probe), frames)
print("seen:", seen)
assert cv2.__version__ == "4.6.0", cv2.__version__
assert seen == {"H.264": (40, 40, 40), "HEVC": (40, 40, 40), "VP9": (40, 40, 40), "AV1": (60, 60, 60)}, "differs from the statement above"
PYTHON
