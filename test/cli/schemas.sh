#!/usr/bin/env bash
# The outputs of the programs match the schemas in docs/schemas/.   schemas.sh SOURCE BIN PYTHON
set -euo pipefail
source=$1 bin=$2 python=$3
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
"$bin/vpr-synth" "$source/configs/worlds/small.json" -o "$out/building" --quiet
"$bin/vpr-train" fastable --dataset "$out/building/dataset.json" -o "$out/w.vprdb" --quiet
"$bin/vpr-query" "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query --c-l 40 --verify 10 \
  --save-matrix "$out/d.npy" -o "$out/r.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/building/query" --t-r 0.3 --only-sequence corridor \
  -o "$out/r2.json" --quiet
"$bin/vpr-train" fastable --train "$out/building/corridor" -o "$out/one.vprdb" --quiet  # no automatic t_r
"$bin/vpr-query" "$out/one.vprdb" --query "$out/building/upstairs" --decide margin -o "$out/r6.json" --quiet
"$bin/vpr-eval" "$out/r6.json" --ground-truth aligned -o "$out/e6.json" --quiet
"$bin/vpr-train" info "$out/one.vprdb" --json >"$out/i6.json"
"$bin/vpr-tune" fastable "$out/one.vprdb" --query "$out/building/upstairs" --ground-truth aligned --c-l 10 \
  --t-r 0.5 -o "$out/s6.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/building/query" --method lsh -o "$out/r3.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/building/query" --score zscore --t-r -2 -o "$out/r4.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/building/query" --score zscore-offline --t-r -2 --c-l 10 \
  --verify 10 -o "$out/r5.json" --quiet
"$bin/vpr-eval" "$out/r5.json" --dataset "$out/building/dataset.json" -o "$out/e5.json" --quiet
"$bin/vpr-eval" "$out/r.json" --dataset "$out/building/dataset.json" -o "$out/e.json" --quiet
"$bin/vpr-eval" "$out/r.json" --matrix "$out/d.npy" --dataset "$out/building/dataset.json" -o "$out/em.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --query "$out/building/corridor" --only-sequence corridor --c-l 5 --t-r 0.3 \
  --save-matrix "$out/s.npy" -o "$out/rs.json" --quiet
"$bin/vpr-eval" matrix "$out/s.npy" --distance --rows-are-windows-of 5 --ground-truth aligned -o "$out/es.json" --quiet
"$bin/vpr-eval" "$out/r.json" "$out/r2.json" --dataset "$out/building/dataset.json" --name a --name b \
  -o "$out/several.json" --quiet
"$bin/vpr-eval" "$out/r.json" --dataset "$out/building/dataset.json" --name mine -o "$out/en.json" --quiet
"$bin/vpr-eval" compare "$out/e.json" "$out/em.json" -o "$out/cmp.json" --quiet
echo '{"schema": "vpr.expected/4", "counts": {"pairs": {"incorrect": {"value": 9, "tolerance": 99}, "correct": {"min": 1}}}}' >"$out/x.json"
"$bin/vpr-eval" "$out/r.json" --dataset "$out/building/dataset.json" --expect "$out/x.json" --quiet
"$bin/vpr-eval" "$out/r2.json" --protocol nordland-all -o "$out/p.json" --quiet
printf 'frame,x,y\n0,0,0\n1,5,0\n2,0,1\n3,5,9\n' >"$out/poses.csv"
printf 'query,match,score\n2,0,1\n3,1,0.5\n2,1,0.2\n' >"$out/loops.csv"
"$bin/vpr-eval" loops "$out/loops.csv" --poses "$out/poses.csv" --radius 2 --gap 2 --similarity -o "$out/lo.json" --quiet
"$bin/vpr-eval" loops "$out/loops.csv" --poses "$out/poses.csv" --radius 2 --gap 2 --distance -o "$out/lo2.json" --quiet
"$bin/vpr-eval" check "$out/building/query.ground_truth.csv" -o "$out/c.json" --quiet
"$bin/vpr-eval" convert aligned --query-frames 3 --train-frames 4 --to matrix -o "$out/m.npz" --json >"$out/cv.json"
"$bin/vpr-train" info "$out/w.vprdb" --json >"$out/i.json"
"$bin/vpr-train" fabmap --pretrain "$out/building/corridor" --train "$out/building/hall@0:20" --words 20 \
  -o "$out/f.vprdb" --json >"$out/fi.json"
"$bin/vpr-query" "$out/f.vprdb" --query "$out/building/hall@0:20" --t-p 0.5 -o "$out/fr.json" --quiet
"$bin/vpr-query" loops "$out/f.vprdb" --query "$out/building/hall@0:20" --gap 2 -o "$out/fg.json" --quiet
"$bin/vpr-query" explain "$out/f.vprdb" --query "$out/building/hall@0:20" --frame 9 -o "$out/fl.json" --quiet
"$bin/vpr-eval" "$out/fr.json" --ground-truth aligned -o "$out/fe.json" --quiet
"$bin/vpr-tune" fastable "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query --c-l 5,10 --t-r 0.3,auto \
  -o "$out/s.json" --quiet
"$bin/vpr-tune" "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query -o "$out/tu.json" --quiet
"$bin/vpr-tune" calibrate "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query --c-l 10,20 --fps 8 \
  -o "$out/ca.json" --quiet
"$bin/vpr-tune" calibrate "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query --c-l 10,20 --speed stops \
  --score raw -o "$out/ct.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query --config "$out/ct.json" \
  -o "$out/rc.json" --quiet
"$bin/vpr-tune" fabmap "$out/f.vprdb" --query "$out/building/hall@0:20" --ground-truth aligned --c-w 1,2 --t-p 0.5 \
  --validate "$out/building/hall@0:20" --validate-ground-truth aligned -o "$out/sf.json" --quiet
"$bin/vpr-query" "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query --speed varying -o "$out/rw.json" --quiet
"$bin/vpr-eval" "$out/rw.json" --dataset "$out/building/dataset.json" -o "$out/ew.json" --quiet
"$bin/vpr-eval" matrix "$out/s.npy" --distance --rows-are-windows-of 5 --speed reversed --query-frames 104 \
  --ground-truth aligned -o "$out/esw.json" --quiet
"$bin/vpr-tune" fastable "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query --c-l 5,10 --t-r 0.3,auto \
  --speed stops -o "$out/sw.json" --quiet
"$bin/vpr-eval" compare "$out/e.json" "$out/ew.json" -o "$out/cmpw.json" --quiet
mkdir "$out/all"
cp "$out/e.json" "$out/ew.json" "$out/all"
"$bin/vpr-eval" report "$out/all" -o "$out/grid.json" --quiet
ls "$out"/building/query/[0-9]* >"$out/query.txt"
"$bin/vpr-query" live "$out/w.vprdb" --query "$out/query.txt" --quiet >"$out/live"
head -n 1 "$out/live" >"$out/l1.json"
tail -n 1 "$out/live" >"$out/l2.json"
"$bin/vpr-query" live "$out/w.vprdb" --query "$out/query.txt" --c-l 5 --quiet | tail -n 1 >"$out/l3.json"
"$bin/vpr-tune" threshold "$out/w.vprdb" --c-l 5 -o "$out/t.json" --quiet
"$bin/vpr-tune" fastable "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query --c-l 5,10 \
  --score zscore --t-r=-2,-3 -o "$out/s2.json" --quiet
"$bin/vpr-tune" fastable "$out/w.vprdb" --dataset "$out/building/dataset.json" --query query \
  --save-config "$out/best.json" -o "$out/s3.json" --quiet
data=$out/building/dataset.json
"$bin/vpr-train" fastable --dataset "$data" --fps 4 -o "$out/thin.vprdb" --quiet
"$bin/vpr-train" info "$out/thin.vprdb" --json >"$out/ti.json"
"$bin/vpr-query" "$out/thin.vprdb" --dataset "$data" --query query --fps 4 --c-l 5 -o "$out/tr.json" --quiet
"$bin/vpr-eval" "$out/tr.json" --dataset "$data" -o "$out/te.json" --quiet
"$bin/vpr-tune" fastable "$out/thin.vprdb" --dataset "$data" --query query --fps 4 --c-l 5 --t-r 0.3 -o "$out/ts.json" --quiet
"$bin/vpr-tune" calibrate "$out/thin.vprdb" --dataset "$data" --query query --fps 4 --c-l 5 -o "$out/tc.json" --quiet
"$bin/vpr-bench" matching --databases 100 --c-l 5 --query-frames 20 --seconds 0.001 -o "$out/b.json" --quiet
"$bin/vpr-bench" describe --features orb --frames 1 --seconds 0.001 -o "$out/b2.json" --quiet
"$bin/vpr-bench" fabmap --places 10 --words 100 --count 0 --variants fabmap2 --seconds 0.001 -o "$out/b3.json" --quiet
"$bin/vpr-bench" realtime "$out/w.vprdb" --query "$out/building/query" --frames 5 --rate 1000 -o "$out/b4.json" --quiet
"$bin/vpr-bench" compare "$out/b.json" "$out/b.json" -o "$out/bc.json" --quiet
"$python" "$source/scripts/check_schemas.py" "$source"/configs/worlds/*.json "$out/building/dataset.json" \
  "$out/w.vprdb/manifest.json" "$out/r.json" "$out/r2.json" "$out/r3.json" "$out/e.json" "$out/x.json" \
  "$out/lo.json" "$out/lo2.json" "$out/p.json" "$out/c.json" "$out/cv.json" \
  "$out/i.json" "$out/fi.json" "$out/f.vprdb/manifest.json" "$out/fr.json" "$out/fl.json" "$out/fe.json" "$out/b.json" "$out/b2.json" "$out/b3.json" "$out/b4.json" "$out/bc.json" \
  "$out/s.json" "$out/sf.json" "$out/t.json" "$out/l1.json" "$out/l2.json" "$out/l3.json" \
  "$out/several.json" "$out/en.json" \
  "$out/em.json" "$out/es.json" "$out/cmp.json" "$out/r4.json" "$out/r5.json" "$out/e5.json" "$out/s2.json" \
  "$out/s3.json" "$out/best.json" "$out/tu.json" \
  "$out/rw.json" "$out/ew.json" "$out/esw.json" "$out/sw.json" "$out/cmpw.json" "$out/grid.json" \
  "$out/thin.vprdb/manifest.json" "$out/ti.json" "$out/tr.json" "$out/te.json" "$out/ts.json" "$out/tc.json" \
  "$out/r6.json" "$out/e6.json" "$out/i6.json" "$out/s6.json"
# Settings are checked: an unknown key, and a value of another type.
for wrong in '"c_ll": 10' '"c_l": "ten"' '"clustering": {"eps": 1.5}'; do
  echo "{\"schema\": \"vpr.config/3\", $wrong}" >"$out/wrong.json"
  if "$python" "$source/scripts/check_schemas.py" "$out/wrong.json" >"$out/said" || [[ $? != 1 ]]; then
    echo "config.schema.json takes $wrong"
    exit 1
  fi
done
