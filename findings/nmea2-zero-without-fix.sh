#!/usr/bin/env bash
# pynmea2 gives latitude 0 and longitude 0 for sentences without a fix.
#   Package: python3-nmea2 1.15.0-4 (Debian 12).
#   Guess: None or NaN, or an error.
#   Seen: RMC with status V and GGA with quality 0, both with empty positions, become 0.0, 0.0: a
#   point in the sea near Africa. Frames before the first fix are then all at one place.
#
# Makes a minimal Debian 12 with this package in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-nmea2 bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
[[ $(chroot "$root" dpkg-query -W -f='${Version}' python3-nmea2) == 1.15.0-4 ]]
echo "python3-nmea2 1.15.0-4"
chroot "$root" python3 - <<'PYTHON'
import sys

import pynmea2


def parsed(text):
    check = 0
    for character in text:
        check ^= ord(character)
    return pynmea2.parse(f"${text}*{check:02X}")


found = []
for text in ("GPRMC,120000.00,V,,,,,,,010524,,,N", "GPGGA,120000.00,,,,,0,00,,,M,,M,,"):
    sentence = parsed(text)
    found.append((sentence.latitude, sentence.longitude))
    print(f"{text}: {found[-1]}")
sys.exit(0 if found == [(0.0, 0.0)] * 2 else 1)
PYTHON
