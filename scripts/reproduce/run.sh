#!/usr/bin/env bash
# Builds what is missing, then runs one experiment:   run.sh EXPERIMENT [--data DIR]
set -euo pipefail
[[ -n ${VPR_BIN:-} ]] || {
  root=$(cd "$(dirname "$0")/../.." && pwd)
  "$root/scripts/install-deps.sh"
  (cd "$root" && cmake --preset release >/dev/null && cmake --build --preset release >&2)
}
exec python3 "$(dirname "$0")/reproduce.py" "$@"
