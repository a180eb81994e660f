#!/usr/bin/env bash
# Required before a commit: format, layers, build, tests, static analysis.
#   scripts/check.sh           everything
#   scripts/check.sh --style   format, layers, schemas, links, measurements and language only
#   scripts/check.sh --quick   no build and no tests; static analysis of the changed files: all
#                              commits since $VPR_CHECK_BASE, by default of the six hours before
#                              the last one; at most 4 files, the latest changes first (the
#                              others are only listed)
#   scripts/check.sh --fix     formats the files, then everything
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh --check
mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.h' '*.cpp')
if [[ ${1:-} == --fix ]]; then
  clang-format -i "${files[@]}"
else
  clang-format --dry-run --Werror "${files[@]}"
  echo "format: ${#files[@]} files match .clang-format"
fi
scripts/dev/check_layers.sh
scripts/dev/check_names.py
scripts/dev/check_schemas.py
scripts/dev/check_links.py
scripts/dev/check_measurements.py
scripts/dev/check_language.py
[[ ${1:-} == --style ]] && exit 0

# Static analysis reads sources without precompiled headers.
analyze() {
  cmake --preset tidy >/dev/null
  cmake --build --preset tidy --target generated_sources >/dev/null
  printf '%s\n' "$@" |
    xargs -P "$(nproc)" -n 1 clang-tidy -p build/tidy --quiet 2> >(grep -v "warnings generated" >&2)
  echo "clang-tidy: $# files"
}

if [[ ${1:-} == --quick ]]; then
  last=$(git show -s --format=%ct HEAD)
  base=${VPR_CHECK_BASE:-$(git rev-list -1 --before=$((last - 6 * 3600)) HEAD)}
  mapfile -t changed < <(git log --format= --name-only "${base:-HEAD~1}.." -- 'src/*.cpp' 'apps/*.cpp' |
    awk '!seen[$0]++' | while read -r file; do [[ -e $file ]] && echo "$file"; done)
  [[ ${#changed[@]} -gt 4 ]] &&
    echo "clang-tidy: ${#changed[@]} files have changed; not analyzed: ${changed[*]:4}"
  [[ ${#changed[@]} -gt 0 ]] && analyze "${changed[@]:0:4}"
  exit 0
fi
scripts/test.sh
mapfile -t sources < <(git ls-files --cached --others --exclude-standard 'src/*.cpp' 'apps/*.cpp')
analyze "${sources[@]}"
echo "all checks passed"
