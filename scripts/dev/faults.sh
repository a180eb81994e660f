#!/usr/bin/env bash
# Runs every command that writes with failing file calls, full disks and power loss, and checks the
# files afterwards (docs/developer/testing.md).
#   scripts/dev/faults.sh           every call and full disk, and 1500 power losses
#   scripts/dev/faults.sh 500       this number of cases of each kind; 0: all
# Disks need root and mounts; without them, they are skipped with the reason. Each finding is
# printed with the command line that repeats it; findings end the script with exit code 1.
set -euo pipefail
cd "$(dirname "$0")/../.."
scripts/install-deps.sh
cmake --preset release >/dev/null
cmake --build --preset release --target vpr_faults vpr-train vpr-query vpr-eval vpr-tune vpr-bench vpr-synth
status=0
for kind in calls:0 full:0 power:1500; do
  echo "== ${kind%:*}"
  test/faults/faults.py --programs build/release/bin --kind "${kind%:*}" --cases "${1:-${kind#*:}}" ||
    { ended=$?; [[ $ended == 77 ]] || status=1; }
done
exit "$status"
