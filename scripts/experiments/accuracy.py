#!/usr/bin/python3
"""Measures what the filter and windows recognize, and writes the tables of docs/benchmarks/accuracy.md.

  scripts/experiments/accuracy.py DATA [--bin BIN] [--work FOLDER] [--into PAGE]

DATA: folder with corridor/, nordland/, loop/ and tower/, and perhaps tracks/. Buildings are rendered from
configs/worlds/speeds.json. Every table replaces the lines between "<!-- NAME: begin -->" and
"<!-- NAME: end -->" of the page. Databases and buildings in FOLDER are reused (default: a temporary
folder). Two programs run at a time, with one thread each. Needs numpy."""
import argparse
import concurrent.futures
import csv
import itertools
import json
import math
import pathlib
import subprocess
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPEEDS = {"equal speed": None, "0.5x": "0.5", "0.67x": "0.67", "1.5x": "1.5", "2x": "2",
          "varying": "varying", "stops": "stops", "cuts": "kidnap"}
RANDOM = {"varying", "stops", "cuts"}  # three seeds each
WINDOW_SPEEDS = ["equal speed", "1.5x"]
NEAR_FRAMES = 12  # an incorrect match within this many frames is a near miss
METHODS = ["filter", "windows", "FastABLE"]
RANKED = ["filter", "FastABLE"]
RANKED_SPEEDS = [speed for speed in SPEEDS if speed != "0.67x"]
DELAY_SPEEDS = ["equal speed", "0.5x", "1.5x", "2x", "varying"]
TOWER = "tower, 30 pairs"
BUILDINGS = {"building 1": (21, 0.3), "building 2": (22, 0.8), "building 3": (23, 0.5)}  # seed, resemblance
ON_MAP = ["same", "slow", "fast", "varying", "detour", "carried"]
OFF_MAP = ["back", "upstairs", "elsewhere"]
MARGINS = [10, 12, 14, 16, 18, 20]  # in deviations
FOREIGN, REVERSED, LAPS, RATES, ENTERING = "off the map", "reversed", "laps", "frame rates", "entering the map"
ENTERING_STEPS = (1, 2, 3)
STEPS = {"all frames": 1, "every 2nd": 2, "3rd": 3, "4th": 4, "6th": 6}
DENSE_FPS = 60  # of the rendered walks whose frame rate is reduced
ONE_LAP = {"garage": 361, "flat": 273, "rendered ring": None}  # frames of the first lap; None: a walk of its own


def run(program, *words):
    command = [str(word) for word in (options.bin / program, *words, "--quiet", "--threads", 1)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: {done.stderr}")


# Ground truth: judge(query frames, training frames) returns the distance of a match from the truth
# in frames: 0 is correct, NaN is ignored, infinity has no correct match. on_map: query frames with a
# correct match.

def aligned(tolerance):
    """Query frame i shows training frame i, +- tolerance. Training frames of one keyframe are one
    place, because a camera that stands shows the same view."""
    def judge(result, query, train):
        starts = result.train_keyframes
        keyframe = lambda frame: np.searchsorted(starts, frame, side="right")
        true = result.source[query]
        same_keyframe = ((keyframe(np.maximum(true - tolerance, 0)) <= keyframe(train)) &
                         (keyframe(train) <= keyframe(np.minimum(true + tolerance, result.train_frames - 1))))
        off = np.abs(true - train).astype(float)
        return np.where((off <= tolerance) | same_keyframe, 0, off)
    return judge, lambda result: np.ones(result.frames, bool)


def different_places():
    return (lambda result, query, train: np.full(len(query), np.inf),
            lambda result: np.zeros(result.frames, bool))


def rows_of_pairs(path):
    with open(path, newline="") as file:
        return [(int(row["query"]), int(row["reference"]), row["label"]) for row in csv.DictReader(file)]


def listed_pairs(path):
    rows = rows_of_pairs(path)
    same, ignored = {}, set()
    for query, train, label in rows:
        if label == "same":
            same.setdefault(query, []).append(train)
        elif label == "ignore":
            ignored.add((query, train))

    def off(query, train):
        if query not in same:
            return np.nan if (query, train) in ignored else np.inf
        nearest = min(abs(train - other) for other in same[query])
        return np.nan if nearest and (query, train) in ignored else nearest
    return (lambda result, query, train: np.array([off(*pair) for pair in zip(query, train)], float),
            lambda result: np.isin(np.arange(result.frames), list(same)))


def from_frame(first, step, pairs):
    """`pairs` of frames of two recordings, of which every n-th frame is used, of the second one from `first` on."""
    places = {}
    for query, train in pairs:
        if train >= first:
            places.setdefault(query / step, []).append((train - first) / step)
    nearest = lambda query, train: min((abs(place - train) for place in places.get(query, [])), default=np.inf)
    return (lambda result, query, train: np.floor([nearest(*pair) for pair in zip(query, train)]),
            lambda result: np.isin(np.arange(result.frames), list(places)))


class Case:
    """A query of a database, its ground truth, and c_l of its windows."""

    def __init__(self, database, query, truth, window=40):
        self.database, self.query, self.window = database, query, window
        self.judge, self.on_map = truth


class Result:
    """The matches of one run. Windows are judged at their last frame. speed: a value of --speed, or None."""

    def __init__(self, case, method, speed, seed):
        length, flags = {
            "filter": (1, ["--method", "filter"]),
            "windows": (case.window, ["--score", "zscore", "--decide", "margin"]),
            "FastABLE": (case.window, ["--t-r", 0])}[method]
        flags = [*flags, *(["--c-l", length] if length > 1 else [])]
        replay = ["--speed", speed, "--seed", seed] if speed else []
        with tempfile.TemporaryDirectory(dir=options.work) as folder:
            run("vpr-query", case.database, "--query", case.query, *flags, *replay, "-o", f"{folder}/r.json")
            description = json.loads(pathlib.Path(f"{folder}/r.json").read_text())
            arrays = dict(np.load(f"{folder}/r.npz"))
            best, recognized, keyframes = arrays["best"], arrays["recognitions"], arrays["keyframes"]
            self.frames = description["query"]["frames"]
            self.train_frames = description["sequences"][0]["frames"]
            self.train_keyframes = keyframes[keyframes[:, 0] == 0, 1]
            self.query_keyframes = keyframes[keyframes[:, 0] == -1, 1]
            self.source = arrays["source_frames"] if replay else np.arange(self.frames)
            confidence = -arrays["best_scores"] if method == "FastABLE" else arrays["margins"]
            self.reversed_frames = description["totals"].get("reversed_frames", 0)
            if method == "filter":
                self.decided = arrays["path"][:, 2]
        found = best[:, 2] >= 0
        query, train = best[:, 0] + length - 1, best[:, 2] + length - 1
        self.known = case.on_map(self)
        self.keyframe = self.keyframe_of(query)
        self.confidence = np.where(found, np.nan_to_num(confidence, nan=-np.inf), -np.inf)
        self.best_off = np.where(found, case.judge(self, query, np.maximum(train, 0)), np.inf)
        self.query, self.train = recognized[:, 0] + length - 1, recognized[:, 2] + length - 1
        self.off = case.judge(self, self.query, self.train)

    def keyframe_of(self, frames):
        return np.searchsorted(self.query_keyframes, frames, side="right")

    def counts(self):
        """Frames that are known, recognized correctly, by near misses, and incorrectly otherwise."""
        near = (self.off > 0) & (self.off <= NEAR_FRAMES)
        return np.array([self.known.sum(), (self.off == 0).sum(), near.sum(), (self.off > NEAR_FRAMES).sum()])

    def accepted(self, margin):
        """Frames that this margin of the filter accepts, and the correct ones of them."""
        is_accepted = self.confidence >= 1024 * margin
        return is_accepted.sum(), (is_accepted & (self.best_off == 0)).sum()

    def ranked(self, by_keyframe):
        """Recall at 100 % precision: correct frames of more confidence than any incorrect one. By
        keyframe, each keyframe of the query counts once, by its most confident frame."""
        chosen, known = np.arange(len(self.confidence)), np.flatnonzero(self.known)
        if by_keyframe:
            order = np.lexsort((-self.confidence, self.keyframe))
            chosen = order[np.unique(self.keyframe[order], return_index=True)[1]]
            known = np.unique(self.keyframe_of(known))
        off, confidence = self.best_off[chosen], self.confidence[chosen]
        return ((off == 0) & (confidence > confidence[off > 0].max(initial=-np.inf))).sum() / len(known)

    def delay(self):
        """Frames from the first frame on the map until the first correct recognition is reported."""
        decided = self.decided[self.query[self.off == 0]]
        return decided.min(initial=np.inf) - np.flatnonzero(self.known)[0]

    def cuts(self):
        """Per cut of a replay: frames after it that are recognized at the old place, and frames until
        the first correct recognition of a frame before the next cut is reported."""
        starts = np.flatnonzero(np.diff(self.source) != 1) + 1
        for start, end in zip(starts, [*starts[1:], self.frames]):
            part = (self.query >= start) & (self.query < end)
            passed = self.query - start + 1
            ahead = self.train - self.source[start - 1]  # of the place before the cut
            old = part & (self.off > 0) & (ahead >= -NEAR_FRAMES) & (ahead <= 2 * passed + NEAR_FRAMES)
            decided = self.decided[self.query[part & (self.off == 0)]]
            yield old.sum(), decided.min(initial=np.inf) - start


def database(name, sequence):
    path = options.work / f"{name}.vprdb"
    if not path.exists():
        run("vpr-train", "images", "--train", sequence, "-o", path)
    return path


def real_cases():
    data = options.data
    sets = {"corridor": (data / "corridor/query", data / "corridor/ref", 3, 40),
            "Nordland": (data / "nordland/winter", data / "nordland/summer", 2, 40),
            "loop": (f"{data}/loop/images@40:80", f"{data}/loop/images@0:40", 3, 20)}
    names = {"corridor": ("`query` in `ref`", "`ref` in `query`"),
             "Nordland": ("winter in summer", "summer in winter"),
             "loop": ("second lap in first", "first lap in second")}
    cases = {}
    for name, (one, other, tolerance, window) in sets.items():
        for title, query, train in zip(names[name], (one, other), (other, one)):
            place = database(f"{name} {title}".replace("`", "").replace(" ", "-"), train)
            cases[f"{name}, {title}"] = Case(place, query, aligned(tolerance), window)
    return cases


def tower_cases():
    floors = sorted((options.data / "tower").iterdir())
    return [Case(database(train.name, train), query, different_places())
            for train, query in itertools.permutations(floors, 2)]


def building(name):
    """Cases of a rendered building by the names of their walks. Besides the walks of the file: a floor
    above with the same plan, and another one, which are not trained."""
    folder = options.work / name.replace(" ", "-")
    if not folder.exists():
        world = json.loads((ROOT / "configs/worlds/speeds.json").read_text())
        world["seed"], world["resemblance"] = BUILDINGS[name]
        world["floors"].append({**world["floors"][0], "name": "above"})
        world["floors"].append({"name": "other", "rooms": [
            {"kind": "corridor", "x": 0, "y": 0, "width": 40, "depth": 3},
            {"kind": "hall", "x": 10, "y": 3, "width": 20, "depth": 8},
            {"kind": "corridor", "x": 37, "y": 3, "width": 3, "depth": 15}]})
        same = next(walk for walk in world["walks"] if walk["name"] == "same")
        world["walks"].append({**same, "name": "upstairs", "floor": "above"})
        world["walks"].append({**same, "name": "elsewhere", "floor": "other",
                               "path": [[1, 1.5], [38.5, 1.5], [38.5, 17]]})
        file = folder.with_suffix(".json")
        file.write_text(json.dumps(world))
        run("vpr-synth", file, "-o", folder)
    place = database(folder.name, folder / "trained")
    return {walk: Case(place, folder / walk, listed_pairs(folder / f"{walk}.ground_truth.csv"))
            for walk in ON_MAP + OFF_MAP}


def tracks():
    return [name for name in ("garage", "flat") if (options.data / "tracks" / name).exists()]


def foreign_cases():
    """Queries of other buildings, by map."""
    data = options.data
    walks = {"corridor": (data / "corridor/ref", data / "corridor/query"),
             "loop": (data / "loop/images", data / "loop/images"),
             "tower floor": (data / "tower/floor9", data / "tower/floor12"),
             "Nordland": (data / "nordland/summer", data / "nordland/winter"),
             "building 1": (options.work / "building-1/trained", options.work / "building-1/same"),
             **{name: (data / "tracks" / name / "a", data / "tracks" / name / "b") for name in tracks()}}
    return {name: [Case(database(f"map-{name.replace(' ', '-')}", train), query, different_places())
                   for other, (_, query) in walks.items() if other != name]
            for name, (train, _) in walks.items()}


def reversed_cases():
    """Queries that are replayed in reverse, by map."""
    cases = {name: [case] for name, case in real_cases().items() if "loop" not in name}
    for name in tracks():
        folder = options.data / "tracks" / name
        cases[name] = [Case(database(f"map-{name}", folder / "a"), folder / "b", different_places())]
    for [case] in cases.values():
        case.judge, case.on_map = different_places()
    return cases


def ring():
    """A rendered ring of corridors, walked three times."""
    folder = options.work / "ring"
    corners = [[1.5, 1.5], [22.5, 1.5], [22.5, 14.5], [1.5, 14.5]]
    walk = {"floor": "ring", "use": "train"}
    if not folder.exists():
        world = json.loads((ROOT / "configs/worlds/speeds.json").read_text())
        world["floors"] = [{"name": "ring", "rooms": [
            {"kind": "corridor", "x": 0, "y": 0, "width": 24, "depth": 3},
            {"kind": "corridor", "x": 21, "y": 0, "width": 3, "depth": 16},
            {"kind": "corridor", "x": 0, "y": 13, "width": 24, "depth": 3},
            {"kind": "corridor", "x": 0, "y": 0, "width": 3, "depth": 16}]}]
        world["walks"] = [{**walk, "name": "three", "path": 3 * corners + corners[:1]},
                          {**walk, "name": "one", "path": corners + corners[:1]},
                          {**walk, "name": "query", "use": "query", "path": corners + corners[:1],
                           "conditions": {"daylight": 0.7, "warmth": 0.2, "noise": 4}}]
        file = folder.with_suffix(".json")
        file.write_text(json.dumps(world))
        run("vpr-synth", file, "-o", folder)
    return folder


def lap_cases():
    """A query of one lap of a track, with one lap and with all laps of one recording trained."""
    cases = {"rendered ring": (ring() / "one", ring() / "three", ring() / "query")}
    for name in tracks():
        folder = options.data / "tracks" / name
        cases[name] = (f"{folder}/b@0:{ONE_LAP[name]}", folder / "b", folder / "a")
    return {name: [Case(database(f"{name.replace(' ', '-')}-{laps}", train), query, different_places())
                   for laps, train in (("one", one), ("all", every))]
            for name, (one, every, query) in cases.items()}


def dense_walks():
    """Rendered walks at a high frame rate."""
    folder = options.work / "dense"
    if not folder.exists():
        world = json.loads((ROOT / "configs/worlds/speeds.json").read_text())
        world.update(fps=DENSE_FPS, image_width=160, image_height=120)
        world["walks"] = [walk for walk in world["walks"] if walk["name"] in ("trained", "same", "varying")]
        file = folder.with_suffix(".json")
        file.write_text(json.dumps(world))
        run("vpr-synth", file, "-o", folder)
    return folder


def rate_cases():
    """Recordings of high frame rates, of which both sides have every n-th frame, by title."""
    dense = dense_walks()
    walks = {f"rendered walk, {name}": (dense / "trained", dense / name) for name in ("same", "varying")}
    for name, other in zip(tracks(), reversed(tracks())):
        folder = options.data / "tracks"
        walks[f"{name}, `b` in `a`"] = (folder / name / "a", folder / name / "b")
        walks[f"{other} in {name}, incorrect"] = (folder / name / "a", folder / other / "b")
    return {title: [Case(database(f"rate-{train.parent.name}-{step}", f"{train}@::{step}"), f"{query}@::{step}",
                         different_places()) for step in STEPS.values()]
            for title, (train, query) in walks.items()}


def entering_cases(rendered):
    """Queries that begin before the first trained frame: the first half of each recording is not trained."""
    data = options.data
    both = lambda a, b, tolerance: [(query, train, tolerance, None) for query, train in ((a, b), (b, a))]
    walks = {"corridor": both(data / "corridor/query", data / "corridor/ref", 3),
             "Nordland": both(data / "nordland/winter", data / "nordland/summer", 2),
             "rendered, same walk": [(cases["same"].query, cases["same"].query.with_name("trained"), 0,
                                      cases["same"].query.with_name("same.ground_truth.csv")) for cases in rendered.values()]}
    found = {}
    for name, sides in walks.items():
        for query, train, tolerance, file in sides:
            frames = len(list(train.iterdir()))
            first = frames // 2
            pairs = [(q, r) for q, r, label in rows_of_pairs(file) if label == "same"] if file else [
                (q, q + i) for q in range(frames) for i in range(-tolerance, tolerance + 1)]
            for step in ENTERING_STEPS:
                place = database(f"entering-{train.parent.name}-{train.name}-{step}", f"{train}@{first}::{step}")
                found.setdefault((name, step), []).append(
                    Case(place, f"{query}@::{step}", from_frame(first, step, pairs)))
    return found


def table(head, rows):
    lines = ["||" + "|".join(head) + "|", "|---|" + "---:|" * len(head)]
    return "\n".join(lines + [f"|{title}|" + "|".join(cells) + "|" for title, *cells in rows]) + "\n"


def share(results):
    """Recognized correctly in percent, and if any in parentheses near misses and other incorrect frames.
    Where nothing can be correct: recognized frames of all frames."""
    known, correct, near, others = sum(result.counts() for result in results)
    if not known:
        return f"{near + others} of {sum(result.frames for result in results)}"
    return f"{100 * correct / known:.0f}" + (f" ({near}+{others})" if near + others else "")


def ranking(results, by_keyframe=False):
    return f"{100 * np.mean([result.ranked(by_keyframe) for result in results]):.0f}"


def keyframe_ranking(results):
    return ranking(results, by_keyframe=True)


def delay(results):
    """The median delay of the filter, in frames."""
    return frames([result.delay() for result in results])[0]


def frames(values):
    """The median and the 0.9 quantile of delays, in frames."""
    ordered = sorted(values)
    number = lambda value: "never" if math.isinf(value) else f"{value:.0f}"
    return [number(ordered[math.ceil(part * len(ordered)) - 1]) for part in (0.5, 0.9)]


def measure(pool):
    """Lists of results by set, method and column. A set has one case, 30 pairs of floors, or a building."""
    real, tower = real_cases(), tower_cases()
    rendered = dict(zip(BUILDINGS, pool.map(building, BUILDINGS)))
    jobs = []  # set, method, column, case, speed, seed

    def add(name, case, method, column):
        seeds = (1, 2, 3) if column in RANDOM else (1,)
        jobs.extend((name, method, column, case, SPEEDS[column], seed) for seed in seeds)

    for name, case in real.items():
        for column, method in itertools.product(SPEEDS, METHODS):
            if column != "cuts" or "loop" not in name:  # a lap is too short
                add(name, case, method, column)
    for case in tower:
        for column in SPEEDS:
            add(TOWER, case, "filter", column)
        for column in WINDOW_SPEEDS:
            add(TOWER, case, "windows", column)
    for name, walks in rendered.items():
        jobs += [(name, method, walk, walks[walk], None, 1) for walk in walks for method in METHODS]
    for column, sets in ((FOREIGN, foreign_cases()), (REVERSED, reversed_cases()), (LAPS, lap_cases()),
                         (RATES, rate_cases()), (ENTERING, entering_cases(rendered))):
        for name, cases in sets.items():
            jobs += [(name, "filter", column, case, "reversed" if column == REVERSED else None, 1)
                     for case in cases]
    found = {}
    for job, result in zip(jobs, pool.map(lambda job: Result(job[3], job[1], *job[4:]), jobs)):
        found.setdefault(job[:3], []).append(result)
    return list(real), found


def tables(real, found):
    def cell(sets, methods, column, measure):
        """The numbers of these methods, separated by slashes."""
        results = [[one for name in sets for one in found.get((name, method, column), [])] for method in methods]
        return "/".join(measure(each) for each in results) if results[0] else ""

    def row(title, sets, methods, columns, measure):
        return [title, *(cell(sets, methods, column, measure) for column in columns)]

    filter_only, windows = ["filter"], ["windows"]
    yield "recognized", table(
        [*SPEEDS, *(f"windows, {speed}" for speed in WINDOW_SPEEDS)],
        [row(name, [name], filter_only, SPEEDS, share) + row(name, [name], windows, WINDOW_SPEEDS, share)[1:]
         for name in [*real, TOWER]])
    for title, rank in (("ranking", ranking), ("ranking of keyframes", keyframe_ranking)):
        yield title, table(RANKED_SPEEDS, [row(name, [name], RANKED, RANKED_SPEEDS, rank) for name in real])
    yield "delay", table(DELAY_SPEEDS, [row(name, [name], filter_only, DELAY_SPEEDS, delay) for name in real])
    rows = []
    for name in real:
        if results := found.get((name, "filter", "cuts")):
            old, new = zip(*(cut for result in results for cut in result.cuts()))
            rows.append([name, str(len(old)), str(max(old)), f"{100 * np.mean(np.isfinite(new)):.0f} %",
                         *frames(new)])
    yield "cuts", table(["cuts", "frames at the old place, at most", "recognized again", "delay: median",
                         "90 %"], rows)
    yield "rendered", table(ON_MAP + OFF_MAP, [
        row("filter", BUILDINGS, filter_only, ON_MAP + OFF_MAP, share),
        row("windows", BUILDINGS, windows, ON_MAP + OFF_MAP, share),
        row("ranking", BUILDINGS, RANKED, ON_MAP, ranking) + [""] * len(OFF_MAP),
        row("delay", BUILDINGS, filter_only, ON_MAP, delay) + [""] * len(OFF_MAP)])


def silence_tables(found):
    """Tables of queries off the map, of laps, and of margins."""
    results = lambda column: {name: each for (name, _, at), each in found.items() if at == column}
    rows = []
    for title, column in (("other buildings", FOREIGN), ("reversed", REVERSED)):
        for name, each in results(column).items():
            rows.append([f"{name}, {title}", str(sum(one.frames for one in each)),
                         str(sum(len(one.query) for one in each)),
                         str(sum(one.reversed_frames for one in each)),
                         f"{max(one.confidence.max() for one in each) / 1024:.1f}"])
    yield "silence", table(["frames", "recognized", "with reversed training sequences", "largest margin"], rows)
    yield "laps", table(["frames", "one lap trained", "all laps trained"],
                        [[name, str(one.frames), str(len(one.query)), str(len(every.query))]
                         for name, (one, every) in results(LAPS).items()])
    entering = results(ENTERING)
    off = lambda each: f"{sum((~one.known[one.query]).sum() for one in each)} of {sum((~one.known).sum() for one in each)}"
    on = lambda each: f"{100 * sum((one.off == 0).sum() for one in each) / sum(one.known.sum() for one in each):.0f}"
    yield "entering the map", table(
        [f"{words}{part}" for part in ("before the map", "on it, %") for words in ("", "every 2nd: ", "3rd: ")],
        [[name, *(measure(entering[name, step]) for measure in (off, on) for step in ENTERING_STEPS)]
         for name in dict.fromkeys(name for name, _ in entering)])
    yield "frame rates", table(
        [*STEPS], [[name, *(f"{100 * len(one.query) / one.frames:.0f}" for one in each)]
                   for name, each in results(RATES).items()])

    def row(title, names, column, index=1):
        each = [one for name in names for one in found[(name, "filter", column)]]
        whole = sum(one.known.sum() if index else one.frames for one in each)
        return [title, *(f"{100 * sum(one.accepted(margin)[index] for one in each) / whole:.{2 - index}f}"
                         for margin in MARGINS)]

    on_map = [name for name, _, column in found if column == "1.5x"]
    sets = {title: [name for name in dict.fromkeys(on_map) if title in name]
            for title in ("corridor", "Nordland", "loop")}
    yield "margins", table(
        [str(margin) for margin in MARGINS],
        [row("other buildings", results(FOREIGN), FOREIGN, 0), row("reversed", results(REVERSED), REVERSED, 0),
         row("tower", [TOWER], "equal speed", 0), row("rendered, same plan", BUILDINGS, "upstairs", 0),
         row("rendered, way back", BUILDINGS, "back", 0),
         *(row(title, names, "equal speed") for title, names in sets.items()),
         *(row(f"{title}, 1.5x", names, "1.5x") for title, names in sets.items() if title != "loop"),
         row("rendered, same walk", BUILDINGS, "same"),
         *([row("tracks", tracks(), LAPS, 0)] if tracks() else [])])


def write_into(page, name, text):
    begin, end = (f"<!-- {name}: {edge} -->\n" for edge in ("begin", "end"))
    before, rest = page.read_text().split(begin)
    page.write_text(before + begin + text + end + rest.split(end)[1])


def main():
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        options.work = (options.work or pathlib.Path(folder)).resolve()
        options.work.mkdir(parents=True, exist_ok=True)
        real, found = measure(pool)
        for name, text in itertools.chain(tables(real, found), silence_tables(found)):
            print(f"{name}\n{text}", flush=True)
            if options.into:
                write_into(options.into, name, text)


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("data", type=pathlib.Path)
parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
parser.add_argument("--work", type=pathlib.Path)
parser.add_argument("--into", type=pathlib.Path)
options = parser.parse_args()
options.data, options.bin = options.data.resolve(), options.bin.resolve()
main()
