#!/usr/bin/env bash
# What the programs write fits the schemas in docs/.   schemas.sh SOURCE BIN PYTHON
set -euo pipefail
source=$1 bin=$2 python=$3
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"$bin/vpr-synth" "$source/configs/worlds/demo.json" -o "$out/walk" --quiet
"$bin/vpr-train" fastable --dataset "$out/walk/dataset.json" -o "$out/w.vprdb" --quiet
"$bin/vpr-query" "$out/w.vprdb" --dataset "$out/walk/dataset.json" --query query-a --verify 10 \
  --save-matrix "$out/d.npy" -o "$out/r.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/walk/query-a" --t-r 0.3 --only-sequence corridor-a \
  -o "$out/r2.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/walk/query-a" --method lsh -o "$out/r3.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/walk/query-a" --score standardized -o "$out/r4.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/walk/query-a" --score standardized-offline --t-r -2 --c-l 10 \
  --verify 10 -o "$out/r5.json" --quiet
"$bin/vpr-eval" "$out/r5.json" --dataset "$out/walk/dataset.json" -o "$out/e5.json" --quiet
"$bin/vpr-eval" "$out/r.json" --dataset "$out/walk/dataset.json" -o "$out/e.json" --quiet
echo '{"schema": "vpr.expected/1", "counts": {"hits": {"incorrect": {"value": 9, "tolerance": 99}}}}' >"$out/x.json"
"$bin/vpr-eval" "$out/r.json" --dataset "$out/walk/dataset.json" --expect "$out/x.json" --quiet
"$bin/vpr-train" info "$out/w.vprdb" --json >"$out/i.json"
"$bin/vpr-train" fabmap --pretrain "$out/walk/corridor-a" --train "$out/walk/corridor-b@0:20" --words 20 \
  -o "$out/f.vprdb" --json >"$out/fi.json"
"$bin/vpr-query" "$out/f.vprdb" --query "$out/walk/corridor-b@0:20" --t-p 0.5 -o "$out/fr.json" --quiet
"$bin/vpr-query" "$out/f.vprdb" --query "$out/walk/corridor-b@0:20" --loop --loop-gap 2 --explain 9 \
  -o "$out/fl.json" --quiet
"$bin/vpr-eval" "$out/fr.json" --ground-truth aligned -o "$out/fe.json" --quiet
"$bin/vpr-tune" fastable "$out/w.vprdb" --dataset "$out/walk/dataset.json" --query query-a --c-l 5,10 --t-r 0.3,auto \
  -o "$out/s.json" --quiet
"$bin/vpr-tune" fabmap "$out/f.vprdb" --query "$out/walk/corridor-b@0:20" --ground-truth aligned --c-w 1,2 --t-p 0.5 \
  --validate "$out/walk/corridor-b@0:20" --validate-ground-truth aligned -o "$out/sf.json" --quiet
"$bin/vpr-tune" threshold "$out/w.vprdb" --c-l 5 -o "$out/t.json" --quiet
"$bin/vpr-tune" threshold "$out/w.vprdb" --c-l 5 --score standardized -o "$out/t2.json" --quiet
"$bin/vpr-tune" fastable "$out/w.vprdb" --dataset "$out/walk/dataset.json" --query query-a --c-l 5,10 \
  --score standardized --t-r=-2,auto -o "$out/s2.json" --quiet
"$bin/vpr-bench" matching --databases 100 --c-l 5 --query-frames 20 --seconds 0.001 -o "$out/b.json" --quiet
"$bin/vpr-bench" compare "$out/b.json" "$out/b.json" -o "$out/bc.json" --quiet
"$python" "$source/scripts/check_schemas.py" "$source"/configs/worlds/*.json "$out/walk/dataset.json" \
  "$out/w.vprdb/manifest.json" "$out/r.json" "$out/r2.json" "$out/r3.json" "$out/e.json" "$out/x.json" \
  "$out/i.json" "$out/fi.json" "$out/f.vprdb/manifest.json" "$out/fr.json" "$out/fl.json" "$out/fe.json" "$out/b.json" "$out/bc.json" \
  "$out/s.json" "$out/sf.json" "$out/t.json" \
  "$out/r4.json" "$out/r5.json" "$out/e5.json" "$out/t2.json" "$out/s2.json"
