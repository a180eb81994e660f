#!/usr/bin/env bash
# Installs missing dependencies, builds with warnings as errors, and runs all tests. With CI=true, tests
# that lack a program or data fail instead of being skipped.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh ${CI:+--ci}
cmake --preset ci
cmake --build --preset ci --parallel "$(nproc)"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
ctest --preset ci --parallel "$(nproc)" "$@" | tee "$log"
if [[ -n ${CI:-} ]] && grep -q '[*]Skipped' "$log"; then
  echo "test: skipped tests count as failures in CI" >&2
  exit 1
fi
