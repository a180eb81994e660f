#!/usr/bin/env python3
"""Fusion of FAB-MAP and sequences: percent of correct best matches for z-scores/for z-scores fused
with FAB-MAP, by c_l, and for FAB-MAP alone on single frames; the table of docs/experiments/fusion.md.
Vocabularies have 500 SIFT words by default, and are never trained on the set under test: corridor,
Nordland and loop use four floors of the tower, the tower uses corridor and loop, rendered worlds use
their pretraining walks or, without any, the tower.

  scripts/experiments/fusion.py DATA [--world RENDERED]... [--features sift] [--words 500] [--bin BIN]

DATA holds corridor/, nordland/, loop/ and tower/; RENDERED is a folder written by vpr-synth."""
import argparse
import array
import csv
import json
import pathlib
import subprocess
import tempfile

LENGTHS = [1, 20]


def numbers(path, kind):
    content = path.read_bytes()
    values = array.array(kind)
    values.frombytes(content[10 + int.from_bytes(content[8:10], "little"):])
    return values


class Set:
    """Trained sequences {name: argument}, queries {argument: ground truth as flags}, vocabulary."""

    def __init__(self, title, trained, queries, pretrain):
        self.title, self.trained, self.queries, self.pretrain = title, trained, queries, pretrain


def aligned(tolerance):
    return ["aligned", "--tolerance", str(tolerance)]


def write_pairs(path, sequence, frames, reach):
    with open(path, "w") as file:
        file.write("query,sequence,reference,label\n")
        for frame in range(frames):
            for other in range(max(0, frame - reach), min(frames, frame + reach + 1)):
                file.write(f"{frame},{sequence},{other},same\n")
    return [str(path)]


def tower_sets(data, out):
    """Trains every other frame of all floors; the frames between them are queries, one per floor."""
    floors = sorted((data / "tower").glob("floor*"))
    vocabulary = [data / "loop/images", data / "corridor/ref", data / "corridor/query"]
    sets = []
    for first, title in ((0, "tower, even frames"), (1, "tower, odd frames")):
        queries = {}
        for floor in floors:
            frames = len(list(floor.iterdir())) // 2
            truth = write_pairs(out / f"{floor.name}-{first}.csv", floor.name, frames, 1)
            queries[f"{floor}@{1 - first}:{2 * frames}:2"] = truth
        trained = [f"{floor}@{first}::2" for floor in floors]
        sets.append(Set(title, trained, queries, vocabulary))
    return sets


def real_sets(data, out):
    words = [data / "tower" / f"floor{n}" for n in (5, 7, 9, 12)]
    ref, query = data / "corridor/ref", data / "corridor/query"
    first, second = f"{data}/loop/images@0:40", f"{data}/loop/images@40:80"
    summer, winter = data / "nordland/summer", data / "nordland/winter"
    pairs = [("corridor, `ref`", ref, query, 3), ("corridor, `query`", query, ref, 3),
             ("loop, first lap", first, second, 3),
             ("loop, second lap", second, first, 3),
             ("Nordland, summer", summer, winter, 2),
             ("Nordland, winter", winter, summer, 2)]
    sets = [Set(title, [a], {b: aligned(tolerance)}, words) for title, a, b, tolerance in pairs]
    return sets + tower_sets(data, out)


def world_sets(world, data):
    description = json.loads((world / "dataset.json").read_text())
    pretrain = [world / p for p in description.get("pretrain", [])]
    trained = [world / t["sequence"] for t in description["train"]]
    words = pretrain or [data / "tower" / f"floor{n}" for n in (5, 7, 9, 12)]
    name = description["name"].split(" (")[0]  # without "(rendered, a stand-in)"
    return [Set(f"{name}: {query['name']}", trained,
                {world / query["sequence"]: [str(world / query["ground_truth"]["path"])]}, words)
            for query in description["queries"] if query["name"] != "back"]


def run(args, program, *words):
    command = [f"{args.bin}/{program}", *map(str, words), "--quiet", "--force"]
    subprocess.run(command, check=True)


def sweep(args, one, out, query, truth, fused):
    extra = ["--fuse", out / "f.vprdb"] if fused else ["--score", "zscore"]
    run(args, "vpr-tune", "fastable", out / "s.vprdb", "--query", query, "--ground-truth", *truth,
        "--c-l", ",".join(map(str, one.lengths)), "--t-r=-1", *extra, "-o", out / "sweep.json")
    cells = json.loads((out / "sweep.json").read_text())["cells"]
    return [(cell["best_match"]["correct"], cell["best_match"]["frames"]) for cell in cells]


def labels(truth, names, starts):
    """Places (training frames, one sequence after the other) of each query frame, by pairs."""
    places = {}
    with open(truth) as file:
        for row in csv.DictReader(file):
            wanted = places.setdefault(int(row["query"]), set())
            if row["label"] == "same" and row["sequence"] in names:
                wanted.add(starts[names.index(row["sequence"])] + int(row["reference"]))
    return {frame: found for frame, found in places.items() if found}


def fabmap_alone(args, out, query, truth):
    run(args, "vpr-query", out / "f.vprdb", "--query", query, "-o", out / "fabmap.json")
    groups = json.loads((out / "f.vprdb/manifest.json").read_text())["groups"]
    names, starts = [g["name"] for g in groups], [0]
    for group in groups:
        starts.append(starts[-1] + group["frames"])
    best = numbers(out / "fabmap.best.npy", "i")  # query, target, place, view
    found = {best[row]: best[row + 2] for row in range(0, len(best), 4)}
    frames = json.loads((out / "fabmap.json").read_text())["query"]["frames"]
    if truth[0] == "aligned":
        reach = int(truth[2])
        right = {f: set(range(f - reach, f + reach + 1)) for f in range(frames)
                 if f < starts[-1] + reach}
    else:
        right = labels(truth[0], names, starts)
    return (sum(found.get(frame, -99) in places for frame, places in right.items()), len(right))


def row(args, one, out):
    for pair in ("fastable", "s"), ("fabmap", "f"):
        words = [w for p in one.pretrain for w in ("--pretrain", p)] if pair[0] == "fabmap" else []
        words += ["--features", args.features, "--words", args.words] if words else ["--c-l", 10]
        run(args, "vpr-train", pair[0], *words, *[w for t in one.trained for w in ("--train", t)],
            "-o", out / f"{pair[1]}.vprdb")
    sequences = json.loads((out / "s.vprdb/manifest.json").read_text())["sequences"]
    longest = max(s["frames"] for s in sequences)
    one.lengths = [length for length in LENGTHS if 2 * length <= longest]
    sums = [[0, 0] for _ in range(2 * len(one.lengths) + 1)]
    for query, truth in one.queries.items():
        cells = (sweep(args, one, out, query, truth, False) +
                 sweep(args, one, out, query, truth, True) +
                 [fabmap_alone(args, out, query, truth)])
        for total, (right, queries) in zip(sums, cells):
            total[0] += right
            total[1] += queries
    rates = [100 * right / max(queries, 1) for right, queries in sums]
    n = len(one.lengths)
    cells = [f"{rates[i]:.1f}/{rates[n + i]:.1f}" for i in range(n)] + [""] * (len(LENGTHS) - n)
    print(f"| {one.title} | {' | '.join(cells)} | {rates[-1]:.1f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=lambda p: pathlib.Path(p).resolve())
    parser.add_argument("--world", action="append", type=lambda p: pathlib.Path(p).resolve(),
                        default=[])
    parser.add_argument("--features", default="sift")
    parser.add_argument("--words", default="500")
    parser.add_argument("--bin", default=pathlib.Path(__file__).resolve().parents[2] / "build/release/bin")
    args = parser.parse_args()
    print(f"| | {' | '.join(f'c_l {n}' if n == 1 else str(n) for n in LENGTHS)} | FAB-MAP |")
    print("|---|" + "---:|" * (len(LENGTHS) + 1))
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        sets = real_sets(args.data, out)
        for world in args.world:
            sets += world_sets(world, args.data)
        for one in sets:
            row(args, one, out)


if __name__ == "__main__":
    main()
