#!/usr/bin/env bash
# GPSBabel converts an NMEA log of GGA sentences to an empty GPX file, with exit code 0.
#   Package: gpsbabel 1.8.0+ds-5 (Debian 12).
#   Guess: GGA has no date, so the track points have no time, which GPX allows.
#   Seen: every point is dropped ("No date found within track"), the file is valid GPX without a
#   track, and the exit code is 0. With -i nmea,date=20260328 all points are there.
#
# Makes a minimal Debian 12 with this package in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=gpsbabel,python3 bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
[[ $(chroot "$root" dpkg-query -W -f='${Version}' gpsbabel) == 1.8.0+ds-5 ]]
chroot "$root" bash -euo pipefail <<'SCRIPT'
cd "$(mktemp -d)"
python3 - <<'P'
def sentence(text):
    check = 0
    for character in text:
        check ^= ord(character)
    return f"${text}*{check:02X}\r\n"


with open("log.nmea", "w", newline="") as file:
    for second in range(3):
        file.write(sentence(f"GPGGA,1200{second:02d}.00,5200.000{second},N,01300.0000,E,1,08,0.9,40.0,M,45.0,M,,"))
P
points_of() { grep -c '<trkpt' "$1" || true; }
echo "gpsbabel 1.8.0+ds-5"
gpsbabel -i nmea -f log.nmea -o gpx -F without.gpx
echo "exit code $?; $(points_of without.gpx) of 3 points"
gpsbabel -i nmea,date=20260328 -f log.nmea -o gpx -F with.gpx
echo "with a date: $(points_of with.gpx) of 3 points"
[[ $(points_of without.gpx) == 0 && $(points_of with.gpx) == 3 ]]
SCRIPT
