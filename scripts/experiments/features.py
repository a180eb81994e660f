#!/usr/bin/python3
"""Compares kinds of local features and of geometric checks as a second witness (docs/experiments/witness.md).

  scripts/experiments/features.py DATA [--bin BIN]

DATA: folder with corridor/, loop/, tower/ and tracks/. Best matches are those of the filter without features.
For up to 40 evenly spaced query frames of each set, inliers with the match and its two neighbors are compared
with inliers with six other places. Contrast is log((a + 4) / (b + 4)) of the most inliers of both; a win has
a > b. Prints a Markdown table: median contrast and wins by set. Needs numpy and python3-opencv."""
import argparse
import functools
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

TRIED = {  # features, their number, longer side in pixels, geometric check, matches
    "ORB, 150": ("orb", 150, 320, "similarity", "ratio"),
    "ORB, 500": ("orb", 500, 320, "similarity", "ratio"),
    "ORB, 150, mutual": ("orb", 150, 320, "similarity", "mutual"),
    "ORB, 150, homography": ("orb", 150, 320, "homography", "ratio"),
    "ORB, 500, fundamental": ("orb", 500, 320, "fundamental", "ratio"),
    "ORB, 500, USAC fundamental": ("orb", 500, 320, "usac", "ratio"),
    "AKAZE, 150": ("akaze", 150, 320, "similarity", "ratio"),
    "SIFT, 150": ("sift", 150, 320, "similarity", "ratio"),
    "ORB, 150, 640 pixels": ("orb", 150, 640, "similarity", "ratio"),
}
SETS = {"corridor": ("corridor/ref", "corridor/query"), "garage": ("tracks/garage/a", "tracks/garage/b"),
        "flat": ("tracks/flat/a", "tracks/flat/b"), "tower": ("tower/floor9", "tower/floor12"),
        "garage in flat": ("tracks/flat/a", "tracks/garage/a")}
WRONG = {"tower", "garage in flat"}


def finder(kind, count):
    if kind == "akaze":
        return cv2.AKAZE_create(threshold=0.0005)
    return cv2.SIFT_create(count) if kind == "sift" else cv2.ORB_create(count, 2, 1, 16, fastThreshold=10)


@functools.lru_cache(maxsize=4000)
def features(path, kind, count, side):
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    divisor = round(max(image.shape) / side)
    if divisor > 1:
        image = cv2.resize(image, None, fx=1 / divisor, fy=1 / divisor, interpolation=cv2.INTER_AREA)
    points, bits = finder(kind, count).detectAndCompute(image, None)
    if bits is None:
        return np.zeros((0, 2), np.float32), None
    best = sorted(range(len(points)), key=lambda i: -points[i].response)[:count]
    return np.float32([points[i].pt for i in best]), bits[best]


def inliers(query, train, kind, check, matches):
    (points, bits), (others, other_bits) = query, train
    if bits is None or other_bits is None or min(len(bits), len(other_bits)) < 2:
        return 0
    matcher = cv2.BFMatcher(cv2.NORM_L2 if kind == "sift" else cv2.NORM_HAMMING, crossCheck=matches == "mutual")
    if matches == "mutual":
        pairs = [(match.queryIdx, match.trainIdx) for match in matcher.match(bits, other_bits)]
    else:
        pairs = [(first.queryIdx, first.trainIdx) for first, second in matcher.knnMatch(bits, other_bits, 2)
                 if first.distance < 0.8 * second.distance]
    if len(pairs) < 8:
        return len(pairs) // 4
    a, b = (np.float32([side[p] for p in index]) for side, index in zip((points, others), zip(*pairs)))
    cv2.setRNGSeed(1)
    find = {"similarity": lambda: cv2.estimateAffinePartial2D(a, b, ransacReprojThreshold=8)[1],
            "homography": lambda: cv2.findHomography(a, b, cv2.RANSAC, 8)[1],
            "fundamental": lambda: cv2.findFundamentalMat(a, b, cv2.FM_RANSAC, 3)[1],
            "usac": lambda: cv2.findFundamentalMat(a, b, cv2.USAC_DEFAULT, 3, 0.99, 1000)[1]}
    mask = find[check]()
    return 0 if mask is None else int(mask.sum())


def matches_of(train, query, folder):
    """Pairs of query and training frame: the best matches of the filter, recognized ones if there are any."""
    for command in (["vpr-train", "images", "--train", train, "--features", "none", "-o", f"{folder}/db"],
                    ["vpr-query", f"{folder}/db", "--query", query, "-o", f"{folder}/r.json"]):
        subprocess.run([options.bin / command[0], *command[1:], "--force", "--quiet"], check=True)
    arrays = np.load(f"{folder}/r.npz")
    rows = arrays["recognitions"] if len(arrays["recognitions"]) else arrays["best"]
    rows = rows[rows[:, 2] >= 0]
    return rows[np.linspace(0, len(rows) - 1, min(40, len(rows))).astype(int)][:, [0, 2]]


def measure(case, pairs, train, query):
    kind, count, side, check, matches = case
    contrasts, wins = [], []
    for q, t in pairs:
        own = features(query[q], kind, count, side)
        near = [features(train[k], kind, count, side) for k in range(max(t - 1, 0), min(t + 2, len(train)))]
        away = len(train) // 8
        far = [features(train[(t + away + step * (len(train) - 2 * away) // 6) % len(train)], kind, count, side)
               for step in range(6)]
        a, b = (max(inliers(own, one, kind, check, matches) for one in some) for some in (near, far))
        contrasts.append(np.log((a + 4) / (b + 4)))
        wins.append(a > b)
    return f"{np.median(contrasts):.2f}, {100 * np.mean(wins):.0f} %"


def frames(folder):
    return sorted(path for path in folder.iterdir() if path.suffix in (".jpg", ".png"))


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("data", type=pathlib.Path)
parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/release/bin"))
options = parser.parse_args()
loop = sorted((options.data / "loop/images").iterdir(), key=lambda path: int(path.stem))
with tempfile.TemporaryDirectory() as folder:
    cases = {}
    for number, lap in enumerate((loop[:40], loop[40:80])):
        pathlib.Path(folder, f"lap{number}").mkdir()
        for i, path in enumerate(lap):
            pathlib.Path(folder, f"lap{number}", f"{i:02}{path.suffix}").symlink_to(path.resolve())
    named = {"loop": (pathlib.Path(folder, "lap0"), pathlib.Path(folder, "lap1"))}
    named |= {name: tuple(options.data / part for part in pair) for name, pair in SETS.items()}
    for name, (train, query) in named.items():
        cases[name] = (matches_of(train, query, folder), frames(train), frames(query))
    print("| | " + " | ".join(name + (", wrong" if name in WRONG else "") for name in cases) + " |")
    print("|---|" + "---:|" * len(cases))
    for title, case in TRIED.items():
        print(f"| {title} | " + " | ".join(measure(case, *one) for one in cases.values()) + " |", flush=True)
