#!/usr/bin/env bash
# All tables and figures of the paper; what was rendered and trained is shared.
#   all.sh [--data DIR]        (VPR_BIN=DIR takes built programs, see run.sh)
set -euo pipefail
here=$(dirname "$0")
for name in tab1 tab2 tab3 tab4 floor1 tab5 tab6 tab7; do "$here/$name.sh" "$@"; done
"$here/figures.sh" "$@"
