#!/usr/bin/env bash
# Updates the definitions of settings in docs/schemas/*.schema.json after a setting was added, removed or
# changed. Descriptions and bounds remain; add a description to each new setting.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset ci >/dev/null
cmake --build --preset ci --target test_cli
VPR_SCHEMAS=write build/ci/bin/test_cli "settings are described*" >/dev/null
scripts/check_schemas.py --format
git diff --stat -- docs
