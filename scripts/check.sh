#!/usr/bin/env bash
# What must be green before a commit: format, layers, static analysis, build, tests.
#   scripts/check.sh [--fix]     --fix formats instead of complaining
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh --check
mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.h' '*.cpp')
if [[ ${1:-} == --fix ]]; then
  clang-format -i "${files[@]}"
else
  clang-format --dry-run --Werror "${files[@]}"
fi
scripts/check_layers.sh
scripts/test.sh
echo "clang-tidy: src and apps"
git ls-files --cached --others --exclude-standard 'src/*.cpp' 'apps/*.cpp' |
  xargs -P "$(nproc)" -n 1 clang-tidy -p build/ci --quiet 2> >(grep -v "warnings generated" >&2)
echo "all checks passed"
