#!/usr/bin/env bash
# Runs every fuzz target once on the inputs of its corpus, so that targets still build and fixed bugs
# stay fixed. Then the targets with checksums read mutants.
#   corpora.sh PROGRAMS
set -euo pipefail
cd "$(dirname "$0")/corpus"
work=$(mktemp -d)
log=$work/log
trap 'rm -rf "$work"' EXIT
for archive in "$PWD"/*.tar.gz; do
  tar -xzf "$archive" -C "$work"
done
cd "$work"
for name in */; do
  name=${name%/}
  if ! "$1/fuzz_$name" "$name" 2>"$log"; then
    tail -n 5 "$log" >&2
    echo "corpora: fuzz_$name failed at the last input named above" >&2
    exit 1
  fi
done
for name in database ground_truth report result; do
  if ! "$1/fuzz_$name" --mutants 0:500 "$name" 2>"$log"; then
    tail -n 5 "$log" >&2
    echo "corpora: fuzz_$name --mutants failed at the last number above" >&2
    exit 1
  fi
done
