#!/usr/bin/env bash
# Tests an installation: programs, completions, manual pages, and the library for C++.
#   install.sh BUILD CMAKE [PYTHON]
set -euo pipefail
build=$1 cmake=$2
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"$cmake" --install "$build" --prefix "$out" >/dev/null
for program in vpr-train vpr-query vpr-eval vpr-tune vpr-bench vpr-synth; do
  [[ $("$out/bin/$program" --version) == "$program "* ]]
  for file in bash-completion/completions/$program zsh/vendor-completions/_$program \
      fish/vendor_completions.d/$program.fish man/man1/$program.1.gz; do
    [[ -s $out/share/$file ]] || { echo "$file is missing"; exit 1; }
  done
  bash -n "$out/share/bash-completion/completions/$program"
  ! command -v zsh >/dev/null || zsh -n "$out/share/zsh/vendor-completions/_$program"
  ! command -v fish >/dev/null || fish -n "$out/share/fish/vendor_completions.d/$program.fish"
done
for file in copyright README.md changelog.gz schemas/report.schema.json; do
  [[ -s $out/share/doc/vpr-toolkit/$file ]] || { echo "$file is missing"; exit 1; }
done
[[ -s $out/share/vpr-toolkit/worlds/small.json ]]
"$(dirname "$0")/examples.sh" "$out/bin" "$out/share/vpr-toolkit/example"
[[ -x $out/share/vpr-toolkit/convert/mat.py ]]
for file in include/vpr/vpr.h libvpr.a cmake/vpr/vprConfig.cmake libvpr-toolkit-dev/examples/recognize.cpp; do
  [[ -n $(find "$out" -path "*/$file" -size +0) ]] || { echo "$file is missing"; exit 1; }
done
if [[ -n ${3:-} ]]; then  # Python, if the module is built
  (cd "$out" && PYTHONPATH=$(dirname "$out"/lib/python3*/dist-packages/vpr) "$3" -c 'import vpr; vpr.train') ||
    { echo "the Python module is missing"; exit 1; }
fi

source "$out/share/bash-completion/completions/vpr-eval"
expect() {  # the completions, then the words of a command line
  COMP_WORDS=("${@:2}")
  COMP_CWORD=$(($# - 2))
  _vpr_eval
  [[ "${COMPREPLY[*]}" == "$1" ]] || { echo "${*:2}: expected $1, found ${COMPREPLY[*]}"; exit 1; }
}
expect "--tolerance" vpr-eval --tol
expect "text csv markdown latex" vpr-eval --format ""
expect "markdown" vpr-eval compare --format m
expect "--block" vpr-eval compare --b
expect "compare" vpr-eval comp
expect "" vpr-eval --html ""
