#!/usr/bin/env bash
# All tables and figures of the paper, then its findings (docs/benchmarks/reproduction.md); rendered and
# trained data are shared.
#   all.sh [--data DIR]        (VPR_BIN=DIR uses existing programs, see run.sh)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
names=(tab1 tab2 tab3 tab4 floor1 figures tab5 tab6 tab7 times)
for name in "${names[@]}"; do "$here/$name.sh" "$@"; done
python3 "$here/findings.py" "${names[@]}"
