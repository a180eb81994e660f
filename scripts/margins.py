#!/usr/bin/env python3
"""The effect of margins, as the tables of docs/experiments/margins.md: margins.py DATA [BIN]. DATA:
folder with corridor/, nordland/ and tower/; the small building is rendered. One thread."""
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve().parent
data = pathlib.Path(sys.argv[1]).resolve()
binaries = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else here.parent / "build/release/bin")
out = pathlib.Path(tempfile.mkdtemp())
lengths = (10, 20, 40)
scores = ("raw", "zscore")


def run(program, *words):
    command = [binaries / program, *words, "--threads", "1"]
    return subprocess.run(list(map(str, command)), check=True, stdout=subprocess.PIPE).stdout


def database(*sequences):
    path = out / ("-".join(s.name for s in sequences) + f"-{len(sequences)}.vprdb")
    if not path.exists():
        trains = [word for s in sequences for word in ("--train", s)]
        run("vpr-train", "fastable", *trains, "-o", path, "--quiet")
    return path


def query(train, walk, length, score, *more):
    words = ["--query", walk, "--c-l", length, "--score", score, "-o", out / "r.json"]
    run("vpr-query", train, *words, "--force", "--quiet", *more)
    return json.loads((out / "r.json").read_text())


def evaluate(truth, *more):
    return json.loads(run("vpr-eval", out / "r.json", *truth, "--json", *more))


def aligned(tolerance):
    return ["--ground-truth", "aligned", "--tolerance", tolerance]


world = out / "building"
run("vpr-synth", here.parent / "configs/worlds/small.json", "-o", world, "--quiet")
corridor, nordland = data / "corridor", data / "nordland"
rooms = [world / name for name in ("corridor", "hall", "upstairs")]
building = ["--ground-truth", world / "query.ground_truth.csv"]
pairs = building[1].read_text().splitlines(keepends=True)
(out / "corridor.csv").write_text("".join(p for p in pairs if "hall" not in p))
sets = [
    ("corridor", [corridor / "ref"], corridor / "query", aligned(3)),
    ("corridor, the other way round", [corridor / "query"], corridor / "ref", aligned(3)),
    ("small building, three walks trained", rooms, world / "query", building),
    ("small building, the corridor trained", rooms[:1], world / "query",
     ["--ground-truth", out / "corridor.csv"]),
    ("Nordland, summer trained", [nordland / "summer"], nordland / "winter", aligned(2)),
    ("Nordland, winter trained", [nordland / "winter"], nordland / "summer", aligned(2)),
]

head = "| | " + " | ".join(f"{score}, {length}" for score in scores for length in lengths) + " |"
rule = "|---|" + "---:|" * len(scores) * len(lengths)
cases = list(itertools.product(scores, lengths))
print(head, rule, sep="\n")
for name, trains, walk, truth in sets:
    cells = []
    for score, length in cases:
        query(database(*trains), walk, length, score, "--t-r", "-60" if score != "raw" else "0")
        metrics = evaluate(truth)["metrics"]
        shown = [100 * (metrics[key]["recall_at_100_precision"] or 0)
                 for key in ("single_best", "by_margin")]
        cells.append("{:.0f} → {:.0f}".format(*shown))
    print(f"| {name} | " + " | ".join(cells) + " |", flush=True)

print("", head, rule, sep="\n")
for name, trains, walk, truth in sets:
    cells = []
    for score, length in cases:
        result = query(database(*trains), walk, length, score, "--decide", "margin")
        recognitions = evaluate(truth)["counts"]["recognitions"]
        cells.append(f"{recognitions['correct']} + {recognitions['incorrect']} of {result['query']['windows']}")
    print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
floors = sorted((data / "tower").iterdir())
cells = []
for score, length in cases:
    recognitions = windows = 0
    for train, walk in itertools.permutations(floors, 2):
        result = query(database(train), walk, length, score, "--decide", "margin")
        recognitions += result["totals"]["recognitions"]
        windows += result["query"]["windows"]
    cells.append(f"{recognitions} of {windows} ({100 * recognitions / windows:.1f} %)")
print("| tower, 30 pairs of floors, all wrong | " + " | ".join(cells) + " |")
