#!/usr/bin/env bash
# Builds the Debian package, checks it with lintian, installs it into an empty Debian of this machine's
# release, and runs the examples of every -h there. Needs root and network access; not part of
# scripts/test.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh --package
cmake --preset release >/dev/null
cmake --build --preset release --target package
package=$(realpath "$(ls -t build/release/*.deb | head -1)")
lintian --fail-on error "$package"
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
# The package brings its own dependencies.
release=$(. /etc/os-release && echo "$VERSION_CODENAME")
find /etc/apt -name '*.sources' -exec cat {} + -o -name '*.list' -exec cat {} + |
  mmdebstrap --variant=apt --include=man-db "$release" "$root/debian" - >/dev/null
cp "$package" "$root/debian/vpr-toolkit.deb"
cp test/cli/examples.sh "$root/debian/examples.sh"
chroot "$root/debian" bash -euo pipefail -c '
  export DEBIAN_FRONTEND=noninteractive
  apt-get update -qq
  apt-get install -y -qq --no-install-recommends ./vpr-toolkit.deb >/dev/null
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
  ./examples.sh /usr/bin /usr/share/vpr-toolkit/example'
echo "$package: installs and runs in an empty Debian $release"
