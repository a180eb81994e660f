#!/usr/bin/env bash
# Builds the fuzz targets and runs each: scripts/fuzz.sh [SECONDS [NAME...]]   default 60, all
# What a target finds new goes to build/fuzz/found; a crash stays there, too.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
command -v clang++ >/dev/null || { echo "fuzz: needs clang; apt-get install clang" >&2; exit 1; }
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz
names=("${@:2}")
[[ ${#names[@]} == 0 ]] && mapfile -t names < <(cd test/fuzz/corpus && ls)
for name in "${names[@]}"; do
  echo "fuzz_$name"
  mkdir -p "build/fuzz/found/$name"
  "build/fuzz/bin/fuzz_$name" -max_total_time="$seconds" -max_len=4096 -timeout=10 -rss_limit_mb=2048 \
    -print_final_stats=1 -verbosity=0 -artifact_prefix="build/fuzz/found/$name-" \
    "build/fuzz/found/$name" "test/fuzz/corpus/$name"
done
