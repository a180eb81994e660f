#!/usr/bin/env bash
# COLMAP cuts the names of images at their first blank when it reads a text model.
#   Package: colmap 3.8-1 (Debian 12).
#   Guess: names are the rest of the line, or a blank is an error.
#   Seen: "walk 1/0001.jpg" and "walk 2/0001.jpg" both become "walk" with exit code 0 and without a
#   warning, so two images of one model have one name. Files that name frames by images.txt need
#   folders without blanks.
#
# Makes a minimal Debian 12 with this package in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=colmap bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
[[ $(chroot "$root" dpkg-query -W -f='${Version}' colmap) == 3.8-1 ]]
chroot "$root" bash -euo pipefail <<'SCRIPT'
cd "$(mktemp -d)"
mkdir model written
echo 1 SIMPLE_PINHOLE 640 480 500 320 240 >model/cameras.txt
printf '1 1 0 0 0 1 0 0 1 walk 1/0001.jpg\n\n2 1 0 0 0 2 0 0 1 walk 2/0001.jpg\n\n' >model/images.txt
: >model/points3D.txt
echo "colmap 3.8-1"
QT_QPA_PLATFORM=offscreen colmap model_converter --input_path model --output_path written --output_type TXT
echo "exit code $?; images.txt as written again:"
names=$(awk '!/^#/ && NF >= 10 {print $10}' written/images.txt)
echo "$names"
[[ $names == $'walk\nwalk' ]]
SCRIPT
