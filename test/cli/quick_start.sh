#!/usr/bin/env bash
# The commands of README's quick start, exactly as printed, recognize the place of the second walk.
#   quick_start.sh SOURCE BIN [WALKS]
# WALKS has the folders ref and query and ground_truth.csv; without it, two walks of the small
# building are rendered.
set -euo pipefail
source=$1 bin=$(realpath "$2") walks=${3:-}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cd "$out"
if [[ -n $walks ]]; then
  walks=${VPR_TEST_DATA:+$VPR_TEST_DATA/data/corridor}
  walks=${walks:-$3}
  [[ -d $walks ]] || { echo "skipped: there is no $walks"; exit 77; }
  ln -s "$walks/ref" monday
  ln -s "$walks/query" tuesday
  cp "$walks/ground_truth.csv" pairs.csv
else
  "$bin/vpr-synth" "$source/configs/worlds/small.json" -o building --quiet
  ln -s building/corridor monday
  mkdir tuesday # the query's way through that corridor
  frames=(building/query/*)
  cp "${frames[@]:0:90}" tuesday
  awk -F, 'NR == 1 { print "query,reference" } NR > 1 && $1 < 90 && $2 == "corridor" && $4 != "ignore" { print $1 "," $3 }' \
    building/query.ground_truth.csv >pairs.csv
fi
# The first fenced block below the heading, without the lines that build.
awk '/^## Your own corridor/ { found = 1 } found && /^```/ { ++fences } fences == 1 && /^vpr-/ { print }' \
  "$source/README.md" >commands
[[ $(wc -l <commands) -ge 3 ]] || { echo "README.md: no quick start found" >&2; exit 1; }
sed 's/^/$ /' commands
PATH=$bin:$PATH bash -euo pipefail commands | tee said
grep -q '^Recognized [1-9][0-9]* of [0-9]* frames of tuesday:' said || { echo "nothing was recognized" >&2; exit 1; }
grep -q '^Recognized in [1-9][0-9]* of [0-9]* frames, none of them incorrect' said
