#!/usr/bin/python3
"""Runs the programs that run.sh has built next to vpr-toolkit, and writes docs/benchmarks/peers.md.

  compare.py --work FOLDER --bin BIN [--data DATA] [--seconds N] [--rounds N] -o PAGE

FOLDER: builds and clones.txt of run.sh, which starts this script. Times are medians of rounds in which
all programs run in turn on one core; ratios are medians of the ratios of a round. Needs numpy."""
import argparse
import datetime
import json
import os
import pathlib
import re
import subprocess
import sys
import textwrap
import types

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
BITS, BYTES = 1386, 174  # of an LDB code
SPEEDS = {"1": None, "0.67": "0.67", "1.5": "1.5", "2": "2", "varying": "varying"}
SETS = {"corridor": ("corridor/query", "corridor/ref", 3), "Nordland": ("nordland/winter", "nordland/summer", 2)}
MARGIN = ["--score", "zscore", "--decide", "margin"]
OURS = {"vpr-toolkit, windows of 20": (20, [*MARGIN, "--c-l", 20]),
        "vpr-toolkit, five rates, 30": (30, [*MARGIN, "--c-l", 30, "--rates", "1/2,2/3,1,3/2,2"]),
        "vpr-toolkit, filter": (1, ["--method", "filter"])}
VELOCITIES = {"seqslam": (0.9, 1.6, 15), "seqslam, wide": (0.4, 2.2, 37)}  # least, largest, trajectories
LOCALIZER = (5, 0.3, 2)  # fan-out and expansion rate by default; threshold: the best of 2, 2.5, 3.7, 5
REPOSITORIES = {"fastable": "LRMPUT/FastABLE", "openable": "roberto-arroyo/OpenABLE",
                "openfabmap": "arrenglover/openfabmap", "seqslam": "TimQuelch/seqslam",
                "localizer": "ovysotska/image_sequence_localizer",
                "vpr-methods": "gmberton/VPR-methods-evaluation"}


def run(*words):
    command = ["taskset", "-c", str(options.core), *(str(word) for word in words)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=options.work)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: failed.\n{done.stderr}")
    return done.stdout + done.stderr


def ours(program, *words):
    return run(options.bin / program, *words, "--quiet", "--threads", 1, "--force")


def bench(*words):
    """Median milliseconds by work."""
    rows = json.loads(run(options.bin / "vpr-bench", *words, "--seconds", options.seconds, "--quiet", "--json"))["rows"]
    return {row["work"]: row["median_ms"] for row in rows}


def in_turn(measures):
    """Calls every measure once per round; medians by name, and medians of the ratios to the first one."""
    rounds = np.array([[measure() for measure in measures.values()] for _ in range(options.rounds)])
    return (dict(zip(measures, np.median(rounds, axis=0))),
            dict(zip(measures, np.median(rounds / rounds[:, :1], axis=0))))


def number(value):
    """Two significant digits, no rounding before the point."""
    return f"{value:#.2g}" if value < 10 else f"{value:.0f}"


def table(head, rows):
    lines = ["|" + "|".join(head) + "|", "|---|" + "---:|" * (len(head) - 1)]
    return "\n".join(lines + ["|" + "|".join(row) + "|" for row in rows]) + "\n"


def exported(sequence, *flags):
    """A database of the sequence, and its descriptors."""
    name = re.sub(r"\W", "-", "-".join(map(str, (sequence, *flags))))
    base = options.work / name
    if not base.with_suffix(".npy").exists():
        ours("vpr-train", "fastable", "--train", options.data / sequence, *flags, "-o", f"{base}.vprdb")
        ours("vpr-train", "export", f"{base}.vprdb", "--descriptors", f"{base}.npy")
    return f"{base}.vprdb", np.load(f"{base}.npy")


def fastable_difference():
    """FastABLE's distances on the codes of the corridor, by our definition and by its own."""
    query, train, _ = SETS["corridor"]
    length = 20
    database, references = exported(train)
    queries = exported(query)[1]
    for name, codes in (("train", references), ("query", queries)):
        codes.tofile(options.work / f"{name}.codes")
    run("fastable/build/FastABLE_vs_OpenABLE", "fastable/config.txt", "check", "train.codes", "query.codes", BYTES,
        length, "openable.f32", "fastable.f32")
    ours("vpr-query", database, "--query", options.data / query, "--method", "fastable", "--c-l", length, "--t-r", 0,
         "--save-matrix", "distances.npy", "-o", "distances.json")
    distances = np.load(options.work / "distances.npy")
    openable, fastable = (np.fromfile(options.work / f"{name}.f32", "<f4").reshape(distances.shape)
                          for name in ("openable", "fastable"))
    bits = lambda codes: np.unpackbits(codes, axis=1).astype(np.int32)
    frame = (bits(queries)[:, None] != bits(references)[None]).sum(2)
    published = distances.astype(np.int64)
    for j in range(1, len(published)):  # subtracts the first term of the window itself
        published[j, 1:] = (published[j - 1, :-1] + frame[j + length - 1, length:length + len(published[0]) - 1]
                            - frame[j, 1:len(published[0])])
    if not (openable == distances).all() or not (fastable == published).all():
        sys.exit("FastABLE's distances are not what this page states. Read fastable_difference in compare.py.")
    off = np.abs(fastable - distances)
    return (f"On corridor codes, c_l {length}, its OpenABLE function and vpr-toolkit give equal distances. Its "
            "FastABLE subtracts the first frame pair of the new window, d(j, i), instead of the outgoing pair "
            f"d(j - 1, i - 1): {100 * (off > 0).mean():.0f} % of its distances differ, by up to {off.max():.0f} bits. "
            "That index reproduces all of them.\n")


def fastable():
    driver = "FastABLE_vs_OpenABLE"
    rows, openable = [], ""
    for frames in (1000, 10_000, 100_000):
        def timed(build):
            return lambda: float(run(f"{build}/build/{driver}", "fastable/config.txt", "time", frames, BYTES, 300,
                                     options.seconds))
        latest = {}
        def online():
            latest.update(bench("matching", "--methods", "fastable-online,fastable", "--databases", frames,
                                "--c-l", 300))
            return latest["fastable-online"]
        times, ratios = in_turn({"online": online, "batch": lambda: latest["fastable"], "built": timed("fastable"),
                                 "native": timed("fastable-native")})
        rows.append([f"{frames:,}".replace(",", " ") if frames >= 10_000 else str(frames),
                     *(number(times[name]) for name in ("built", "native", "online", "batch")),
                     f"{number(ratios['built'])}/{number(ratios['native'])}"])
    if "openable" in clones:
        times, ratios = in_turn({
            "ours": lambda: bench("matching", "--methods", "openable", "--databases", 1000, "--c-l", 300)["openable"],
            "theirs": lambda: float(run("openable/build/Test_OpenABLE", "openable/Config.txt", "time", 1000, BYTES, 300,
                                        options.seconds))})
        openable = (f"\nOpenABLE takes {number(times['theirs'])} ms at 1000 frames, {number(ratios['theirs'])} times "
                    "vpr-toolkit's `openable`. Its distance adds values of differing bytes instead of counting bits.\n")
    text = ("## FastABLE\n\nMilliseconds per query frame, c_l 300, random codes: as its CMake file builds it (without "
            "hardware bit count), with `-march=native`, vpr-toolkit online and in batch; ratios of both builds to "
            "online.\n\n" +
            table(["training frames", "as built", "native", "online", "batch", "ratios"], rows))
    return text + ("\n" + fastable_difference() if options.data else "") + openable


def openfabmap():
    text = "## OpenFABMAP\n\n"
    if options.data and all((options.data / name).exists() for name in ("loop", "tower")):
        floors = sorted((options.data / "tower").iterdir())[:4]
        convert = [sys.executable, ROOT / "scripts/convert/openfabmap.py"]
        if not (options.work / "yaml").exists():
            pretrain = [word for floor in floors for word in ("--pretrain", floor)]
            ours("vpr-train", "fabmap", *pretrain, "--train", options.data / "loop/images", "--features", "sift",
                 "--words", 500, "-o", "words.vprdb")
            run(*convert, "words.vprdb", "-o", "yaml")
            for name in ("vocabulary", "tree", "bow-pretrain", "bow-train"):
                run(*convert, f"yaml/{name}.yml", "-o", f"yaml/{name}.npy")
        ours("vpr-train", "fabmap", "--from-openfabmap", "--features", "sift", "--vocabulary", "yaml/vocabulary.npy",
             "--tree", "yaml/tree.npy", "--pretrain-bow", "yaml/bow-pretrain.npy", "--train-bow",
             "yaml/bow-train.npy@0:40", "-o", "fabmap.vprdb")
        ours("vpr-query", "fabmap.vprdb", "--query-bow", "yaml/bow-train.npy@40:80", "--save-posteriors",
             "posteriors.npy", "-o", "fabmap.json")
        load = lambda name, dtype: np.load(options.work / f"yaml/{name}.npy").astype(dtype)
        tree, bow = load("tree", "f8"), load("bow-train", "f4")
        arrays = {"tree.raw": tree, "pretrain.raw": load("bow-pretrain", "f4"), "places.raw": bow[:40],
                  "queries.raw": bow[40:80]}
        for name, array in arrays.items():
            array.tofile(options.work / name)
        run("./openfabmap", "check", tree.shape[1], *arrays, "posteriors.f64")
        mine = np.load(options.work / "posteriors.npy")
        theirs = np.fromfile(options.work / "posteriors.f64").reshape(mine.shape)
        text += (f"FabMap2 on the loop (40 places and queries, {tree.shape[1]} SIFT words): the "
                 f"largest difference of {mine.size} posteriors, new place included, is "
                 f"{np.abs(mine - theirs).max():.0e}. ")
    places, words, per_frame, pretrained = 10_000, 10_000, 200, 1000
    part = {}  # of the last query: likelihoods alone
    def mine():
        row = bench("fabmap", "--variants", "fabmap2", "--places", places, "--words", words, "--words-per-frame",
                    per_frame, "--count", 0)
        part["mine"] = row["fabmap2"]
        return row["query"]
    def theirs():
        done = run("./openfabmap", "time", words, places, per_frame, pretrained, options.seconds)
        part["theirs"], query = map(float, done.split())
        return query
    times, ratios = in_turn({"mine": mine, "theirs": theirs, "my part": lambda: part["mine"],
                             "their part": lambda: part["theirs"]})
    return text + (
        f"{places // 1000} 000 places, {words // 1000} 000 words, {per_frame} per frame, new place from {pretrained} "
        "frames: "
        f"{times['theirs']:.2f} ms per query against {times['mine']:.3f} ({number(ratios['theirs'])} times), "
        f"likelihoods alone {times['their part']:.2f} against {times['my part']:.3f} "
        f"({number(times['their part'] / times['my part'])} times).\n")


class Answer:
    """The best training frame (-1: none) and the confidence of every query frame; seconds of matching."""

    def __init__(self, frames, seconds):
        self.train, self.confidence, self.seconds = np.full(frames, -1), np.full(frames, -np.inf), seconds


def own_answer(method, name, speed, seed):
    query, train, _ = SETS[name]
    length, flags = OURS[method]
    replay = ["--speed", speed, "--seed", seed] if speed else []
    ours("vpr-query", exported(train)[0], "--query", options.data / query, *flags, *replay, "-o", "r.json")
    read = lambda part: np.load(options.work / f"r.{part}.npy")
    description = json.loads((options.work / "r.json").read_text())
    answer = Answer(description["query"]["frames"], description["timing"]["match_s"])
    best, margins = read("best"), read("margins")
    behind = train_behind = np.zeros(len(best), int)  # from the last frame of a window to the judged one
    if "rates" in method:
        behind = np.full(len(best), length // 2)
        train_behind = np.floor(behind * np.nan_to_num(read("best_rates"), nan=1) + 0.5).astype(int)
    found = best[:, 2] >= 0
    frames = (best[:, 0] + length - 1 - behind)[found]
    answer.train[frames] = (best[:, 2] + length - 1 - train_behind)[found]
    answer.confidence[frames] = np.nan_to_num(margins, nan=-np.inf)[found]
    answer.accepted = (read("recognitions")[:, [0, 2]] + length - 1).T
    answer.source = read("source_frames") if speed else np.arange(answer.train.size)
    return answer


def frames_of(sequence):
    return sorted(path for path in (options.data / sequence).iterdir() if path.suffix in (".jpg", ".png"))


def seqslam_answer(method, name, source):
    query, train, _ = SETS[name]
    recorded = frames_of(query)
    for file, paths in (("references.txt", frames_of(train)), ("queries.txt", [recorded[s] for s in source])):
        (options.work / file).write_text("".join(f"{path}\n" for path in paths))
    done = run("./seqslam", "references.txt", "queries.txt", *VELOCITIES[method], "seqslam.out")
    answer = Answer(len(source), float(done.split()[1]))
    best, scores = np.loadtxt(options.work / "seqslam.out").T
    answer.train = best.astype(int)
    answer.confidence = np.where(best >= 0, -scores, -np.inf)
    return answer


def localizer_answer(name, source):
    query, train, _ = SETS[name]
    signs = lambda sequence: 1.0 - 2 * np.unpackbits(exported(sequence)[1], axis=1, count=BITS)
    similarities = np.maximum(signs(query)[source] @ signs(train).T / BITS, 1e-3)  # cosine of the codes
    similarities.tofile(options.work / "similarities.f64")
    done = run("./localizer", "similarities.f64", *similarities.shape, *LOCALIZER, "localizer.out")
    seconds = float(done.split()[-1])
    answer = Answer(len(source), seconds)
    frames, matches, real = np.loadtxt(options.work / "localizer.out", int, ndmin=2).T
    answer.train[frames] = matches
    answer.confidence[frames] = similarities[frames, matches]
    answer.accepted = frames[real == 1], matches[real == 1]
    return answer


def recall(answer, source, tolerance):
    """R@1 and recall at 100 % precision, of all query frames."""
    found = answer.train >= 0
    correct = found & (np.abs(answer.train - source) <= tolerance)
    highest_error = answer.confidence[found & ~correct].max(initial=-np.inf)
    return correct.mean(), (correct & (answer.confidence > highest_error)).mean()


def answer_of(method, name, speed, seed, source):
    if method in OURS:
        return own_answer(method, name, speed, seed)
    return localizer_answer(name, source) if method == "localizer" else seqslam_answer(method, name, source)


def recognition_tables(methods):
    for name, (query, train, tolerance) in SETS.items():
        cells = {method: [] for method in methods}
        for speed in SPEEDS.values():
            values = {method: [] for method in methods}
            for seed in (1, 2, 3) if speed == "varying" else (1,):
                source = None  # of our first method
                for method in methods:
                    answer = answer_of(method, name, speed, seed, source)
                    source = answer.source if source is None else source
                    values[method].append(recall(answer, source, tolerance))
            means = 100 * np.array([np.mean(values[method], axis=0) for method in methods])
            for method, shares, best in zip(methods, means, means.round() == means.round().max(axis=0)):
                cells[method].append("/".join(f"**{share:.0f}**" if is_best else f"{share:.0f}"
                                              for share, is_best in zip(shares, best)))
        yield table([f"{name}, {len(frames_of(query))} frames, within {tolerance}", *SPEEDS],
                    [[method, *row] for method, row in cells.items()])


def sequences():
    peers = [*(VELOCITIES if "seqslam" in clones else []), *(["localizer"] if "localizer" in clones else [])]
    text = ("## SeqSLAM and graph search\n\nRecall@1 / recall at 100 % precision by the program's own confidence, in % "
            "of query frames, by speed (varying: mean of three seeds); best in bold. "
            "Settings of vpr-toolkit were chosen on these and other sets.\n\n" +
            "\n".join(recognition_tables([*OURS, *peers])) + "\n")
    name = "Nordland"
    source = np.arange(len(frames_of(SETS[name][0])))
    times, _ = in_turn({method: (lambda method=method: answer_of(method, name, None, 1, source).seconds)
                        for method in [*list(OURS)[1:], *peers]})
    text += f"Seconds of matching {name} at speed 1: " + "; ".join(
        f"{number(value)} {method}" for method, value in times.items()) + ".\n\n"
    if "seqslam" in clones:
        text += "seqslam: speeds 0.9 to 1.6 (its `config.json`); wide: 0.4 to 2.2. "
    if "localizer" in clones:
        def accepted(method):
            frames, matches = answer_of(method, name, None, 1, source).accepted
            correct = np.abs(source[frames] - matches) <= SETS[name][2]
            return f"{correct.sum()}/{(~correct).sum()}"
        text += ("localizer: search alone, with cosines of our LDB codes (its authors use networks) and threshold "
                 f"{LOCALIZER[2]}, the best of four. When lost, it searches near the query's index, the right place at "
                 f"speed 1. Frames that it accepts at speed 1 on {name}, correct/incorrect: {accepted('localizer')}; "
                 f"filter: {accepted('vpr-toolkit, filter')}.\n")
    return text.rstrip() + "\n"


def vpr_methods():
    """Executes the lines of its main.py that count recall; its search by faiss is replaced."""
    source = (clones["vpr-methods"][0] / "main.py").read_text()
    counting = re.search(r"^ *positives_per_query = .*?^ *recalls = recalls / [^\n]*\n", source,
                         re.MULTILINE | re.DOTALL)
    if not counting:
        sys.exit("main.py of VPR-methods-evaluation has no counting of recall that this script knows.")
    cells = []
    for name, (query, train, tolerance) in SETS.items():
        queries, references = (exported(sequence, "--descriptor", "thumbnail")[1].astype("f4")
                               for sequence in (query, train))
        queries, references = (x.reshape(len(x), -1) for x in (queries, references))
        squared = ((queries.astype(float) ** 2).sum(1)[:, None] - 2 * queries.astype(float) @ references.astype(float).T
                   + (references.astype(float) ** 2).sum(1))
        positives = [np.arange(max(0, q - tolerance), q + tolerance + 1) for q in range(len(queries))]
        space = {"np": np, "args": types.SimpleNamespace(recall_values=[1, 5, 10, 20]),
                 "test_ds": types.SimpleNamespace(get_positives=lambda: positives, num_queries=len(queries)),
                 "predictions": np.argsort(squared, axis=1, kind="stable")[:, :20]}
        exec(textwrap.dedent(counting[0]), space)
        for file, array in (("q.npy", queries), ("t.npy", references)):
            np.save(options.work / file, array)
        report = json.loads(ours("vpr-eval", "matrix", "--query-npy", "q.npy", "--train-npy", "t.npy", "--metric", "l2",
                                 "--ground-truth", "aligned", "--tolerance", tolerance, "--json"))
        mine = [100 * report["metrics"]["recall_at"][str(k)] for k in (1, 5, 10, 20)]
        if np.abs(mine - space["recalls"]).max() > 1e-9:
            sys.exit(f"{name}: recall@K is {mine} by vpr-eval and {space['recalls']} by VPR-methods-evaluation.")
        cells.append(f"{name} " + ", ".join(f"{value:.1f}" for value in mine))
    return ("## VPR-methods-evaluation\n\nIts lines that count recall were executed on thumbnails, nearest "
            "first by Euclidean distance (no networks, no faiss). Recall@1, 5, 10, 20 in % "
            f"equals `vpr-eval matrix --metric l2`: {'; '.join(cells)}.\n")


FEATURES = """## Features

Read in the sources. OpenSeqSLAM2 (02c6ed1, needs MATLAB) and VPR-Bench (77ad30f, Python 2 and Caffe) were not run.

|program|sequences|decides|descriptors|evaluates|
|---|---|---|---|---|
|vpr-toolkit|several speeds|yes|any|curves, recall@K, places|
|FastABLE (GPL)|equal speed|yes|LDB|by hand|
|OpenABLE|equal speed|threshold|9|no|
|OpenFABMAP|no|probability|words|no|
|seqslam|several speeds|no|pixels|curves|
|localizer|several speeds|threshold|any|no|
|OpenSeqSLAM2|several speeds|tuned threshold|pixels|curve|
|VPR-Bench|no|no|8|curves, recall@K|
|VPR-methods-evaluation|no|no|networks|recall@K|

Only there: stereo, panoramas (OpenABLE), OpenCL (seqslam), graphical interface (OpenSeqSLAM2), viewpoint
invariance (VPR-Bench), networks (the last two).
"""


def page():
    machine = re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    text = lambda *words: subprocess.run(words, capture_output=True, text=True).stdout.strip()
    compiler = text("g++", "--version").splitlines()[0].split()[-1]
    opencv = text("pkg-config", "--modversion", "opencv4")
    version = text(str(options.bin / "vpr-bench"), "--version").splitlines()[0]
    named = ", ".join(f"{REPOSITORIES[name]} {clones[name][1]}" for name in REPOSITORIES if name in clones)
    parts = ["# Published programs next to vpr-toolkit\n\nWritten by "
             f"[scripts/peers/run.sh](../../scripts/peers/run.sh) on {datetime.date.today()}: {version}, {named}. "
             f"{machine[1] if machine else 'unknown processor'}, g++ {compiler}, OpenCV {opencv}, one core, medians of "
             f"{options.rounds} interleaved rounds. Nothing of "
             "theirs is in this repository.\n"]
    parts += [part() for name, part in (("fastable", fastable), ("openfabmap", openfabmap)) if name in clones]
    if options.data and {"seqslam", "localizer"} & clones.keys():
        parts.append(sequences())
    if options.data and "vpr-methods" in clones:
        parts.append(vpr_methods())
    return "\n".join([*parts, FEATURES])


def read_clones():
    lines = [line.split() for line in (options.work / "clones.txt").read_text().splitlines()]
    return {name: (pathlib.Path(path), commit) for name, path, commit in lines}


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--work", type=pathlib.Path, required=True)
parser.add_argument("--bin", type=pathlib.Path, required=True)
parser.add_argument("--data", default="")
parser.add_argument("--seconds", type=float, default=1)
parser.add_argument("--rounds", type=int, default=5)
parser.add_argument("-o", dest="page", type=pathlib.Path, required=True)
options = parser.parse_args()
options.data = pathlib.Path(options.data) if options.data else None
options.core = max(os.sched_getaffinity(0))
clones = read_clones()
text = page()
options.page.write_text(text)
print(f"{options.page}: {len(text.split())} words")
