#!/usr/bin/env bash
# Builds the programs and writes every generated file again; git diff shows what changed:
#   docs/schemas/*.schema.json        from the fields of structs
#   docs/reference/command-line.md    from --help
#   docs/reference/python.md          from the docstrings of vpr
#   docs/images                       from data/example and the rendered small building
#   test/golden/*.crc                 checksums of numbers
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh
export PATH=/usr/bin:$PATH  # the Python of these packages
cmake --preset release >/dev/null
cmake --build --preset release --target all test_fields test_golden
bin=build/release/bin
VPR_SCHEMAS=write "$bin/test_fields" >/dev/null
scripts/dev/command_line.py
scripts/dev/python_reference.py
scripts/dev/docs-images.sh "$bin"
VPR_GOLDEN=write "$bin/test_golden" "*golden file*" >/dev/null
git diff --stat -- docs test/golden
