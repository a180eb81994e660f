#!/usr/bin/env bash
# OpenCV's BFMatcher refuses 262 144 descriptors of one training image.
#   Package: python3-opencv 4.6.0+dfsg-12 (Debian 12).
#   Guess: as many as memory holds; of 32 bytes, these are 8 MiB.
#   Seen: 262 143 rows are matched, 262 144 raise an assertion about IMGIDX_ONE, in match and knnMatch.
#   Indices of images are stored above bit 18. Several images of fewer rows each are accepted.
#
# Makes a minimal Debian 12 with this package in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-opencv bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
[[ $(chroot "$root" dpkg-query -W -f='${Version}' python3-opencv) == 4.6.0+dfsg-12 ]]
echo "python3-opencv 4.6.0+dfsg-12"
chroot "$root" python3 - <<'PYTHON'
import sys

import cv2
import numpy as np

query = np.zeros((1, 32), np.uint8)


def best(counts):
    matcher = cv2.BFMatcher(cv2.NORM_HAMMING)
    matcher.add([np.full((count, 32), i == 0, np.uint8) for i, count in enumerate(counts)])
    try:
        found = matcher.match(query)[0]
        return (found.imgIdx, found.trainIdx)
    except cv2.error as error:
        return error.err


found = {}
for counts in ((2**18 - 1,), (2**18,), (2**18 - 1, 2**18 - 1)):
    found[counts] = best(counts)
    print(f"rows of training images {counts}: {found[counts]}")
one, most, two = found.values()
sys.exit(0 if one == (0, 0) and "IMGIDX_ONE" in most and two == (1, 0) else 1)
PYTHON
