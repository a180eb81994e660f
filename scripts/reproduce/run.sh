#!/usr/bin/env bash
# Builds the programs that one experiment needs, then runs it.
#   run.sh EXPERIMENT [--data DIR]
# EXPERIMENT is the name of a file in configs/paper. VPR_BIN=DIR, such as VPR_BIN=build/ci/bin, uses
# existing programs instead of building them.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
experiment=${1:-}
for word in "$@"; do
  [[ $word == -h || $word == --help ]] && exec python3 "$here/reproduce.py" --help
done
if [[ -z $experiment || ! -f $root/configs/paper/$experiment.json ]]; then
  names=$(cd "$root/configs/paper" && printf '%s, ' *.json | sed 's/\.json//g; s/, $//')
  echo "run.sh: unknown experiment \"$experiment\"; choose one of $names" >&2
  exit 2
fi
if [[ -z ${VPR_BIN:-} ]]; then
  # Timings need only vpr-bench, tables of counts need the other programs.
  if grep -q '"kind": "bench"' "$root/configs/paper/$experiment.json"; then
    programs=(vpr-bench)
  else
    programs=(vpr-synth vpr-train vpr-query vpr-eval vpr-tune)
  fi
  "$root/scripts/install-deps.sh"
  echo "building ${programs[*]} into build/release (VPR_BIN=DIR uses existing programs)" >&2
  (cd "$root" && cmake --preset release >/dev/null &&
    cmake --build --preset release --target "${programs[@]}" >&2)
fi
exec python3 "$here/reproduce.py" "$@"
