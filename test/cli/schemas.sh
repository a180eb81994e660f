#!/usr/bin/env bash
# The outputs of the programs match the schemas in docs/schemas/.   schemas.sh SOURCE BIN PYTHON
set -euo pipefail
source=$1 python=$3
export PATH=$2:$PATH
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cd "$out"
cat >commands <<'END'
vpr-synth SOURCE/configs/worlds/small.json -o building
vpr-train fastable --dataset DATA -o w.vprdb
vpr-train info w.vprdb --json >i.json
vpr-query w.vprdb --dataset DATA --query query --c-l 40 --save-matrix d.npy -o r.json
vpr-query w.vprdb --query building/query --t-r 0.3 --only-sequence corridor -o r2.json
vpr-query w.vprdb --query building/query --method lsh -o r3.json
vpr-query w.vprdb --query building/query --score zscore --t-r -2 -o r4.json
vpr-query w.vprdb --query building/query --score zscore --t-r -2 --c-l 10 -o r5.json
vpr-query w.vprdb --query building/corridor --only-sequence corridor --c-l 5 --t-r 0.3 --save-matrix s.npy -o rs.json
vpr-query w.vprdb --dataset DATA --query query --speed varying -o rw.json
vpr-train fastable --train building/corridor -o one.vprdb
vpr-train info one.vprdb --json >i6.json
vpr-query one.vprdb --query building/upstairs --decide margin -o r6.json
vpr-eval r6.json --ground-truth aligned -o e6.json
vpr-eval r5.json --dataset DATA -o e5.json
vpr-eval r.json --dataset DATA -o e.json
vpr-eval r.json --matrix d.npy --dataset DATA -o em.json
vpr-eval r.json --dataset DATA --name mine -o en.json
vpr-eval rw.json --dataset DATA -o ew.json
vpr-eval matrix s.npy --distance --rows-are-windows-of 5 --ground-truth aligned -o es.json
vpr-eval matrix s.npy --distance --rows-are-windows-of 5 --speed reversed --query-frames 104 --ground-truth aligned -o esw.json
vpr-eval r.json r2.json --dataset DATA --name a --name b -o several.json
vpr-eval r.json --dataset DATA --expect x.json
vpr-eval compare e.json em.json -o cmp.json
vpr-eval compare e.json ew.json -o cmpw.json
vpr-eval loops loops.csv --poses poses.csv --radius 2 --gap 2 --similarity -o lo.json
vpr-eval loops loops.csv --poses poses.csv --radius 2 --gap 2 --distance -o lo2.json
vpr-eval check building/query.ground_truth.csv -o c.json
vpr-eval convert aligned --query-frames 3 --train-frames 4 --to matrix -o m.npz --json >cv.json
vpr-train fabmap --pretrain building/corridor --train building/hall@0:20 --words 20 -o f.vprdb --json >fi.json
vpr-query f.vprdb --query building/hall@0:20 --t-p 0.5 -o fr.json
vpr-query loops f.vprdb --query building/hall@0:20 --gap 2 -o fg.json
vpr-eval fr.json --ground-truth aligned -o fe.json
vpr-tune w.vprdb --dataset DATA --query query -o tu.json
vpr-tune threshold w.vprdb --c-l 5 -o t.json
vpr-tune fastable w.vprdb --dataset DATA --query query --c-l 5,10 --t-r 0.3,auto -o s.json
vpr-tune fastable w.vprdb --dataset DATA --query query --c-l 5,10 --t-r 0.3,auto --speed stops -o sw.json
vpr-tune fastable w.vprdb --dataset DATA --query query --c-l 5,10 --score zscore --t-r=-2,-3 -o s2.json
vpr-tune fastable w.vprdb --dataset DATA --query query --save-config best.json -o s3.json
vpr-tune fastable one.vprdb --query building/upstairs --ground-truth aligned --c-l 10 --t-r 0.5 -o s6.json
vpr-tune fastable w.vprdb --dataset DATA --query query --c-l 20,40 --score zscore --decide margin --save-config margin.json -o s4.json
vpr-query w.vprdb --dataset DATA --query query --config margin.json -o rc.json
vpr-tune fabmap f.vprdb --query building/hall@0:20 --ground-truth aligned --c-w 1,2 --t-p 0.5 --validate building/hall@0:20 --validate-ground-truth aligned -o sf.json
ls building/query/[0-9]* >query.txt; vpr-query live w.vprdb --query query.txt >live
head -n 1 live >l1.json; tail -n 1 live >l2.json; vpr-query live w.vprdb --query query.txt --c-l 5 | tail -n 1 >l3.json
vpr-train fastable --dataset DATA --fps 4 -o thin.vprdb
vpr-train info thin.vprdb --json >ti.json
vpr-query thin.vprdb --dataset DATA --query query --fps 4 --c-l 5 -o tr.json
vpr-eval tr.json --dataset DATA -o te.json
vpr-tune fastable thin.vprdb --dataset DATA --query query --fps 4 --c-l 5 --t-r 0.3 -o ts.json
vpr-bench matching --databases 100 --c-l 5 --query-frames 20 --seconds 0.001 -o b.json
vpr-bench describe --features orb --frames 1 --seconds 0.001 -o b2.json
vpr-bench fabmap --place-counts 10 --words 100 --count 0 --variants fabmap2 --seconds 0.001 -o b3.json
vpr-bench realtime w.vprdb --query building/query --query-frames 5 --rate 1000 -o b4.json
vpr-bench training --databases 200 --descriptor-length 20 -o b5.json
vpr-bench compare b.json b.json -o bc.json
END
echo '{"schema": "vpr.expected/5", "counts": {"pairs": {"incorrect": {"value": 9, "tolerance": 99}, "correct": {"min": 1}}}}' >x.json
printf 'frame,x,y\n0,0,0\n1,5,0\n2,0,1\n3,5,9\n' >poses.csv
printf 'query,match,score\n2,0,1\n3,1,0.5\n2,1,0.2\n' >loops.csv
sed "s|SOURCE|$source|; s|DATA|building/dataset.json|" commands >commands.sh
bash -xeuo pipefail commands.sh >printed 2>&1 || { tail -n 5 printed; exit 1; }
"$python" "$source/scripts/dev/check_schemas.py" "$source"/configs/worlds/*.json building/dataset.json ./*.vprdb/manifest.json ./*.json
# Settings are checked: an unknown key, and a value of another type.
for wrong in '"c_ll": 10' '"c_l": "ten"' '"clustering": {"eps": 1.5}'; do
  echo "{\"schema\": \"vpr.config/3\", $wrong}" >wrong.json
  if "$python" "$source/scripts/dev/check_schemas.py" wrong.json >said || [[ $? != 1 ]]; then
    echo "config.schema.json takes $wrong"
    exit 1
  fi
done
