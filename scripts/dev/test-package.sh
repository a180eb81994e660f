#!/usr/bin/env bash
# Builds the Debian packages, checks them with lintian, installs them into an empty Debian of this machine's
# release, and runs the examples of every -h, the Python module, and examples/ with the library for C++ there. Needs root and network access; not part of
# scripts/test.sh.
set -euo pipefail
cd "$(dirname "$0")/../.."
scripts/install-deps.sh --package
cmake --preset release >/dev/null
cmake --build --preset release --target package
programs=$(realpath "$(ls -t build/release/vpr-toolkit_*.deb | head -1)")
module=$(realpath "$(ls -t build/release/python3-vpr-toolkit_*.deb | head -1)")
library=$(realpath "$(ls -t build/release/libvpr-toolkit-dev_*.deb | head -1)")
lintian --fail-on error "$programs" "$module" "$library"
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
# The packages bring their own dependencies.
release=$(. /etc/os-release && echo "$VERSION_CODENAME")
find /etc/apt -name '*.sources' -exec cat {} + -o -name '*.list' -exec cat {} + |
  mmdebstrap --variant=apt --include=man-db "$release" "$root/debian" - >/dev/null
cp "$programs" "$root/debian/vpr-toolkit.deb"
cp "$module" "$root/debian/python3-vpr-toolkit.deb"
cp "$library" "$root/debian/libvpr-toolkit-dev.deb"
cp test/cli/examples.sh "$root/debian/examples.sh"
chroot "$root/debian" bash -euo pipefail -c '
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends ./vpr-toolkit.deb ./python3-vpr-toolkit.deb >/dev/null
  for program in vpr-train vpr-query vpr-eval vpr-tune vpr-bench vpr-synth; do
    $program --version
    $program --help >/dev/null
    man --pager=cat $program >/dev/null
    for file in bash-completion/completions/$program zsh/vendor-completions/_$program \
        fish/vendor_completions.d/$program.fish; do
      test -s /usr/share/$file
    done
  done
  for file in copyright changelog.gz README.md; do test -s /usr/share/doc/vpr-toolkit/$file; done
  ./examples.sh /usr/bin /usr/share/vpr-toolkit/example
  python3 -c "import vpr; print(vpr.__version__)"
  apt-get install -y -qq --no-install-recommends ./libvpr-toolkit-dev.deb g++ cmake make >/dev/null
  cmake -S /usr/share/doc/libvpr-toolkit-dev/examples -B example >/dev/null
  cmake --build example >/dev/null
  cd /usr/share/vpr-toolkit/example
  /example/recognize monday tuesday pairs.csv | tail -2'
echo "$programs, $module, $library: install and run in an empty Debian $release"
