#!/usr/bin/env bash
# SciPy's Rotation.from_matrix turns a mirror image, and even zeros, into half turns without a word.
#   Package: python3-scipy 1.10.1-2 (Debian 12), installed by this script if it is missing.
#   Guess: a matrix with determinant -1 or 0 is refused, or the nearest rotation is returned, which
#   for diag(1, 1, -1) is the identity or another rotation that keeps x and y.
#   Seen: diag(1, 1, -1) becomes diag(1, -1, -1), a half turn around x, which flips y; zeros become
#   the same half turn. A left-handed matrix in a trajectory is therefore not noticed, and its angle
#   to the unmirrored pose is 180 degrees.
# Exits with 0 if this is still so, otherwise with 1.
set -euo pipefail
package=python3-scipy version=1.10.1-2
[[ $(dpkg-query -W -f='${Version}' $package 2>/dev/null) == "$version" ]] ||
  apt-get install -y -qq --no-install-recommends "$package=$version" >/dev/null
echo "$package $(dpkg-query -W -f='${Version}' $package)"
/usr/bin/python3 - <<'P'
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
