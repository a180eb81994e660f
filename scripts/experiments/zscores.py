#!/usr/bin/python3
"""Prints the table of docs/experiments/zscores.md: zscores.py DATA [BIN]. DATA: folder with
corridor/ and nordland/. R@1 is the percentage of best matches that are correct, R@100P the
percentage of windows before the first incorrect one in order of score. Needs numpy."""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

STANDING_BITS = 100  # a frame this close to the previous one shows a standing camera
data = pathlib.Path(sys.argv[1]).resolve()
binaries = pathlib.Path(sys.argv[2] if len(sys.argv) > 2
                        else pathlib.Path(__file__).resolve().parents[2] / "build/release/bin").resolve()
work = tempfile.TemporaryDirectory()
out = pathlib.Path(work.name)


def run(program, *words):
    subprocess.run([binaries / program, *map(str, words), "--force", "--quiet"], check=True)


def train(name, sequence):
    run("vpr-train", "fastable", "--train", sequence, "-o", out / f"{name}.vprdb")
    return out / f"{name}.vprdb"


def cell(database, query, tolerance, length, score, settings):
    (out / "config.json").write_text(json.dumps({"zscore": settings}))
    run("vpr-query", database, "--query", query, "--config", out / "config.json", "--score", score,
        "--t-r", 0, "--c-l", length, "-o", out / "r.json")
    best, scores = np.load(out / "r.best.npy"), np.load(out / "r.best_scores.npy")
    correct = np.abs(best[:, 2] - best[:, 0]) <= tolerance
    early = np.append(correct[np.argsort(scores, kind="stable")], False).argmin()
    return f"{100 * correct.mean():.1f}/{100 * early / len(correct):.0f}"


def sequence(name, frames):
    """A list of frames as a sequence."""
    path = out / f"{name}.txt"
    path.write_text("".join(f"{frame}\n" for frame in frames))
    return path


def slow(name):
    """A quarter of the speed: every frame four times."""
    frames = sorted((data / "corridor" / name).iterdir())
    return sequence(f"slow-{name}", [frame for frame in frames for _ in range(4)])


def moving():
    """Nordland without the frames in which the train stands in both seasons."""
    seasons = {name: train(name, data / "nordland" / name) for name in ("summer", "winter")}
    moves = np.zeros(1500, bool)
    moves[0] = True
    for database in seasons.values():
        codes = np.load(database / "codes.npy")
        change = np.unpackbits(codes[1:] ^ codes[:-1], axis=1).sum(axis=1, dtype=int)
        moves[1:] |= change >= STANDING_BITS
    frames = {name: (database / "frames.txt").read_text().splitlines()
              for name, database in seasons.items()}
    return [sequence(f"moving-{name}", [data / "nordland" / name / frames[name][i]
                                        for i in np.flatnonzero(moves)]) for name in seasons]


def steps():
    """The effect of each step of z-scores, as R@1/R@100P."""
    variants = [
        ("raw distances", "raw", {}), ("`zscore`", "zscore", {}),
        ("1 off: rows not centered", "zscore", {"center": False}),
        ("2 off: no components", "zscore", {"components": 0}),
        ("3 off: nothing learned", "zscore", {"learn": False}),
        ("3 off: no start", "zscore", {"start_weight": 0}),
        ("3: all of the bias", "zscore", {"start_bias": 1}),
        ("4 off: one deviation for all", "zscore", {"divide": False}),
        ("every frame is a keyframe", "zscore", {"keyframe_change": 0}),
        ("lag of one keyframe", "zscore", {"lag_keyframes": 1}),
        ("`zscore-offline`", "zscore-offline", {})]
    summer, winter = moving()
    sets = [("corridor", data / "corridor/ref", data / "corridor/query", 3, [5, 10]),
            ("slow corridor", slow("ref"), slow("query"), 12, [20]),
            ("Nordland", data / "nordland/summer", data / "nordland/winter", 2, [20]),
            ("moving", summer, winter, 2, [20])]
    columns = [(name, train(name, trained), query, tolerance, length)
               for name, trained, query, tolerance, lengths in sets for length in lengths]
    print("| | " + " | ".join(f"{name}, {length}" for name, *_, length in columns) + " |")
    print("|---|" + "---:|" * len(columns))
    for title, score, settings in variants:
        cells = [cell(*column[1:], score, settings) for column in columns]
        print(f"| {title} | " + " | ".join(cells) + " |", flush=True)


steps()
