#!/usr/bin/env bash
# An installation has programs that run, completions that complete, and manual pages.
#   install.sh BUILD CMAKE
set -euo pipefail
build=$1 cmake=$2
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"$cmake" --install "$build" --prefix "$out" >/dev/null
for program in vpr-train vpr-query vpr-eval vpr-tune vpr-bench vpr-synth; do
  [[ $("$out/bin/$program" --version) == "$program "* ]]
  for file in bash-completion/completions/$program zsh/site-functions/_$program \
    fish/vendor_completions.d/$program.fish man/man1/$program.1; do
    [[ -s $out/share/$file ]] || { echo "$file is missing"; exit 1; }
  done
  bash -n "$out/share/bash-completion/completions/$program"
done
for file in report common; do [[ -s $out/share/doc/vpr-toolkit/$file.schema.json ]]; done
[[ -x $out/share/vpr-toolkit/convert/mat.py ]]

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

# zsh's own helpers, which need a terminal, are replaced by ones that print what they are given.
zsh_offers() {  # the words of a command line
  zsh -f -c '
    _arguments() { print -rl -- "$@" }
    words=("${@:2}")
    CURRENT=$#words
    source "$1"' zsh "$out/share/zsh/site-functions/_$1" "$@"
}
zsh_offers vpr-eval --tol | grep -F -- "--tolerance[" >/dev/null
zsh_offers vpr-eval --tol | grep -F -- "(text csv markdown latex)" >/dev/null
zsh_offers vpr-eval compare --b | grep -F -- "--block[" >/dev/null
[[ $(zsh_offers vpr-eval compare --b) != *"--tolerance["* ]]
fish_offers() { fish -N -c "source '$out/share/fish/vendor_completions.d/$1.fish'; complete -C '$*'"; }
[[ $(fish_offers vpr-eval --tol | cut -f1) == --tolerance ]]
[[ $(fish_offers vpr-eval compare --b | cut -f1) == --block ]]
[[ $(fish_offers vpr-eval comp | cut -f1) == compare ]]
[[ $(fish_offers vpr-eval --format m | cut -f1) == markdown ]]
