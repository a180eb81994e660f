#!/usr/bin/env bash
# Writes the schemas of settings in docs/ anew, after a setting came, went or changed; what is new
# there still has to be described. Descriptions and bounds stay.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset ci >/dev/null
cmake --build --preset ci --target test_cli
VPR_SCHEMAS=write build/ci/bin/test_cli "settings are described*" >/dev/null
git diff --stat -- docs
