#!/usr/bin/env bash
# Updates the settings in docs/schemas/settings.txt after a setting was added, removed or changed, and writes
# docs/schemas/*.schema.json. Descriptions and bounds remain; the description of a new setting is its help.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset release >/dev/null
cmake --build --preset release --target test_cli
VPR_SCHEMAS=write build/release/bin/test_cli "settings are described*" >/dev/null
scripts/schemas.py
git diff --stat -- docs
