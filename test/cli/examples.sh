#!/usr/bin/env bash
# Runs the example of every -h, in a copy of the example images (data/example).
#   examples.sh BIN EXAMPLE
set -euo pipefail
export PATH=$(realpath "$1"):$PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r "$2/." "$folder"
cd "$folder"

example_of() {  # the command after "Example:", without its line breaks
  "$@" -h | sed -n '/^Example:$/,/^$/p' | sed '1d; s/ \\$//' | tr '\n' ' '
}

run() {
  local example
  example=$(example_of "$@")
  [[ $example == *"$1 "* ]] || { echo "$* -h has no example"; exit 1; }
  bash -c "$example" >out 2>&1 || { echo "failed: $example"; cat out; exit 1; }
  ran+=("$*")
}

ran=()
# Commands that write what others read come first.
run vpr-synth
for command in images export descriptors fabmap info add ''; do run vpr-train $command; done
for command in '' live loops; do run vpr-query $command; done
# A second result for vpr-eval compare.
vpr-query corridor.vprdb --query tuesday --c-l 20 --score zscore --decide margin --quiet -o windows.json
vpr-query corridor.vprdb --query tuesday --c-l 1 --t-r 0.5 --save-matrix scores.npy --quiet
for command in '' matrix loops compare convert check; do run vpr-eval $command; done
for command in '' fastable fabmap threshold; do run vpr-tune $command; done
for command in '' matching describe training fabmap realtime; do run vpr-bench $command; done
cp old.json new.json  # times of a busy machine differ
run vpr-bench compare
for program in vpr-train vpr-query vpr-eval vpr-tune vpr-bench vpr-synth; do
  for command in '' $("$program" -h | sed -n '/^Commands:$/,/^$/s/^  \([a-z]*\)  .*/\1/p'); do
    grep -qx "$program${command:+ $command}" < <(printf '%s\n' "${ran[@]}") || { echo "$program $command -h was not run"; exit 1; }
  done
done
echo "${#ran[@]} examples of -h run"
