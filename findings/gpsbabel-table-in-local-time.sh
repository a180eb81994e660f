#!/usr/bin/env bash
# GPSBabel's CSV (unicsv) has the local time of the machine, and does not say so.
#   Package: gpsbabel 1.8.0+ds-5 (Debian 12).
#   Guess: Date and Time are UTC, as in the NMEA log and in GPX of the same program.
#   Seen: one log gives 12:00:00.500 or 21:00:00.500, depending on TZ; there is no column or comment
#   with the zone. The option utc=0 of the format gives UTC.
#
# Makes a minimal Debian 12 with this package in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=gpsbabel,python3,tzdata bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
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
        file.write(sentence(f"GPRMC,1200{second:02d}.50,A,5200.000{second},N,01300.0000,E,0.5,0.0,280326,,,A"))
P
export_at() { TZ=$1 gpsbabel -t -i nmea -f log.nmea -o "unicsv$2" -F log.csv && sed -n '1p;2p' log.csv | tr -d '\r'; }
echo "gpsbabel 1.8.0+ds-5; the log begins at 12:00:00.50 UTC"
for zone in UTC Asia/Tokyo; do
  echo "TZ=$zone"
  export_at "$zone" ""
done
echo "TZ=Asia/Tokyo, utc=0"
export_at Asia/Tokyo ,utc=0
[[ $(export_at UTC "" | tail -1) == *12:00:00.500 && $(export_at Asia/Tokyo "" | tail -1) == *21:00:00.500 &&
  $(export_at Asia/Tokyo ,utc=0 | tail -1) == *12:00:00.500 ]]
SCRIPT
