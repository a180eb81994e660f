#!/usr/bin/env bash
# Builds the Debian package, installs it into an empty Debian of this machine's release, and runs it there:
# programs, completions, manual pages. Needs root and network access; not part of scripts/test.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh --package
cmake --preset release >/dev/null
cmake --build --preset release --target package
package=$(realpath "$(ls -t build/release/*.deb | head -1)")
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
# The package brings its own dependencies.
release=$(. /etc/os-release && echo "$VERSION_CODENAME")
find /etc/apt -name '*.sources' -exec cat {} + -o -name '*.list' -exec cat {} + |
  mmdebstrap --variant=apt --include=bash-completion,man-db "$release" "$root/debian" - >/dev/null
cp "$package" "$root/debian/vpr-toolkit.deb"
cp configs/worlds/small.json "$root/debian/small.json"
chroot "$root/debian" bash -euo pipefail -c '
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends ./vpr-toolkit.deb >/dev/null
  for program in vpr-train vpr-query vpr-eval vpr-tune vpr-bench vpr-synth; do
    $program --version
    $program --help >/dev/null
    man --pager=cat $program >/dev/null
    test -s /usr/share/bash-completion/completions/$program
  done
  vpr-synth small.json -o building --quiet
  vpr-train fastable --dataset building/dataset.json -o building.vprdb --quiet
  vpr-query building.vprdb --dataset building/dataset.json -o result.json
  vpr-eval result.json --dataset building/dataset.json'
echo "$package: installs and runs in an empty Debian $release"
