#!/usr/bin/env bash
# Builds everything with sanitizers for memory errors, undefined behavior and data races, and runs
# all tests. One hour for each on two cores.
#   scripts/dev/sanitizers.sh [asan] [tsan]     default: both
set -euo pipefail
cd "$(dirname "$0")/../.."
scripts/install-deps.sh
presets=("$@")
[[ ${#presets[@]} -gt 0 ]] || presets=(asan tsan)
export ASAN_OPTIONS=detect_leaks=1:abort_on_error=0 UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS="suppressions=$PWD/scripts/dev/tsan.suppressions history_size=7"
export LSAN_OPTIONS="suppressions=$PWD/scripts/dev/lsan.suppressions:print_suppressions=0"
for preset in "${presets[@]}"; do
  echo "== $preset"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  ctest --preset "$preset"
done
