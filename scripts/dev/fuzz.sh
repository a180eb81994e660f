#!/usr/bin/env bash
# Builds the fuzz targets and runs each one, as many at once as there are cores, or as JOBS says; fails if
# any has a finding.
#   scripts/dev/fuzz.sh [SECONDS [NAME...]]      default: 60 seconds, all targets
#   scripts/dev/fuzz.sh --minimize [NAME...]     reduces each corpus to a smallest one with the same
#                                            coverage, including small inputs of earlier runs
# New inputs, logs and the data to repeat a finding stay in build/fuzz/found.
set -euo pipefail
cd "$(dirname "$0")/../.."
command -v clang++ >/dev/null || { echo "fuzz: needs clang; apt-get install clang" >&2; exit 1; }
what=${1:-60}
names=("${@:2}")
[[ ${#names[@]} == 0 ]] && mapfile -t names < <(cd test/fuzz/corpus && basename -s .tar.gz -- *)
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target "${names[@]/#/fuzz_}"
found=build/fuzz/found corpora=build/fuzz/corpora
mkdir -p "$corpora"
for name in "${names[@]}"; do tar -xzf "test/fuzz/corpus/$name.tar.gz" -C "$corpora"; done
export found corpora what limits='-timeout=10 -rss_limit_mb=2048'

# Only small inputs of earlier runs: the corpus is part of the repository and must stay readable.
minimize() {
  local corpus=$corpora/$1 inputs smallest
  inputs=$(mktemp -d) smallest=$(mktemp -d)
  mkdir -p "$found/$1"
  find "$found/$1" -type f -size -120c -exec cp -t "$inputs" {} +
  "build/fuzz/bin/fuzz_$1" $limits -set_cover_merge=1 -verbosity=0 "$smallest" "$corpus" "$inputs" 2>/dev/null
  rm -r "$corpus" "$inputs"
  mv "$smallest" "$corpus"
  chmod 755 "$corpus"
  # The same inputs make the same archive.
  tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -C "$corpora" -c "$1" | gzip -9n >"test/fuzz/corpus/$1.tar.gz"
  echo "fuzz_$1: $(find "$corpus" -type f | wc -l) inputs, $(find "$corpus" -type f -printf '%s\n' | awk '{ all += $1 } END { print all + 0 }') bytes"
}

run() {
  local log=$found/$1.log
  mkdir -p "$found/$1"
  if "build/fuzz/bin/fuzz_$1" $limits -max_total_time="$what" -print_final_stats=1 -verbosity=0 \
    -artifact_prefix="$found/$1-" "$found/$1" "$corpora/$1" >"$log" 2>&1; then
    echo "fuzz_$1: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs in $what s, no finding"
  else
    echo "fuzz_$1: FINDING, see $log"
    return 1
  fi
}

if [[ $what == --minimize ]]; then
  for name in "${names[@]}"; do minimize "$name"; done
else
  export -f run
  printf '%s\n' "${names[@]}" | xargs -P "${JOBS:-$(nproc)}" -I{} bash -c 'run {}'
fi
