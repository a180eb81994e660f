#!/usr/bin/env bash
# COLMAP cuts the names of images at their first blank when it reads a text model.
#   Package: colmap 3.8-1 (Debian 12), installed by this script if it is missing.
#   Guess: names are the rest of the line, or a blank is an error.
#   Seen: "walk 1/0001.jpg" and "walk 2/0001.jpg" both become "walk" with exit code 0 and without a
#   warning, so two images of one model have one name. Files that name frames by images.txt need
#   folders without blanks.
# Exits with 0 if this is still so, otherwise with 1.
set -euo pipefail
package=colmap version=3.8-1
[[ $(dpkg-query -W -f='${Version}' $package 2>/dev/null) == "$version" ]] ||
  apt-get install -y -qq --no-install-recommends "$package=$version" >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir model written
echo 1 SIMPLE_PINHOLE 640 480 500 320 240 >model/cameras.txt
printf '1 1 0 0 0 1 0 0 1 walk 1/0001.jpg\n\n2 1 0 0 0 2 0 0 1 walk 2/0001.jpg\n\n' >model/images.txt
: >model/points3D.txt
echo "$package $(dpkg-query -W -f='${Version}' $package)"
QT_QPA_PLATFORM=offscreen colmap model_converter --input_path model --output_path written --output_type TXT
echo "exit code $?; images.txt as written again:"
names=$(awk '!/^#/ && NF >= 10 {print $10}' written/images.txt)
echo "$names"
[[ $names == $'walk\nwalk' ]]
