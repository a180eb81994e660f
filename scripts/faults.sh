#!/usr/bin/env bash
# Has every command that writes meet failing file calls, full disks and disks that lose their power,
# and checks what is there afterwards (docs/reliability.md).
#   scripts/faults.sh           every call and full disk, and 1500 without power
#   scripts/faults.sh 500       so many cases of each kind; 0: all
# Disks need root and mounts; where they can't be had, it is said why they are skipped. Findings are
# printed with the line that repeats each, and end the script with exit code 1.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install-deps.sh
cmake --preset ci >/dev/null
cmake --build --preset ci --target vpr_faults vpr-train vpr-query vpr-eval vpr-tune vpr-bench vpr-synth
status=0
for kind in calls:0 full:0 power:1500; do
  echo "== ${kind%:*}"
  test/faults/faults.py --programs build/ci/bin --kind "${kind%:*}" --cases "${1:-${kind#*:}}" ||
    { ended=$?; [[ $ended == 77 ]] || status=1; }
done
exit "$status"
