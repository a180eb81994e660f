#!/usr/bin/env bash
# Installs missing dependencies (Debian 12 and 13).
#   scripts/install-deps.sh            build and test
#   scripts/install-deps.sh --build    build only, as the demo does
#   scripts/install-deps.sh --check    also those of scripts/check.sh
#   scripts/install-deps.sh --ci       also those of tests that are skipped without them
#   scripts/install-deps.sh --package  also those of building and testing the Debian package
#   scripts/install-deps.sh --cluster  also those of trees of experiments (scripts/workflow/README.md)
#   scripts/install-deps.sh --arm64    also those of scripts/dev/test-arm64.sh
#   scripts/install-deps.sh --libraries  installs nothing, prints the packages that programs and tests link
set -euo pipefail
libraries=(
  libopencv-dev libavformat-dev libavcodec-dev libswscale-dev libtbb-dev libhwy-dev libxxhash-dev libspdlog-dev libzip-dev zlib1g-dev librsvg2-dev
  libcli11-dev nlohmann-json3-dev
  libdlib-dev libblas-dev liblapack-dev # the first links the others, but does not depend on them
)
[[ ${1:-} == --libraries ]] && { echo "${libraries[@]}" catch2; exit 0; }
packages=(g++ cmake ninja-build pkg-config git "${libraries[@]}")
[[ ${1:-} == --build ]] || packages+=(catch2 inotify-tools unzip python3-jsonschema python3-numpy python3-scipy python3-h5py python3-joblib python3-pil
  python3-dev pybind11-dev python3-matplotlib python3-pytest mypy)
[[ ${1:-} == --check ]] && packages+=(clang-format clang-tidy)
[[ ${1:-} == --ci ]] && packages+=(chromium python3-pandas snakemake)
[[ ${1:-} == --package ]] && packages+=(dpkg-dev file lintian mmdebstrap)
[[ ${1:-} == --cluster ]] && packages+=(snakemake)
[[ ${1:-} == --arm64 ]] && packages+=(crossbuild-essential-arm64 mmdebstrap qemu-user-static)

missing=()
for package in "${packages[@]}"; do
  [[ $(dpkg-query -W -f='${Status}' "$package" 2>/dev/null) == "install ok installed" ]] ||
    missing+=("$package")
done
[[ ${#missing[@]} == 0 ]] && exit 0

if ! command -v apt-get >/dev/null; then
  echo "install-deps: apt-get is missing; install these packages manually: ${missing[*]}" >&2
  exit 1
fi
as_root=()
if [[ $(id -u) != 0 ]]; then
  command -v sudo >/dev/null || { echo "install-deps: run as root, or install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "install-deps: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
