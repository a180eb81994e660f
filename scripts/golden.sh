#!/usr/bin/env bash
# Recomputes the checksums in test/golden/*.crc after an intended change of numbers; git diff then
# shows which frames changed.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset release >/dev/null
cmake --build --preset release --target test_golden
VPR_GOLDEN=write build/release/bin/test_golden "*golden file*" >/dev/null
git diff --stat -- test/golden
