#!/usr/bin/env bash
# Repeats the paper's tables: builds the programs, runs them, and prints the paper's numbers next to ours.
#   run.sh EXPERIMENT [--seeds N] [--data DIR] [--quick] [--again] [--out DIR]
#   run.sh all [...] [--page FILE]     every experiment, then a summary
# EXPERIMENT is the name of a file in scripts/reproduce/paper:
#   tab1     FAB-MAP's c_w and t_p on the validation sequences
#   tab2     FAB-MAP on the test sequences
#   tab3     OpenABLE's c_l and t_r on PUT LC, with the recognitions of the text
#   tab4     OpenABLE on PUT MC, with and without people
#   tab5     OpenABLE's time per query frame on Nordland
#   tab6     speed-up of FastABLE over OpenABLE; figures 12 to 14 and 17 to 19
#   tab7     FastABLE's time per query frame on Nordland
#   floor1   first floor of PUT MC with the automatic threshold, for four window lengths
#   figures  recognitions along the path, on the plan (figures 7 to 9, 20 and 21)
#   times    times of section 5 and of figures 10, 11 and 16
# run.sh --help describes the options. VPR_BIN=DIR uses existing programs instead of building them.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
command -v python3 >/dev/null || "$here/../install-deps.sh"
exec python3 "$here/reproduce.py" "$@"
