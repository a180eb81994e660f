#!/usr/bin/env bash
# Computes the checksums in test/golden/*.crc anew, for a change of numbers that is meant; git diff
# then shows which frames changed.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset ci >/dev/null
cmake --build --preset ci --target test_golden
VPR_GOLDEN=write build/ci/bin/test_golden "*stand in the file*" >/dev/null
git diff --stat -- test/golden
