#!/usr/bin/env python3
"""Windows by the default margin, for docs/benchmarks/why-these-defaults.md: margins.py DATA [BIN].
DATA: folder with corridor/, loop/, nordland/ and tower/; three buildings are rendered. A cell has
correct+incorrect recognitions, and the largest incorrect margin times sqrt(c_l), in deviations or typical
distances. Two programs run at a time, with one thread each."""
import concurrent.futures
import itertools
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
data = pathlib.Path(sys.argv[1]).resolve()
binaries = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ROOT / "build/release/bin")
COLUMNS = [(score, length) for score in ("zscore", "raw") for length in (10, 40)]


def run(program, *words, fails=False):
    command = [str(word) for word in (binaries / program, *words, "--threads", 1)]
    done = subprocess.run(command, check=not fails, capture_output=True)
    return done.stdout if done.returncode == 0 else None


def aligned(tolerance):
    return ["--ground-truth", "aligned", "--tolerance", tolerance]


def pairs(name, lines):
    (out / name).write_text("\n".join(["query,reference,label", *lines]) + "\n")
    return ["--ground-truth", out / name]


def render(name, seed, resemblance):
    world = json.loads((ROOT / "configs/worlds/speeds.json").read_text())
    plan = world["floors"][0]
    halls = [("corridor", 0, 0, 40, 3), ("hall", 10, 3, 20, 8), ("corridor", 37, 3, 3, 15)]
    other = [dict(zip(("kind", "x", "y", "width", "depth"), hall)) for hall in halls]
    world["floors"] += [dict(plan, name="upper"), {"name": "other", "rooms": other}]
    route = [[1.5, 1.25], [28.75, 1.25], [28.75, 15], [2, 15]]
    detour = [route[0], [11.25, 1.25], [11.25, 8], [15.25, 8], [15.25, 1.25], *route[1:]]
    added = [("upstairs", "upper", route), ("leaves", "ground", detour),
             ("elsewhere", "other", [[1, 1.5], [38.5, 1.5], [38.5, 17]])]
    light = {"daylight": 0.7, "warmth": 0.2, "noise": 4}
    world["walks"] += [{"name": walk, "use": "query", "floor": floor, "path": path, "conditions": light}
                       for walk, floor, path in added]
    path = out / f"{name}.json"
    path.write_text(json.dumps(dict(world, name=name, seed=seed, resemblance=resemblance)))
    run("vpr-synth", path, "-o", out / name, "--quiet")
    return out / name


def sets():
    corridor, nordland = data / "corridor", data / "nordland"
    laps = [f"{data}/loop/images@{lap}" for lap in ("0:40", "40:80")]
    for name, trained, query, truth in [("corridor", corridor / "ref", corridor / "query", aligned(3)),
                                        ("loop", *laps, aligned(3)),
                                        ("Nordland", nordland / "summer", nordland / "winter", aligned(2))]:
        yield name, [(trained, query, truth), (query, trained, truth)]
    floors = itertools.permutations(sorted((data / "tower").iterdir()), 2)
    yield "tower, 30 pairs", [(*floor, pairs("none.csv", [])) for floor in floors]
    worlds = [render("a", 21, 0.3), render("b", 22, 0.8), render("c", 23, 0.5)]
    for title, walks in [("rendered, equal speed", ["same"]), ("rendered, other speeds", ["slow", "fast", "varying"]),
                         ("rendered, leaves the map", ["detour", "carried", "leaves"]),
                         ("rendered, way back or other rooms", ["back", "elsewhere"]),
                         ("rendered, look-alike floor", ["upstairs"])]:
        yield title, [(world / "trained", world / walk, ["--ground-truth", world / f"{walk}.ground_truth.csv"])
                      for world in worlds for walk in walks]


def database(sequence):
    path = out / (str(sequence).replace("/", "_") + ".vprdb")
    if not path.exists():
        run("vpr-train", "images", "--train", sequence, "-o", path, "--quiet")
    return path


def judge(case, length, score):
    """Counts of correct and incorrect recognitions and of windows, and the largest incorrect margin."""
    trained, query, truth = case
    with tempfile.TemporaryDirectory(dir=out) as folder:
        result = f"{folder}/r.json"
        if run("vpr-query", database(trained), "--query", query, "--c-l", length, "--score", score, "--decide",
               "margin", "-o", result, "--quiet", fails=True) is None:
            return 0, 0, 0, 0.0  # shorter than a window
        report = json.loads(run("vpr-eval", result, *truth, "--json"))
    counts, outcomes = report["counts"]["pairs"], report["outcomes"]
    scale = math.sqrt(length)
    if score == "raw":
        manifest = json.loads((database(trained) / "manifest.json").read_text())
        scale /= manifest["sequences"][0]["typical_distance"]
    margins = [scale * float(margin) for best, margin in zip(outcomes["best"], outcomes["margins"].split())
               if best in "wnb" and margin not in ("-", "nan")]
    return counts["correct"], counts["incorrect"], len(outcomes["best"]), max(margins, default=0.0)


def cell(cases, score, length):
    *counts, margins = zip(*pool.map(judge, cases, itertools.repeat(length), itertools.repeat(score)))
    correct, incorrect, windows = map(sum, counts)
    return f"{correct}+{incorrect} ({max(0.0, *margins):.2g})" if windows >= 10 else ""


with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
    out = pathlib.Path(folder)
    cases = list(sets())
    list(pool.map(database, {trained for _, runs in cases for trained, _, _ in runs}))
    print("| | " + " | ".join(f"{score}, {length}" for score, length in COLUMNS) + " |")
    print("|---|" + "---:|" * len(COLUMNS))
    for name, runs in cases:
        print(f"| {name} | " + " | ".join(cell(runs, *column) for column in COLUMNS) + " |", flush=True)
