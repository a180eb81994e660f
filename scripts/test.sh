#!/usr/bin/env bash
# Installs missing dependencies, builds, and runs all tests, with the objects of scripts/demo.sh. With CI=true,
# warnings are errors, and tests that lack a program or data fail instead of being skipped.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh ${CI:+--ci}
cmake --preset release -DVPR_WERROR="${CI:+ON}"
cmake --build --preset tests --parallel "$(nproc)"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
ctest --preset tests --parallel "$(nproc)" "$@" | tee "$log"
if [[ -n ${CI:-} ]] && grep -q '[*]Skipped' "$log"; then
  echo "test: skipped tests count as failures in CI" >&2
  exit 1
fi
