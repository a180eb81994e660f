#!/usr/bin/env bash
# Repeats a table of the paper: builds the programs that it needs, then runs them.
#   run.sh EXPERIMENT [--data DIR]
#   run.sh all [--data DIR]           every experiment, then the findings
# EXPERIMENT is the name of a file in configs/paper:
#   tab1     FAB-MAP's c_w and t_p on the validation sequences
#   tab2     FAB-MAP on the test sequences
#   tab3     OpenABLE's c_l and t_r on PUT LC, with the recognitions of the text
#   tab4     OpenABLE on PUT MC, with and without people
#   tab5     OpenABLE's time per query frame on Nordland
#   tab6     speed-up of FastABLE over OpenABLE
#   tab7     FastABLE's time per query frame on Nordland
#   floor1   first floor of PUT MC with the automatic threshold, for four window lengths
#   figures  recognitions along the path, on the plan; tab6 and times draw the figures of times
#   times    times of section 5 and of figures 10, 11 and 16
# VPR_BIN=DIR, such as VPR_BIN=build/ci/bin, uses existing programs instead of building them.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
experiment=${1:-}
for word in "$@"; do
  [[ $word == -h || $word == --help ]] && exec python3 "$here/reproduce.py" --help
done
if [[ $experiment == all ]]; then
  names=(tab1 tab2 tab3 tab4 floor1 figures tab5 tab6 tab7 times)
  for name in "${names[@]}"; do "$0" "$name" "${@:2}"; done
  exec python3 "$here/findings.py" "${names[@]}"
fi
if [[ -z $experiment || ! -f $root/configs/paper/$experiment.json ]]; then
  names=$(cd "$root/configs/paper" && printf '%s, ' *.json | sed 's/\.json//g; s/, $//')
  echo "run.sh: unknown experiment \"$experiment\"; choose all or one of $names" >&2
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
