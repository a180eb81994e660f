#!/usr/bin/env bash
# SciPy's Rotation.from_matrix turns a mirror image, and even zeros, into half turns without a word.
#   Package: python3-scipy 1.10.1-2 (Debian 12).
#   Guess: a matrix with determinant -1 or 0 is refused, or the nearest rotation is returned, which
#   for diag(1, 1, -1) is the identity or another rotation that keeps x and y.
#   Seen: diag(1, 1, -1) becomes diag(1, -1, -1), a half turn around x, which flips y; zeros become
#   the same half turn. A left-handed matrix in a trajectory is therefore not noticed, and its angle
#   to the unmirrored pose is 180 degrees.
#
# Makes a minimal Debian 12 with this package in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-scipy bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
[[ $(chroot "$root" dpkg-query -W -f='${Version}' python3-scipy) == 1.10.1-2 ]]
chroot "$root" bash -euo pipefail <<'SCRIPT'
cd "$(mktemp -d)"
echo "python3-scipy 1.10.1-2"
python3 - <<'P'
import sys

import numpy
from scipy.spatial.transform import Rotation

half_turn = numpy.diag([1.0, -1.0, -1.0])
are_same = []
for name, matrix in (("diag(1, 1, -1)", numpy.diag([1.0, 1.0, -1.0])), ("zeros", numpy.zeros((3, 3)))):
    found = Rotation.from_matrix(matrix)
    print(f"{name}: determinant {numpy.linalg.det(matrix):g}, becomes {found.as_matrix().round(6).tolist()}, "
          f"an angle of {numpy.degrees(found.magnitude()):g} degrees")
    are_same.append(numpy.allclose(found.as_matrix(), half_turn))
sys.exit(0 if all(are_same) else 1)
P
SCRIPT
