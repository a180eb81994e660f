#!/usr/bin/env bash
# Includes must go from a later stage to an earlier one.
set -euo pipefail
cd "$(dirname "$0")/.."
stages=(base sequence truth synth describe store match settings decide run evaluate files
  chart present fabmap tune loops bench vpr python)
declare -A rank
for i in "${!stages[@]}"; do rank[${stages[$i]}]=$i; done
# These are alternatives: none may include another.
rank[synth]=${rank[truth]}
rank[describe]=${rank[truth]}
rank[loops]=${rank[tune]}
rank[bench]=${rank[tune]}
bad=0
while IFS=: read -r file line text; do
  from=${file#src/}; from=${from%%/*}
  to=$(sed -E 's/.*"([a-z]+)\/.*/\1/' <<<"$text")
  [[ $from/$to == bench/reference ]] && continue  # vpr-bench checks answers before it times them
  if [[ -z ${rank[$from]+x} || -z ${rank[$to]+x} ]]; then
    echo "$file:$line: unknown stage in $text"; bad=1
  elif [[ $from != "$to" && ${rank[$to]} -ge ${rank[$from]} ]]; then
    echo "$file:$line: $from must not include $to"; bad=1
  fi
done < <(grep -rnE '^#include "[a-z]+/' src)
if grep -rnE 'std::cout|std::cerr|fmt::print|(^|[^a-z_])(f?printf|f?puts|abort|exit) *\(|imshow' src; then
  echo "the library must not print, exit or open a window"; bad=1
fi
while IFS=: read -r file line text; do
  if [[ -e apps/$(cut -d'"' -f2 <<<"$text") ]]; then
    echo "$file:$line: a program's folder must not include another's"; bad=1
  fi
done < <(grep -rnE '^#include "(train|query|eval|tune)/' apps)
[[ $bad == 0 ]] && echo "layers: includes go one way"
exit $bad
