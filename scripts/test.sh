#!/usr/bin/env bash
# Installs missing dependencies, builds with warnings as errors, and runs all tests.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh
cmake --preset ci
cmake --build --preset ci --parallel "$(nproc)"
ctest --preset ci "$@"
