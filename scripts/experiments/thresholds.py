#!/usr/bin/env python3
"""Thresholds of one walk, or half of one, applied to another: thresholds.py DATA [BIN] [--jobs N].
DATA: folder with corridor/, nordland/, loop/ and tower/. Worlds are rendered from
configs/worlds/speeds.json. Prints how margins transfer (docs/benchmarks/why-these-defaults.md): margins that
vpr-tune fastable recommends, and the default of the filter."""
import argparse
import array
import collections
import concurrent.futures
import json
import pathlib
import subprocess
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("data", type=pathlib.Path)
parser.add_argument("bin", type=pathlib.Path, nargs="?", default=ROOT / "build/release/bin")
parser.add_argument("--jobs", type=int, default=1)
parser.add_argument("--worlds", type=int, default=3)
parser.add_argument("--seed", type=int, default=201, help="seed of the first rendered world")
options = parser.parse_args()
work = tempfile.TemporaryDirectory()
out = pathlib.Path(work.name)

RULES = {"margin, z-scores": "recommended", "filter": "default"}  # the source of the margin of a decision
VARIETIES = [None, {"finishes": 0.8, "wear": 0.6, "window_light": 1, "far_view": 0.6, "changes": 0.25,
                    "hands": 0.5, "bareness": 0.3}, {"hands": 0.25, "changes": 0.3, "finishes": 0.4}]
Walk = collections.namedtuple("Walk", "path truth frames first last")


def run(program, *words, fails=False):
    command = [options.bin / program, *words, "--threads", "1"]
    done = subprocess.run(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if done.returncode != 0 and not fails:
        raise SystemExit(f"{' '.join(map(str, command))}: {done.stderr.decode()}")
    return done.stdout if done.returncode == 0 else None


def train(walk, name):
    if not (out / f"{name}.vprdb").exists():
        run("vpr-train", "images", "--train", walk, "-o", out / f"{name}.vprdb", "--quiet")
    return out / f"{name}.vprdb"


def part(walk, first, last):
    return walk._replace(first=first, last=last)


def halves(walk):
    middle = walk.frames // 2
    return [(part(walk, 0, middle), part(walk, middle, walk.frames)),
            (part(walk, middle, walk.frames), part(walk, 0, middle))]


def cut_truth(walk, name, shift, tolerance):
    """The pairs of a part of a walk, whose frames count from 0."""
    path = out / f"{name}-{walk.first}-{walk.last}.csv"
    lines = ["query,reference,label"]
    if walk.truth is None:
        lines += [f"{q - walk.first},{r},same" for q in range(walk.first, walk.last)
                  for r in range(max(0, q - tolerance), min(shift, q + tolerance + 1))]
    else:
        for line in walk.truth.read_text().splitlines()[1:]:
            fields = line.split(",")
            label = fields.pop() if fields[-1] in ("same", "ignore", "different") else "same"
            if walk.first <= int(fields[0]) < walk.last:
                lines.append(f"{int(fields[0]) - walk.first},{fields[-1]},{label}")
    path.write_text("\n".join(lines) + "\n")
    return path


def lengths_of(*walks):
    return ",".join(str(c) for c in (10, 20, 40) if all(w.last - w.first >= c + 4 for w in walks))


def count(database, walk, truth, config, key):
    result = out / f"{key}.json"
    run("vpr-query", database, "--query", f"{walk.path}@{walk.first}:{walk.last}", "--config", config,
        "-o", result, "--force", "--quiet")
    return json.loads(run("vpr-eval", result, "--ground-truth", truth, "--json"))


def right_windows(key, truth):
    """Query windows with a correct recognition."""
    result = json.loads((out / f"{key}.json").read_text())
    last = result["settings"]["c_l"] - 1
    data = zipfile.ZipFile(out / f"{key}.npz").read("recognitions.npy")
    numbers = array.array("i", data[10 + int.from_bytes(data[8:10], "little"):])
    same = {tuple(line.split(",")[:2]) for line in truth.read_text().splitlines() if line.endswith("same")}
    return len({query for query, train in zip(numbers[0::3], numbers[2::3])
                if (str(query + last), str(train + last)) in same})


def recommend(database, walk, truth, decision, lengths, config):
    if decision == "filter":
        config.write_text('{"method": "filter"}')
        return True
    return run("vpr-tune", "fastable", database, "--query", f"{walk.path}@{walk.first}:{walk.last}",
               "--ground-truth", truth, "--score", "zscore", "--decide", "margin", "--c-l", lengths,
               "--save-config", config, "--force", fails=True) is not None


def trial(job):
    group, name, database, train_frames, tolerance, first, second, decision = job
    key = "-".join([name, str(first.first), pathlib.Path(second.path).name, str(second.first), decision]
                   ).replace(" ", "").replace(",", "")
    key += "-" + pathlib.Path(first.path).name
    config = out / f"{key}.config.json"
    if decision == "filter":  # its places are keyframes
        tolerance = {3: 10, 2: 20}.get(tolerance, tolerance)
    truths = [cut_truth(w, f"{key}-{i}", train_frames, tolerance) for i, w in enumerate((first, second))]
    if not recommend(database, first, truths[0], decision, lengths_of(first, second), config):
        return group, decision, "none", 0
    report = count(database, second, truths[1], config, key)
    wrong = report["counts"]["pairs"]["incorrect"]
    right = right_windows(key, truths[1])
    known = sum(letter in "cwi" for letter in report["outcomes"]["best"])
    share = right / known if known else None
    return group, decision, "wrong" if wrong else "holds" if right or not known else "no recognition", share


def worlds():
    base = json.loads((ROOT / "configs/worlds/speeds.json").read_text())
    route = [[1.5, 1.25], [28.75, 1.25], [28.75, 15], [2, 15]]
    detour = [[1.5, 1.25], [11.25, 1.25], [11.25, 8], [15.25, 8], [15.25, 1.25], [28.75, 1.25], [28.75, 15]]
    for index in range(options.worlds):
        light = [{"daylight": 0.7, "warmth": 0.2, "noise": 4}, {"daylight": 0.3, "warmth": -0.1, "noise": 5}]
        query = {"use": "query", "floor": "ground"}
        world = dict(base, name=f"world {index}", seed=options.seed + index, walks=[
            dict(query, name="trained", use="train", path=[[1, 1.25]] + route[1:]),
            dict(query, name="plain", path=route, conditions=light[0], day=1),
            dict(query, name="detour", path=detour, conditions=light[0], day=1, passers_by=1),
            dict(query, name="later", path=route, conditions=light[1], day=2, passers_by=2),
            dict(query, name="later-detour", path=detour, conditions=light[1], day=2, passers_by=2),
            dict(query, name="back", path=route[::-1], conditions=light[1], day=2)])
        if VARIETIES[index % 3]:
            world["variety"] = VARIETIES[index % 3]
        path = out / f"world{index}.json"
        path.write_text(json.dumps(world))
        run("vpr-synth", path, "-o", out / f"world{index}", "--quiet")
        yield f"world{index}", out / f"world{index}"


def walk_of(path, truth=None):
    frames = sum(1 for f in pathlib.Path(path).iterdir() if f.suffix in (".jpg", ".png"))
    return Walk(path, truth, frames, 0, frames)


def jobs():
    corridor, nordland, loop = (options.data / name for name in ("corridor", "nordland", "loop"))
    pairs = [("corridor", corridor / "ref", corridor / "query", 3),
             ("corridor back", corridor / "query", corridor / "ref", 3),
             ("Nordland", nordland / "summer", nordland / "winter", 2),
             ("Nordland back", nordland / "winter", nordland / "summer", 2)]
    for name, trained, walk, tolerance in pairs:
        database, query = train(trained, name.replace(" ", "")), walk_of(walk)
        for first, second in halves(query):
            yield "real", name.replace(" ", ""), database, walk_of(trained).frames, tolerance, first, second
    loops = loop / "images"
    for name, trained, first in (("loop", "0:40", 40), ("loopback", "40:80", 0)):
        database = train(f"{loops}@{trained}", name)
        swapped = [line.split(",") for line in (loop / "ground_truth.csv").read_text().splitlines()[1:]]
        path = out / f"{name}.csv"
        path.write_text("query,reference\n" + "".join(
            f"{int(q) + 40},{r}\n" if first else f"{r},{q}\n" for q, r, *_ in swapped))
        for a, b in ((first, first + 20), (first + 20, first)):
            walk = Walk(loops, path, 84, 0, 84)
            yield "real", name, database, 40, 0, part(walk, a, a + 20), part(walk, b, b + 20)
    for name, folder in worlds():
        database = train(folder / "trained", name)
        walks = {w: walk_of(folder / w, folder / f"{w}.ground_truth.csv")
                 for w in ("plain", "detour", "later", "later-detour", "back")}
        for first in ("plain", "detour", "later"):
            for second in ("plain", "detour", "later", "later-detour", "back"):
                if first != second:
                    yield "rendered", name, database, 0, 0, walks[first], walks[second]


def walk_table(pool, pairs):
    verdicts, shares = collections.defaultdict(collections.Counter), collections.defaultdict(list)
    for group, decision, verdict, share in pool.map(trial, [(*pair, decision) for pair in pairs for decision in RULES]):
        verdicts[group, decision][verdict] += 1
        if share is not None:
            shares[group, decision].append(share)

    def cell(*key):
        share = sum(shares[key]) / len(shares[key]) if shares[key] else 0
        counts = (str(verdicts[key][verdict]) for verdict in ("holds", "no recognition", "wrong", "none"))
        return "/".join(counts) + f", {100 * share:.0f} %"

    print("| decision | margin from | real | rendered |\n|---|---|---:|---:|")
    for decision, rule in RULES.items():
        print(f"| {decision} | {rule} | {cell('real', decision)} | {cell('rendered', decision)} |")


with concurrent.futures.ThreadPoolExecutor(options.jobs) as workers:
    walk_table(workers, list(jobs()))
