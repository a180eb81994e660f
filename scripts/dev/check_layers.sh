#!/usr/bin/env bash
# A folder of src includes only the folders of its row.
set -euo pipefail
cd "$(dirname "$0")/../.."
declare -A allowed=(
  [base]=""
  [recordings]="base"
  [truth]="base recordings"
  [synth]="base"
  [database]="base recordings"
  [match]="base database"
  [query]="base recordings truth database match"
  [evaluate]="base recordings truth database match query"
  [present]="base recordings truth database match query evaluate"
  [fabmap]="base recordings database query present"
  [tune]="base recordings truth query evaluate present fabmap"
  [loops]="base truth query evaluate present"
  [bench]="base recordings database match query present fabmap reference"  # it checks answers before it times them
  [vpr]="base recordings truth database query evaluate present fabmap"
  [python]="base present vpr"
)
bad=0
while IFS=: read -r file line text; do
  from=${file#src/}; from=${from%%/*}
  to=$(sed -E 's/.*"([a-z]+)\/.*/\1/' <<<"$text")
  [[ $from == "$to" || " ${allowed[$from]-} " == *" $to "* ]] && continue
  echo "$file:$line: $from must not include $to"; bad=1
done < <(grep -rnE '^#include "[a-z]+/' src)
if grep -rnE 'std::cout|std::cerr|fmt::print|(^|[^a-z_])(f?printf|f?puts|abort|exit) *\(|imshow' src; then
  echo "the library must not print, exit or open a window"; bad=1
fi
while IFS=: read -r file line text; do
  if [[ -e apps/$(cut -d'"' -f2 <<<"$text") ]]; then
    echo "$file:$line: a program's folder must not include another's"; bad=1
  fi
done < <(grep -rnE '^#include "(train|query|eval|tune)/' apps)
[[ $bad == 0 ]] && echo "layers: all includes are allowed"
exit $bad
