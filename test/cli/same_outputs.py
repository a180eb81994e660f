#!/usr/bin/env python3
"""Programs of two builds, for example for two processor architectures, write the same bytes.

    same_outputs.py BIN OTHER_BIN [GROUP...]

Both sets of programs run the commands below, each in a separate folder; then every output file
is compared, JSON without `machine` and `timing`, and pages without the command line.
Real images are in the same place as for tests; a group without its images is skipped.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("VPR_TEST_DATA", SOURCE / "../shared")).resolve()
CORRIDOR = SHARED / "data/corridor"
LOOP = SHARED / "data/loop"
OPENFABMAP = SHARED / "expected/fabmap-loop"
TOWER = SHARED / "data/tower"
CORRIDOR_TRUTH = f"--ground-truth {CORRIDOR}/ground_truth.csv"
LOOP_TRUTH = f"--ground-truth {LOOP}/ground_truth.csv"

BUILDING = [
    f"vpr-synth {SOURCE}/configs/worlds/small.json -o building",
    "vpr-train fastable --dataset building/dataset.json --c-l 20 -o building.vprdb",
    "vpr-query building.vprdb --dataset building/dataset.json --c-l 20 --save-matrix matrix.png -o building.json",
    "vpr-eval building.json --dataset building/dataset.json --html building.html --outcomes-csv building.csv"
    " -o building.report.json",
    "vpr-train fabmap --dataset building/dataset.json --words 100 -o places.vprdb",
    "vpr-query places.vprdb --dataset building/dataset.json --c-w 3 --save-posteriors places.npy -o places.json",
    "vpr-eval places.json --dataset building/dataset.json -o places.report.json",
    "vpr-tune threshold building.vprdb -o thresholds.json",
    "vpr-tune fabmap places.vprdb --dataset building/dataset.json -o places.sweep.json",
]


def corridor():
    yield f"vpr-train fastable --features none --train {CORRIDOR}/ref --c-l 20 -o raw.vprdb"
    yield f"vpr-train fastable --features none --train {CORRIDOR}/ref --illumination-invariant -o color.vprdb"
    yield (f"vpr-query raw.vprdb --query {CORRIDOR}/query --method lsh --c-l 20 --t-r 200 --t-r-scale bits "
           "-o lsh.json")
    for method in "fastable", "fastable-online", "openable":
        yield (f"vpr-query raw.vprdb --query {CORRIDOR}/query --method {method} --c-l 20 --t-r 0.65 "
               f"--save-matrix {method}.npy -o {method}.json")
        yield f"vpr-eval {method}.json {CORRIDOR_TRUTH} -o {method}.report.json"
    yield (f"vpr-query raw.vprdb --query {CORRIDOR}/query --score zscore --t-r=-2 --c-l 10 "
           f"--save-matrix zscore.npy -o zscore.json")
    yield (f"vpr-eval zscore.json {CORRIDOR_TRUTH} --html zscore.html --query {CORRIDOR}/query "
           f"--train {CORRIDOR}/ref -o zscore.report.json")
    yield f"vpr-eval matrix zscore.npy --distance --rows-are-windows-of 10 {CORRIDOR_TRUTH} -o zscore.metrics.json"
    yield (f"vpr-tune fastable raw.vprdb --query {CORRIDOR}/query {CORRIDOR_TRUTH} --score zscore "
           f"--save-config zscore.best.json -o zscore.sweep.json")
    yield f"vpr-query color.vprdb --query {CORRIDOR}/query --c-l 20 --t-r 0.65 -o color.json"
    yield f"vpr-query raw.vprdb --query {CORRIDOR}/query --speed 1.5 -o filter.json"
    yield f"vpr-query raw.vprdb --query {CORRIDOR}/query --score zscore --decide margin -o margin.json"


def witness():
    """With OpenCV's local features, which are other ones on other kinds of processors."""
    yield f"vpr-train images --train {CORRIDOR}/ref -o images.vprdb"
    yield f"vpr-query images.vprdb --query {CORRIDOR}/query -o images.json"


def loop():
    arrays = pathlib.Path(tempfile.mkdtemp())
    for name in "vocabulary", "tree", "bow-pretrain", "bow-loop":
        subprocess.run([SOURCE / "scripts/convert/openfabmap.py", OPENFABMAP / f"{name}.yml.gz",
                        "-o", arrays / f"{name}.npy"], check=True)
    yield (f"vpr-train fabmap --from-openfabmap --features sift --vocabulary {arrays}/vocabulary.npy "
           f"--tree {arrays}/tree.npy --pretrain {arrays}/bow-pretrain.npy "
           f"--train {arrays}/bow-loop.npy@0:40 -o loop.vprdb")
    bow = f"--query {arrays}/bow-loop.npy@40:80"
    for variant in "fabmap1", "fabmap2", "lut", "fbo":
        for more in ("", "--word-model naive-bayes", "--new-place mean-field", "--motion-model"):
            if variant == "fbo" and more:
                continue
            name = f"{variant}{more.replace(' ', '').replace('--', '-')}"
            save = "" if variant == "fbo" else f"--save-posteriors {name}.npy"
            yield f"vpr-query loop.vprdb {bow} --variant {variant} {more} {save} --t-p 0.6 -o {name}.json"
    yield f"vpr-eval fabmap2.json {LOOP_TRUTH} -o report.json"
    yield f"vpr-eval matrix fabmap2.npy --similarity {LOOP_TRUTH} -o metrics.json"


def features(kind):
    yield (f"vpr-train fabmap --features {kind} --words 50 --pretrain {TOWER}/floor5@0:30:5 "
           f"--train {LOOP}/images@0:40:10 -o {kind}.vprdb")
    yield f"vpr-query {kind}.vprdb --query {LOOP}/images@40:80:10 --save-posteriors {kind}.npy -o {kind}.json"


GROUPS = {
    "building": ([], BUILDING),
    "corridor": ([CORRIDOR], corridor()),
    "witness": ([CORRIDOR], witness()),
    "loop": ([OPENFABMAP, LOOP], loop()),
}
for feature in "surf", "sift", "kaze", "akaze", "orb", "brisk":
    GROUPS[feature] = ([LOOP, TOWER], features(feature))


def run(programs, command, folder):
    """Runs a command; its standard output counts as output, without the path of the programs."""
    words = command.split()
    done = subprocess.run([programs / words[0], *words[1:]], cwd=folder, capture_output=True, text=True)
    with open(folder / "printed.txt", "a", encoding="utf-8") as file:
        printed = re.sub(r"\S+/(vpr-[a-z]+)", r"\1", done.stdout)
        file.write(f"$ {command}\n{printed}")
    if done.returncode != 0:
        sys.exit(f"{programs / words[0]} {' '.join(words[1:])}: exit code {done.returncode}\n{done.stderr}")


def contents(path):
    """The contents that must be equal."""
    if path.suffix == ".html":
        return [line for line in path.read_bytes().splitlines() if not line.startswith(b"<dt>command line</dt>")]
    if path.suffix != ".json":
        return path.read_bytes()
    data = json.loads(path.read_text(), parse_float=str)  # digits, not values
    for key in "machine", "timing":
        data.pop(key, None)
    return json.dumps(data)


def differing(folder, other):
    names = {f.relative_to(root) for root in (folder, other) for f in root.rglob("*") if f.is_file()}
    same_names = [n for n in names if (folder / n).is_file() and (other / n).is_file()]
    return len(names), sorted(
        {str(n) for n in names if n not in same_names}
        | {str(n) for n in same_names if contents(folder / n) != contents(other / n)})


def compare(group, builds, keep):
    needed, commands = GROUPS[group]
    for path in needed:
        if not path.exists():
            print(f"{group}: skipped, there is no {path}")
            return False
    folders = [keep / f"{group}-{i}" for i in range(2)]
    for folder in folders:
        folder.mkdir()
    for command in commands:
        for build, folder in zip(builds, folders):
            run(build, command, folder)
    count, different = differing(*folders)
    print(f"{group}: {count} files, {len(different)} differ", flush=True)
    for name in different:
        print(f"  {name}")
    return bool(different)


def main():
    builds = [pathlib.Path(word).resolve() for word in sys.argv[1:3]]
    wrong = [group for group in sys.argv[3:] if group not in GROUPS]
    if len(builds) < 2 or wrong:
        sys.exit(__doc__ + f"\nGroups: {', '.join(GROUPS)}")
    keep = os.environ.get("VPR_KEEP_OUTPUTS")
    with tempfile.TemporaryDirectory() as folder:
        results = [compare(group, builds, pathlib.Path(keep or folder)) for group in sys.argv[3:] or GROUPS]
    sys.exit(1 if any(results) else 0)


if __name__ == "__main__":
    main()
