#!/usr/bin/env bash
# gpxpy's get_location_at returns the next point of a track, not the nearest or an interpolated one.
#   Package: python3-gpxpy 1.5.0-1 (Debian 12).
#   Guess: the nearest of two points, or the position between them.
#   Seen: points at 0, 10 and 20 s; at 0.4 s it is the point of 10 s. With one fix per second, frames
#   get positions that are half a second later on average, 7 m at 50 km/h.
#
# Makes a minimal Debian 12 with this package in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-gpxpy bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
[[ $(chroot "$root" dpkg-query -W -f='${Version}' python3-gpxpy) == 1.5.0-1 ]]
echo "python3-gpxpy 1.5.0-1"
chroot "$root" python3 - <<'PYTHON'
import datetime
import sys

import gpxpy
from gpxpy.gpx import GPXTrackPoint, GPXTrackSegment

start = datetime.datetime(2024, 5, 1, 12, tzinfo=datetime.timezone.utc)
points = [GPXTrackPoint(52 + k / 1000, 13, time=start + datetime.timedelta(seconds=10 * k)) for k in range(3)]
segment = GPXTrackSegment(points)
found = {}
for second in (0, 0.4, 5, 9.6, 10, 10.4):
    location = segment.get_location_at(start + datetime.timedelta(seconds=second))
    found[second] = round((location.latitude - 52) * 1000)
    print(f"at {second} s: the point of {10 * found[second]} s")
sys.exit(0 if found == {0: 0, 0.4: 1, 5: 1, 9.6: 1, 10: 1, 10.4: 2} else 1)
PYTHON
