#!/usr/bin/env python3
"""Ordinary inputs are read right, or refused with a sentence.   misread.py SOURCE BIN"""
import json
import shutil
import subprocess
import time

import numpy as np
from PIL import Image

from support import call, folder, ok, programs, refused, run, write


def said(*words):
    """The standard error of a program that succeeds, as one line."""
    return " ".join(ok(call(*words)).stderr.split())


def printed_json(*words):
    return json.loads(run(*words, "--json"))


def same_pairs(*words):
    return printed_json("vpr-eval", "check", *words)["pairs"]["same"]


def columns_of_poses():
    for column, up in (("z", "3.5"), ("floor", "1")):
        for name, value in (("ground", "0"), ("first", up)):
            write(f"{name}-{column}.csv", f"frame,x,y,{column}\n" + "".join(f"{i},{10 * i},0,{value}\n" for i in range(20)))
        near = ("--ground-truth-train", f"ground-{column}.csv", "--radius", 1)
        assert same_pairs(f"first-{column}.csv", *near) == 0, column
        assert same_pairs(f"ground-{column}.csv", *near) == 20, column
    for floor in ("1.0", "01", "nan"):
        write("floor.csv", "frame,x,y,floor\n" + "".join(f"{i},{10 * i},0,{floor}\n" for i in range(20)))
        assert same_pairs("floor.csv", "--ground-truth-train", "first-floor.csv", "--radius", 1) == 20, floor
    assert "no floor or UTM zone of the query (1," in said("vpr-eval", "check", "first-floor.csv", *near)
    write("stairs.csv", "frame,x,y,floor\n" + "".join(f"{i},{10 * (i % 20)},0,{i // 20}\n" for i in range(40)))
    anchors = write("stairs.anchors.csv", "query,anchor\n0,0\n38,19\n")
    assert same_pairs(anchors, "--ground-truth-train", "stairs.csv", "--radius", 5) == 58
    write("lost.tum", "0 nan nan nan nan nan nan nan\n" + "".join(f"{i} {i} 0 0 0 0 0 1\n" for i in range(1, 6)))
    assert same_pairs("lost.tum", "--ground-truth-train", "lost.tum", "--radius", 0.5) == 5
    flat = ("--ground-truth-train", write("flat.csv", "frame,x,y\n0.0,0,0\n"), "--radius", 1)
    for name, why in (("first-floor.csv", "column floor, and the other side has one"), ("lost.tum", "Use one format for both")):
        refused(4, why, "vpr-eval", "check", name, *flat)
    write("rad.csv", "frame,x,y,heading\n0,0,0,0\n1,9,0,3.1\n")
    for name, cause in (("rad.csv", "radians"), ("lost.tum", "unknown")):
        assert f"Are they {cause}?" in said("vpr-eval", "check", name, "--ground-truth-train", name, "--radius", 1, "--angle", 9)
    refused(4, "two columns query", "vpr-eval", "check", write("two.csv", "query,query,reference\n0,0,0\n"))
    refused(4, "too large for 1 line", "vpr-eval", "check", write("far.csv", "frame,x,y\n4194302,1,2\n"), *near)
    write("gaps.csv", "frame,lat,lon\n0,0,0\n1,,\n2,nan,nan\n3,52.1,13.1\n")
    assert same_pairs("gaps.csv", "--ground-truth-train", "gaps.csv", "--radius", 5) == 1
    # Two radii, for poses and for loops, and headings of loops.
    write("line.csv", "frame,x,y,heading\n" + "".join(f"{i},{i},0,{180 * (i % 2)}\n" for i in range(6)))
    near = ("line.csv", "--ground-truth-train", "line.csv", "--radius", 1)
    assert same_pairs(*near, "--ignore-radius", 2) == 16
    write("loops.csv", "Match;Query\n0;2\n0;3\n0;1\n")
    loops = lambda *more: printed_json("vpr-eval", "loops", "loops.csv", "--poses", "line.csv", "--radius", 2.5, "--gap",
                                       1, *more)["loops"]
    assert (loops()["correct"], loops()["incorrect"]) == (2, 1)
    assert (loops("--angle", 45)["correct"], loops("--angle", 45)["incorrect"]) == (1, 2)
    assert loops("--ignore-radius", 4)["ignored"] == 1
    write("scored.csv", "query,match,score\n2,0,1\n3,1,2\n4,0,8\n5,0,9\n")
    scored = ("vpr-eval", "loops", "scored.csv", "--poses", "line.csv", "--radius", 2.5, "--gap", 1)
    assert "with --similarity and 0.4000 with --distance" in said(*scored, "--similarity")
    assert said(*scored, "--distance") == ""
    write("timed.csv", "frame,time,x,y\n0,0,0,0\n1,9,1,0\n2,30,0,0\n")
    run("vpr-eval", "loops", write("last.csv", "2,0\n"), "--poses", "timed.csv", "--radius", 1, "--gap", "20s")
    # Poses without times of their own, and frames of loops that are times.
    write("line.kitti", "".join(f"1 0 0 {i} 0 1 0 0 0 0 1 0\n" for i in range(6)))
    times = ("--pose-times", write("line.times", "0\n10\n20\n30\n40\n50\n"), "--frames-by", "time")
    timed = printed_json("vpr-eval", "loops", write("times.csv", "query,match\n50,10\n20,10\n"), "--poses", "line.kitti",
                         *times, "--radius", 2.5, "--gap", "5s")["loops"]
    assert (timed["correct"], timed["incorrect"]) == (1, 1)


def headers():
    for name, content in {"blank": "query, reference\n0, 0\n1, 1\n", "semicolon": "query;reference\n0;0\n1;1\n",
                          "tab": "query\treference\n0\t0\n1\t1\n", "upper": "Query,REFERENCE\n0,0\n1,1\n",
                          "quotes": '"query" , "reference"\n"0" , "0"\n1,\t1\n', "excel": "sep=;\nquery;reference\n0;0\n1;1\n",
                          "numpy": "sep=,\n# of numpy\n# query,reference\n0.0,0.0\n1,1\n"}.items():
        assert same_pairs(write(f"{name}.csv", content)) == 2, name
    refused(4, 'its header "frame x y"', "vpr-eval", "check", write("words.csv", "frame x y\n0 1 0\n"), "--radius", 1)
    assert same_pairs(write("my.anchors.csv", "query,reference\n0,0\n4,4\n")) == 2  # pairs, whatever the name
    run("vpr-eval", "check", write("long.csv", "query,reference\n0,0\n"))
    refused(4, "... (5000 bytes)", "vpr-eval", "check", write("long.csv", "query,reference\n" + "9" * 5000 + ",0\n"),
            "--query-frames", 5, "--train-frames", 5)
    (folder / "wide.csv").write_bytes("query,reference\n0,0\n".encode("utf-16"))
    refused(3, "wide.csv: is encoded in UTF-16", "vpr-eval", "check", "wide.csv")
    refused(4, 'query "\\x011"', "vpr-eval", "check", write("control.csv", "query,reference\n\x011,0\n"))
    refused(4, "line 2: it is not text", "vpr-eval", "check", write("nul.csv", "query,reference\n\x001,0\n"))


def images(name, seed, count=40, shift=0, size=(96, 72), start=0):
    """Views along one wide image."""
    (folder / name).mkdir()
    wide = np.random.default_rng(seed).integers(0, 255, (size[1] // 8, 400), dtype=np.uint8)
    wide = np.asarray(Image.fromarray(wide).resize((3200, size[1]), Image.BICUBIC))
    for i in range(count):
        at = 20 * i + shift
        Image.fromarray(wide[:, at:at + size[0]]).save(folder / name / f"{i + start:06d}.png")


def recordings():
    images("walk", 1, start=1)
    images("again", 1, shift=3, start=1)
    images("tall", 1, size=(72, 96))
    run("vpr-train", "fastable", "--train", "walk", "-o", "w.vprdb", "--quiet")
    query = ("vpr-query", "w.vprdb", "--query")
    assert "the same frames as the training sequence walk" in said(*query, "walk", "-o", "same.json")
    assert "the same frames" in said(*query, "walk@3::2")
    assert said(*query, "again", "-o", "again.json") == ""
    assert "images are 72 x 96, those of walk are 96 x 72" in said(*query, "tall")
    short = " ".join(run(*query, "tall@0:8").split())
    assert "The query has" in short and "needs a path of 16" in short, short
    run("vpr-train", "fastable", "--train", "walk@0:8", "-o", "eight.vprdb", "--quiet")
    assert "The training sequence has" in run("vpr-query", "eight.vprdb", "--query", "again")
    assert "Recognized none" not in run(*query, "again", "--margin", 0)
    images("long", 1, count=150, shift=3)
    run("vpr-train", "fastable", "--train", "long@::3", "-o", "third.vprdb", "--quiet")
    assert "every third query frame (--speed 3), " in run("vpr-query", "third.vprdb", "--query", "long")
    # Digits that are names: 000005.png is frame 4.
    truth = ("again.json", "--ground-truth")
    refused(2, "the filter has no matrix of its best matches", "vpr-eval", *truth, "aligned", "--matrix", "m.npy")
    rows = "query,reference\n" + "".join(f"{i:06d},{i:06d}\n" for i in range(1, 41))
    by_name = printed_json("vpr-eval", *truth, write("names.csv", rows))
    numbers = "query,reference\n" + "".join(f"{i},{i}\n" for i in range(40))
    by_number = printed_json("vpr-eval", *truth, write("numbers.csv", numbers))
    assert by_name["provenance"]["ground_truth"] == by_number["provenance"]["ground_truth"]
    (folder / "again").rename(folder / "moved")
    refused(4, "the names of its sequence are unknown: again: no such folder", "vpr-eval", *truth, "names.csv")
    assert printed_json("vpr-eval", *truth, "names.csv", "--query", "moved")["metrics"] == by_name["metrics"]
    assert "8 is read as the number of a frame" in said("vpr-eval", *truth, write("late.csv", "query,reference\n8,8\n"))
    assert said("vpr-eval", *truth, "numbers.csv") == ""
    (folder / "moved").rename(folder / "again")
    # Loops have the names of the query on both sides.
    run("vpr-query", "loops", "--query", "walk", "--c-l", 2, "--gap", 9, "-o", "own.json")
    by_both = [printed_json("vpr-eval", "own.json", "--ground-truth", name)["provenance"]["ground_truth"]
               for name in ("names.csv", "numbers.csv")]
    assert by_both[0] == by_both[1]
    # Only frames at least the gap earlier can be found.
    laps = np.arange(40)[:, None] % 20 == np.arange(40) % 20
    np.save(folder / "laps.npy", laps)
    np.save(folder / "past.npy", np.tril(laps, -9))
    both, past = (printed_json("vpr-eval", "own.json", "--ground-truth", name) for name in ("laps.npy", "past.npy"))
    assert both["metrics"] == past["metrics"] and both["counts"] == past["counts"]
    assert both["metrics"]["single_best"]["positives"] == 20
    # Lists with blanks at the ends of lines, and a frame that is listed twice.
    run(*query, write("blanks.txt", "".join(f"walk/{i:06d}.png \n" for i in range(1, 41))))
    write("twice.txt", "walk/000001.png\n" * 2)
    refused(4, "name of exactly one of 2 frames", "vpr-eval", "check", write("name.csv", "query,reference\nwalk/000001.png,0\n"),
            "--query", "twice.txt", "--train", "walk")
    # Fixes of images, pairs to ignore, and reports that do not belong into one table.
    write("fix.csv", "image,lat,lon\n000001.png,52,13\n000040.png,53,13\n")
    assert same_pairs("fix.csv", "--ground-truth-train", "fix.csv", "--radius", 2, "--query-images", "walk", "--train-images",
                      "walk") == 2
    np.save(folder / "same.npy", np.eye(40))
    np.save(folder / "soft.npy", np.eye(40) + np.eye(40, k=1))
    soft = printed_json("vpr-eval", *truth, "same.npy", "--soft", "soft.npy", "--stretch", 10)
    assert soft["metrics"]["recall_achievement"]["stretches"] == 4
    assert soft["provenance"]["ground_truth"] != printed_json("vpr-eval", *truth, "same.npy")["provenance"]["ground_truth"]
    shifted = write("shifted.csv", "query,reference\n" + "".join(f"{i},{39 - i}\n" for i in range(40)))
    for name in ("same.npy", "numbers.csv", shifted):
        run("vpr-eval", *truth, name, "-o", f"{name}.report.json")
    run("vpr-eval", "compare", "same.npy.report.json", "numbers.csv.report.json")
    refused(4, "the reports have different ground truths", "vpr-eval", "compare", "same.npy.report.json", f"{shifted}.report.json")
    # 16-bit gray in a narrow range, and frames that look alike.
    for name, low in (("thermal", 27000), ("dark", None)):
        (folder / name).mkdir()
        for path in sorted((folder / "walk").iterdir()):
            pixels = np.asarray(Image.open(path)).astype(np.uint16)
            Image.fromarray(pixels // 4 + low if low else np.full((72, 96), 7, np.uint8)).save(folder / name / path.name)
    warm = run(*query, "thermal")
    assert "Recognized" in warm and "none of" not in warm, warm
    assert "look like the one before" in said("vpr-train", "fastable", "--train", "dark", "-o", "d.vprdb")


def utm_names():
    """Zones that do not touch are other places; rows of arrays are in the order of bytes."""
    names = [f"@{100 * i + 0.5:.1f}@0@{zone}@.jpg" for zone in ("10.0", "32U") for i in range(12)]
    for side in ("uq", "ud"):
        for name in names:
            write(f"{side}/{name}", "")
    rows = np.eye(24)[np.argsort(np.argsort(names))].astype(np.float32)  # of each name, in order
    np.save(folder / "utm.npy", rows[np.argsort(names)])
    judge = ("vpr-eval", "matrix", "--query", "utm.npy", "--train", "utm.npy", "--ground-truth", "uq",
             "--ground-truth-train", "ud")
    report = printed_json(*judge)
    assert report["metrics"]["recall_at"]["1"] == 1 and report["metrics"]["all_pairs"]["positives"] == 24
    write("ud/@0@0@11@.jpg", "")
    np.save(folder / "more.npy", np.eye(25)[:, :24].astype(np.float32) + 0.01)
    refused(4, "which touches it", *judge[:5], "more.npy", *judge[6:])
    write("city/@0@0@Paris@.jpg", "")
    assert '"Paris" in' in said("vpr-eval", "check", "city", "--ground-truth-train", "city")
    for north, band in ((0, "N"), (10000000, "M")):
        write(f"equator/@500000@{north}@33@{band}@.jpg", "")
    assert same_pairs("equator", "--ground-truth-train", "equator") == 4


def lists():
    for name, count in (("q", 20), ("d", 30)):
        (folder / name).mkdir()
        for i in range(count):
            write(f"{name}/{name}{i:03d}.jpg", "")
    scores = np.random.default_rng(1).random((20, 30))
    scores[np.arange(20), np.arange(20) + 3] += 0.5
    best = np.argsort(-scores, axis=1)[:, :5]
    write("gt.csv", "query,reference\n" + "".join(f"{i},{i + 3}\n" for i in range(20)))
    pair = "".join(f"q/q{i:03d}.jpg%sd/d{k:03d}.jpg\n" for i in range(20) for k in best[i])
    write("blank.txt", pair.replace("%s", " "))
    write("kapture.txt", "# kapture format: 1.0\n# query_image, map_image\n" + pair.replace("%s", ", "))
    write("ranking.txt", "".join(" ".join([f"q{i:03d}"] + [f"d{k:03d}" for k in best[i]]) + "\n" for i in range(20)))
    write("numbers.txt", "".join(f"{i} {k}\n" for i in range(20) for k in best[i]))
    write("order.csv", "Rank,Reference,Query\n" + "".join(f"{n},{k},{i}\n" for i in range(20) for n, k in enumerate(best[i])))
    np.save(folder / "top5.npy", best)
    expected = (best[:, 0] == np.arange(20) + 3).mean(), (best == np.arange(20)[:, None] + 3).any(1).mean()
    for name in ("blank.txt", "kapture.txt", "ranking.txt", "numbers.txt", "order.csv", "top5.npy"):
        recall = printed_json("vpr-eval", "matrix", name, "--query", "q", "--train", "d", "--ground-truth", "gt.csv",
                              *(["--distance"] if name == "order.csv" else []))["metrics"]["recall_at"]
        assert np.allclose((recall["1"], recall["5"]), expected) and recall["10"] is None, (name, recall)
    stated = ("--query-frames", 20, "--train-frames", 30, "--ground-truth", "gt.csv")
    for name in ("numbers.txt", "top5.npy"):
        run("vpr-eval", "matrix", name, *stated)
    np.save(folder / "alike.npy", np.tile(np.arange(3), (20, 1)))  # all queries find the first three frames
    run("vpr-eval", "matrix", "alike.npy", *stated)
    np.savetxt(folder / "faiss.txt", best, "%d")  # without the queries
    refused(4, "has a line before" if len(set(best[:, 0])) < 20 else "cannot tell", "vpr-eval", "matrix", "faiss.txt", *stated)
    for flag in ("--distance", "--similarity"):
        np.save(folder / "full.npy", np.argsort(-scores, axis=1))
        refused(4, "every row has the integers 0 to 29 once", "vpr-eval", "matrix", "full.npy", flag, "--ground-truth", "gt.csv")
    refused(2, "as indices of references are", "vpr-eval", "matrix", "top5.npy", "--distance", *stated)
    np.savez(folder / "scores.npz", scores)
    np.savetxt(folder / "grid.csv", 9 * scores, "%d", ",")
    for part, name in {"it is not text": "scores.npz", "a reference is listed twice": "grid.csv",
                       "query,reference, however": write("last.csv", "reference,query\n3,0,1\n"),
                       "the columns are": write("rank.csv", "query,place,reference\n0,1,3\n")}.items():
        refused(4, part, "vpr-eval", "matrix", name, *stated)
    np.save(folder / "short.npy", best.astype(np.uint16))
    refused(2, "as indices of references are", "vpr-eval", "matrix", "short.npy", "--distance", *stated)
    np.save(folder / "near.npy", scores[:, :5])
    refused(4, "the training frames need 30", "vpr-eval", "matrix", "near.npy", "--similarity", *stated)
    assert "different integers" in said("vpr-eval", "matrix", "top5.npy", "--similarity", "--ground-truth", "aligned")
    for name in (9, 10, 11):
        write(f"n/{name}.jpg", "")
    assert "add --order name" in said("vpr-eval", "matrix", write("n.txt", "0 0\n1 1\n2 2\n"), "--query", "n", "--train", "n",
                                      "--ground-truth", "aligned")
    # Names with blanks and #, written and read.
    (folder / "#spaces").mkdir()
    for i, path in enumerate(sorted((folder / "walk").iterdir())):
        shutil.copy(path, folder / f"#spaces/my frame ({i}).png")
    names = ("--query", "#spaces", "--train", "#spaces")
    run("vpr-eval", "again.json", *names, "--pairs", "named.txt", "--quiet")
    assert " of 40 frames" in run("vpr-eval", "matrix", "named.txt", *names, "--ground-truth", "numbers.csv")


def selected_frames():
    """Files of pairs count the frames of recordings, whatever a query selects of them."""
    run("vpr-query", "w.vprdb", "--query", "again", "--c-l", 1, "--t-r", 0.5, "--recorded-fps", 10, "--fps", 5, "-o", "half.json")
    names = ("--query", "again", "--train", "walk")
    truth = ("--ground-truth", "aligned", "--tolerance", 1)

    def correct(*words):
        metrics = printed_json("vpr-eval", *words, *truth)["metrics"]
        return round(metrics["recall_at"]["1"] * metrics["single_best"]["positives"])
    assert correct("half.json") > 10
    for name, more in (("half.txt", names), ("half-numbers.txt", ())):
        run("vpr-eval", "half.json", *more, "--pairs", name, "--quiet")
        assert correct("matrix", name, *names) == correct("half.json"), name
    assert (folder / "half.txt").read_text().splitlines()[-1].startswith("again/000039.png ")
    refused(2, "there are names of 10 frames, but the query has 40", "vpr-eval", "half.json", "--query", "again@0:10", "--pairs",
            "short.txt")
    direct = printed_json("vpr-eval", "half.json", *truth)
    for name, form in (("half.csv", "pairs"), ("half.npy", "matrix")):
        run("vpr-eval", "convert", "aligned", "--tolerance", 1, "--result", "half.json", "--to", form, "-o", name)
        converted = printed_json("vpr-eval", "half.json", "--ground-truth", name)
        assert converted["metrics"] == direct["metrics"] and converted["counts"] == direct["counts"], name


def times_of_frames():
    """Rates count recorded frames, and names are times only if nothing states a rate."""
    gap = ("vpr-query", "loops", "--gap", "3s", "--c-l", 1, "--t-r", 1000, "--descriptor", "ldb", "--force", "-o", "loops.json")
    assert "are interpreted as seconds" in said(*gap, "--query", "walk@::2")
    poses = write("even.csv", "frame,x,y\n" + "".join(f"{i},{i},0\n" for i in range(40)))
    pairs = write("halves.csv", "query,reference\n" + "".join(f"{i},{2 * i}\n" for i in range(20)))
    halves = write("halves.json", json.dumps({
        "schema": "vpr.dataset/3", "name": "halves", "fps": 10, "train": [{"name": "walk", "sequence": "walk", "poses": poses}],
        "queries": [{"name": "half", "sequence": "again@::2", "ground_truth": {"format": "pairs", "path": pairs, "tolerance": 1}}]}))
    assert "seconds" not in said(*gap, "--dataset", halves, "--save-loops", "far.csv")
    gaps = [int(row.split(",")[0]) - int(row.split(",")[1]) for row in (folder / "far.csv").read_text().splitlines()[1:]]
    assert min(gaps) == 15, min(gaps)
    for more in ((), ("--fps", 2.5)):
        run("vpr-query", "w.vprdb", "--dataset", halves, "--c-l", 1, "--t-r", 0.5, *more, "-o", "halves.r.json", "--force")
        run("vpr-eval", "halves.r.json", "--dataset", halves, "--save-trajectory", "halves.tum", "--force")
        rows = [row.split() for row in (folder / "halves.tum").read_text().splitlines()[1:]]
        # Frame 10 t of the recording is at frame 10 t of the training sequence.
        assert len(rows) > 8 and all(abs(10 * float(t) - float(x)) <= 1 for t, x, *_ in rows), rows[:9]


def names_of_datasets():
    """Places and sequences of a data set are found by their names, whatever the order in the database."""
    pairs = write("aligned.csv", "query,reference,sequence\n" + "".join(f"{i},{i},walk\n" for i in range(40)))
    write("counts.csv", "query,reference,label\n" + "".join(f"{i},{i // 20},same\n" for i in range(40)))
    sets = write("sets.json", json.dumps({
        "schema": "vpr.dataset/3", "name": "sets", "pretrain": ["tall"],
        "train": [{"name": "tall", "sequence": "tall"}, {"name": "walk", "sequence": "walk"}],
        "places": [{"name": "near", "sequences": ["walk@0:20"]}, {"name": "far", "sequences": ["walk@20:40"]}],
        "queries": [{"name": name, "sequence": "again", "ground_truth": {"format": "pairs", "path": pairs},
                     "place_ground_truth": {"format": "pairs", "path": "counts.csv"}} for name in ("other", "again")]}))
    run("vpr-train", "fastable", "--train", "walk", "--train", "tall", "-o", "turned.vprdb")
    judge = ("vpr-eval", "turned.json", "--dataset", sets)
    run("vpr-query", "turned.vprdb", "--dataset", sets, "--query", "again", "--c-l", 1, "--t-r", 0.5, "-o", "turned.json")
    run(*judge, "--pairs", "turned.txt")
    sides = [line.split()[1].split("/")[0] for line in (folder / "turned.txt").read_text().splitlines()]
    assert len(sides) > 20 and sides.count("walk") > 0.9 * len(sides), sides
    near, far = (("--place", f"{name}=walk@{part}") for name, part in (("near", "0:20"), ("far", "20:40")))
    for order, (first, second) in {"right": (near, far), "wrong": (far, near)}.items():
        run("vpr-train", "fabmap", "--features", "orb", "--words", 20, "--pretrain", "tall", *first, *second, "-o", f"{order}.vprdb")
        run("vpr-query", f"{order}.vprdb", "--dataset", sets, "--query", "again", "--t-p", 0.3, "-o", f"{order}.json")
    assert printed_json("vpr-eval", "right.json", "--dataset", sets)["protocol"]["ground_truth"].startswith("pairs")
    refused(4, "counts the places near, far of the data set, but the database has far, near", "vpr-eval", "wrong.json",
            "--dataset", sets)
    # A number of an earlier report that this one lacks is a difference.
    run(*judge, "-o", "before.json")
    run("vpr-query", "turned.vprdb", "--dataset", sets, "--query", "again", "--only-sequence", "tall", "--c-l", 1, "--t-r", 0.5,
        "-o", "turned.json", "--force")
    unmet = call(*judge, "--expect", "before.json")
    assert unmet.returncode == 5 and "thresholds.recall_at_100_precision: expected" in unmet.stderr, unmet


def columns_of_scores():
    """The columns of scores are one sequence, however many sequences have their frames."""
    np.save(folder / "scores.npy", np.eye(40) + 0.1)
    parts = ("--query", "walk", "--train", "walk@0:10", "--train", "walk@10:40", "--ground-truth")
    judge = ("vpr-eval", "matrix", "scores.npy", "--similarity", *parts)
    assert printed_json(*judge, "names.csv", "--pairs", "columns.txt")["metrics"]["recall_at"]["1"] == 1
    assert (folder / "columns.txt").read_text().splitlines()[390].split()[1].endswith("000040.png")
    refused(2, "windows of one sequence, but there are 2", *judge, "aligned", "--rows-are-windows-of", 3)
    refused(4, "the columns of the scores are one sequence", *judge, write("sides.csv", "query,sequence,reference\n0,walk@0:10,0\n"))
    lost = np.eye(40) + 0.1
    lost[[3, 9]] = np.nan
    np.save(folder / "lost.npy", lost)
    assert "2 of 40 queries have no score" in said("vpr-eval", "matrix", "lost.npy", "--similarity", "--ground-truth", "aligned")
    # Frames without a pose have scores.
    poses = write("three.csv", "frame,x,y\n" + "".join(f"{i},{i},0\n" for i in range(40) if i != 7))
    warned = said("vpr-eval", "matrix", "scores.npy", "--similarity", "--ground-truth", poses, "--ground-truth-train", poses,
                  "--radius", 1)
    assert "no score" not in warned, warned


def arrays():
    numbers = np.random.default_rng(1).random((40, 16))
    for name, array in {"big": numbers.astype(">f4"), "bytes": (255 * numbers).astype(np.uint8), "one": np.zeros(5),
                        "dict": {"a": 1}, "minus": np.where(np.arange(16) == 7, -1, numbers)}.items():
        np.save(folder / f"{name}.npy", array)
    refused(4, 'array.astype("<f4")', "vpr-train", "descriptors", "--train", "big.npy", "-o", "big.vprdb")
    refused(4, "query x training frames; found the shape (5)", "vpr-eval", "check", "one.npy")
    refused(4, "Save an array of numbers", "vpr-eval", "check", "dict.npy")
    same = ("--query", "bytes.npy", "--train", "bytes.npy", "--ground-truth", "aligned")
    assert "If they are numbers, save them as float32" in said("vpr-eval", "matrix", *same)
    np.save(folder / "bool.npy", numbers > 0.5)
    refused(4, "the values have type |b1", "vpr-eval", "matrix", "--query", "bool.npy", *same[2:])
    matrix = ("vpr-eval", "matrix", "minus.npy", "--distance", "--ground-truth", "aligned")
    assert "add --missing -1" in said(*matrix) and "--missing" not in said(*matrix, "--missing", -1)
    (folder / "unclear").mkdir()
    for i, path in zip((5, 9, 10, 125), sorted((folder / "walk").iterdir())):
        shutil.copy(path, folder / "unclear" / f"1.{i}.png")
    for side in ("--query", "--train"):
        refused(2, "order of frames is unclear", "vpr-eval", "matrix", "minus.npy", "--distance", side, "unclear",
                "--ground-truth", "aligned")


def flags_without_effect():
    assert said("vpr-train", "fastable", "--train", "walk@0:20", "-o", "short.vprdb") == ""
    for flag, value in (("--c-l", 5), ("--safety-factor", 0.9)):
        train = ("vpr-train", "fastable", "--train", "walk", flag, value, "-o", "one.vprdb", "--force")
        assert f"{flag} has no effect yet" in said(*train)
    # A result is a configuration: what it turned off stays off.
    run("vpr-train", "images", "--train", "walk", "-o", "features.vprdb", "--quiet")
    query = ("vpr-query", "features.vprdb", "--query", "again", "--force", "-o", "off.json")
    assert printed_json(*query)["settings"]["witness"] == "orb"
    run(*query, "--witness", "none")
    assert printed_json(*query[:4], "--config", "off.json")["settings"]["witness"] == "none"
    assert "--order has no effect" in said("vpr-eval", "check", "numbers.csv", "--order", "name")


def loops_of_arrays():
    np.save(folder / "bits.npy", np.random.default_rng(1).random((40, 64)) > 0.5)
    loops = ("vpr-query", "loops", "--query", "bits.npy", "--c-l", 2, "--gap")
    assert "40 frames of bits" in run(*loops, 9)
    refused(2, "bits.npy: the rows have no times", *loops, "9s")


def columns_of_names():
    """Positions whose lines name the frames of a folder in any column, and not in the order of the folder."""
    (folder / "ids").mkdir()
    ids = [str(497 * i * i % 10007 + 10 ** 14) for i in range(1, 41)]
    for name in ids:
        write(f"ids/{name}.jpg", "")
    assert ids != sorted(ids) and len(set(ids)) == 40
    texts = [f"{7919 * i % 10007:x}x" for i in range(40)]
    columns = {"id": ids, "image_id": ids, "timestamp": ids, "uuid,photo_file": [f"{a},{b}.jpg" for a, b in zip(texts, ids)],
               "date,picture": [f"{1 + i % 28:02}.03.2020 12:{i:02}:00,{name}.jpg" for i, name in enumerate(ids)],
               "picture": ["", *(f"{name}.jpg" for name in ids[1:])], "photo": ["NA", "NA", *(f"{name}.jpg" for name in ids[2:])]}
    for position in ("lat,lon", "x,y,z"):
        at = (lambda i: f"{55 + i * 1e-4:.7f},12.5") if position == "lat,lon" else (lambda i: f"{10 * i},0,0")
        for column, cells in columns.items():
            lines = [f"{cell},{at(i)}\n" for i, cell in enumerate(cells)]
            write("named.csv", f"{column},{position}\n" + "".join(lines))
            write("ordered.csv", f"{position}\n" + "".join(f"{at(i)}\n" for i in sorted(range(40), key=lambda i: ids[i])))
            run("vpr-eval", "convert", "named.csv", "--ground-truth-train", "ordered.csv", "--query", "ids", "--train", "ids",
                "--radius", 2, "--to", "pairs", "-o", "named.pairs.csv", "--force")
            pairs = [line.split(",") for line in (folder / "named.pairs.csv").read_text().splitlines()[1:]]
            known = [pair for pair in pairs if pair[2] == "same"] if len(pairs[0]) > 2 else pairs
            missing = sum(not cell or cell == "NA" for cell in cells)
            assert len(known) == 40 - missing and all(query == train for query, train, *_ in known), (column, position, known[:3])
    # A folder that is gone, texts that repeat, and two columns of names.
    moved = ("--ground-truth-train", "ordered.csv", "--query", "gone", "--train", "gone", "--radius", 2)
    refused(3, "gone: no such folder", "vpr-eval", "check", "named.csv", *moved)
    same = sorted(ids)
    shots = [f"{name}.jpg" for name in (same[:1] + same)[:40]]
    write("shots.csv", "previous,current,x,y,z\n" + "".join(f"{a},{b}.jpg,{10 * i},0,0\n" for i, (a, b) in enumerate(zip(shots, same))))
    write("takes.csv", "take,x,y,z\n" + "".join(f"{i % 3}.jpg,{10 * i},0,0\n" for i in range(40)))
    for name in ("shots", "takes"):
        assert same_pairs(f"{name}.csv", "--ground-truth-train", f"{name}.csv", "--query", "ids", "--train", "ids", "--radius", 2) == 40
    # Counters of lines and other numbers do not name frames.
    (folder / "numbers").mkdir()
    for i in range(40):
        write(f"numbers/{i}.jpg", "")
    write("seconds.csv", "time,x,y,z\n" + "".join(f"{i},{10 * i},0,0\n" for i in range(0, 40, 4)))
    refused(4, "has 10 poses, but there are 40", "vpr-eval", "check", "seconds.csv", "--ground-truth-train", "seconds.csv", "--query", "numbers",
            "--train", "numbers", "--radius", 2)
    write("idx.csv", "idx,speed,x,y,z\n" + "".join(f"{i},{i % 7},{10 * i},0,0\n" for i in range(40)))
    assert same_pairs("idx.csv", "--ground-truth-train", "idx.csv", "--radius", 2, "--query", "ids", "--train", "ids") == 40
    write("times.csv", "time,image\n" + "".join(f"{1588149425 + i},{name}\n" for i, name in enumerate(ids)))
    tum = write("walk.tum", "".join(f"{1588149425 + i} {i} 0 0 0 0 0 1\n" for i in range(40)))
    refused(4, "is not later than", "vpr-eval", "check", tum, "--ground-truth-train", tum, "--query-times", "times.csv", "--train-times",
            "times.csv", "--query", "ids", "--train", "ids", "--radius", 0.1)


def units_of_positions():
    circle = [(500 * np.cos(a), 500 * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 60)]
    degrees = [(42.293 + y / 111080, -83.7096 + x / 82340) for x, y in circle]
    for name, more in (("leica", ",270"), ("nclt", ",270,0,0,0"), ("euroc", ",270,1,0,0,0")):
        write(f"{name}.degrees.csv", "".join(f"{1588149425000000000 + i * 10 ** 8},{a:.9f},{b:.9f}{more}\n"
                                             for i, (a, b) in enumerate(degrees)))
        refused(4, "latitudes and longitudes", "vpr-eval", "check", f"{name}.degrees.csv", "--ground-truth-train",
                f"{name}.degrees.csv", "--radius", 60)
    greenwich = [(51.478 + y / 111252, x / 69300) for x, y in circle]
    write("signed.csv", "lat,lon\n" + "".join(f"{a:.7f},{b:.7f}\n" for a, b in greenwich))
    write("letters.csv", "LATITUDE,N/S,LONGITUDE,E/W\n" + "".join(f"{a:.7f},N,{abs(b):.7f},{'W' if b < 0 else 'E'}\n"
                                                                   for a, b in greenwich))
    near = ("--ground-truth-train", "signed.csv", "--radius", 60)
    assert same_pairs("letters.csv", *near) == same_pairs("signed.csv", *near) == 184
    # A time that is not needed.
    write("clock.csv", "time,lat,lon\n" + "".join(f"08:37:{i:02},{a:.7f},{b:.7f}\n" for i, (a, b) in enumerate(greenwich)))
    assert same_pairs("clock.csv", *near) == 184
    # Units in words, and numbers of frames before times.
    for head in ("Timestamp[nanosec]", "timestamp_nanoseconds", "time (nsec)"):
        write("named.times", f"{head}\n" + "".join(f"{10 ** 12 + i * 5 * 10 ** 7}\n" for i in range(40)))
        run("vpr-train", "images", "--train", "walk", "-o", "timed.vprdb", "--force", "--quiet")
        query = ("vpr-query", "timed.vprdb", "--query", "again", "--query-times", "named.times", "--fps", 5, "--c-l", 1, "--t-r", 0.3)
        assert json.loads(run(*query, "--json"))["query"]["frames"] == 10, head
    write("mono.times", "".join(f"{i:05} {1439226105 + i * 0.05:.6f} 0.5\n" for i in range(1, 41)))
    refused(4, "its first column counts 1, 2, 3", *query[:5], "mono.times", *query[6:])
    write("second.tum", "".join(f"{i} {i} 0 0 0 0 0 1\n" for i in range(40)))
    assert json.loads(run(*query[:5], "second.tum", "--fps", 0.5, *query[8:], "--json"))["query"]["frames"] == 20
    write("letters.csv", "lat,n/s,lon,e/w\n1,X,2,E\n")
    refused(4, 'the letter "X"', "vpr-eval", "check", "letters.csv", *near)


def gaps_of_loops():
    """Frames that a loop query did not compare are ignored, whatever states the gap, and also after the places of a database."""
    laps = sorted((folder / "walk").iterdir()) + sorted((folder / "again").iterdir())
    write("laps.csv", "".join(f"{path}\n" for path in laps))
    write("laps.times", "".join(f"{i}\n" for i in range(80)))
    revisits = write("revisits.csv", "query,reference\n" + "".join(f"{i + 40},{i}\n" for i in range(40)))
    loops = ("vpr-query", "loops", "--query", "laps.csv", "--c-l", 1, "--score", "zscore", "--t-r", -2, "--force", "--gap")
    found = []
    for gap in ((30,), ("30s", "--frame-times", "laps.times")):
        run(*loops, *gap, "-o", "laps.json")
        report = printed_json("vpr-eval", "laps.json", "--ground-truth", revisits, "--tolerance", 2)
        found.append((report["metrics"]["single_best"], report["localization"]))
    assert found[0] == found[1] and found[0][1]["frames_with_match"] == 40, found
    ok(call("vpr-eval", "laps.json", "--ask-places", "laps.html"))
    run("vpr-train", "fabmap", "--pretrain", "walk@1::2", "--train", "walk@0:20", "--features", "orb", "--words", 50, "-o",
        "bags.vprdb", "--quiet")
    run("vpr-query", "loops", "bags.vprdb", "--query", "again", "--gap", 10, "--t-p", 0.5, "-o", "bags.json")
    report = printed_json("vpr-eval", "bags.json", "--ground-truth",
                          write("places.csv", "query,reference\n" + "".join(f"{i},{i}\n" for i in range(20))))
    assert report["localization"]["frames_with_match"] == 20 and report["metrics"]["recall_at"]["1"] > 0.7, report["metrics"]


def frames_of_lists():
    write("walk.csv", "".join(f"{path}\n" for path in sorted((folder / "walk").iterdir())))
    before = (folder / "walk/000005.png").read_bytes()
    refused(2, "walk/000005.png", "vpr-query", "w.vprdb", "--query", "walk.csv", "--c-l", 5, "--t-r", 0.4, "--save-matrix",
            "walk/000005.png", "--force")
    assert (folder / "walk/000005.png").read_bytes() == before
    write("gone.txt", "".join(f"gone/{i}.png\n" for i in range(9)))
    sides = ("--query", "gone.txt", "--train", "gone.txt")
    assert same_pairs(write("gone.csv", "query,reference\n" + "".join(f"gone/{i}.png,gone/{i}.png\n" for i in range(9))), *sides) == 9


def logs_of_robots():
    """Columns of logs, each with the right answer in a plain file."""
    count = 40
    plain = write("plain.csv", "time,x,y,z\n" + "".join(f"{i / 10},{10 * i},0,0\n" for i in range(count)))
    write("frames.times", "".join(f"{i / 10}\n" for i in range(count)))
    times = ("--query-times", "frames.times", "--train-times", "frames.times", "--max-difference", 0.01, "--radius", 1)
    # A record has a time of its own, half a second after the message's.
    write("echo.csv", "%time,field.header.stamp,field.pose.position.x,field.pose.position.y,field.pose.position.z\n"
          + "".join(f"{10**8 * (i + 5)},{10**8 * i},{10 * i},0,0\n" for i in range(count)))
    write("bag.csv", "Time,header.stamp.secs,header.stamp.nsecs,pose.position.x,pose.position.y,pose.position.z\n"
          + "".join(f"{i / 10 + 0.5},{i // 10},{10**8 * (i % 10)},{10 * i},0,0\n" for i in range(count)))
    for name in ("echo.csv", "bag.csv"):
        assert same_pairs(name, "--ground-truth-train", plain, *times) == count, name
    write("two.csv", "%time,field.pose0.position.x,field.pose0.position.y,field.pose1.position.x,field.pose1.position.y\n0,1,2,3,4\n")
    refused(4, "two columns x", "vpr-eval", "check", "two.csv", "--ground-truth-train", "two.csv", "--radius", 1)
    # Comments after the one that names the columns.
    turned = "".join(f"{i} {10 * i} 0 0 0.8 0.6 0 0\n" for i in range(count))
    write("turned.tum", "# x is east, y is north, z is up and all are meters\n" + turned)
    assert same_pairs("turned.tum", "--ground-truth-train", "turned.tum", "--radius", 1) == count
    write("turned.tum", "# time x y z q_w q_x q_y q_z\n# from a logger\n" + turned)
    refused(2, "fit no layout", "vpr-eval", "check", "turned.tum", "--ground-truth-train", "turned.tum", "--radius", 1)
    write("keys.tum", "".join(f"{i} {10 * i} 0 0 0 0 0 1\n" for i in range(0, count, 2)))
    refused(4, "pass those of the frames with --query-times", "vpr-eval", "check", "keys.tum", "--ground-truth-train", "keys.tum",
            "--radius", 1, "--query", "walk", "--train", "walk")
    # Degrees: of a GIS, and with letters.
    write("gis.csv", "frame,x,y\n" + "".join(f"{i},{-1.26 + i / 1e5},{51.75 + i / 1e5}\n" for i in range(count)))
    refused(4, "name them lat and lon", "vpr-eval", "check", "gis.csv", "--ground-truth-train", "gis.csv", "--radius", 1)
    write("still.csv", "frame,x_m,y_m\n" + "".join(f"{i},{12.3 + i / 1e4},4.5\n" for i in range(count)))
    assert same_pairs("still.csv", "--ground-truth-train", "still.csv", "--radius", 1) == count**2
    for west in ("W", "West"):
        write("exif.csv", "SourceFile,GPSLatitude,GPSLatitudeRef,GPSLongitude,GPSLongitudeRef\n"
              + "".join(f"{i}.jpg,{51.75 + i / 1e4},N,{1.26},{west}\n" for i in range(count)))
        write("signed.csv", "frame,lat,lon\n" + "".join(f"{i},{51.75 + i / 1e4},-1.26\n" for i in range(count)))
        sides = ("--query", "numbers", "--train", "numbers", "--radius", 1)
        assert same_pairs("exif.csv", "--ground-truth-train", "signed.csv", *sides) == count
        write("exif.csv", (folder / "exif.csv").read_text().replace("SourceFile", "frame").replace(".jpg", ""))
        assert same_pairs("exif.csv", "--ground-truth-train", "signed.csv", *sides) == count
    (folder / "from1").mkdir()
    for i in range(count):
        write(f"from1/{i + 1}.jpg", "")
    part = "".join(f"{i},{51.75 + i / 1e4},-1.26\n" for i in range(80))
    (folder / "later").mkdir()
    for i in range(40, 80):
        write(f"later/{i}.jpg", "")
    write("all.csv", "image,lat,lon\n" + part)
    assert same_pairs("all.csv", "--ground-truth-train", "all.csv", "--radius", 1, "--query", "later", "--train", "later") == count
    write("counted.csv", "image,lat,lon\n" + "".join(f"{i},{51.75 + i / 1e4},-1.26\n" for i in range(count)))
    refused(4, "count from 0", "vpr-eval", "check", "counted.csv", "--ground-truth-train", "counted.csv", "--radius", 1, "--query",
            "from1", "--train", "from1")


def written_times():
    """Times in words and of unclear units."""
    check = lambda *lines: ("vpr-query", "loops", "--query", "walk", "--gap", "3s", "--c-l", 1, "--t-r", 0.5, "-o", "loops.json",
                            "--force", "--frame-times", write("said.txt", "".join(f"{line}\n" for line in lines)))
    frames = range(40)
    clock = lambda text: [f"2024-05-01 10:00:{i:02}{text}" for i in frames]
    ok(call(*check(*clock(" UTC"))))
    for word in ("PM", "BST"):
        refused(4, f'"{word}" after the date', *check(*clock(f" {word}")))
        refused(4, f'"{word}" after the date', *check(*(line.replace(" ", "T") + f" {word}" for line in clock(""))))
    ok(call(*check("time,camera", *clock(",EST"))))
    refused(4, "unit of its times is unclear", *check(*(f"{30 * i}.0" for i in frames)))
    ok(call(*check("time_s", *(f"{30 * i}.0" for i in frames))))


def images_of_cameras():
    """Images as cameras and programs write them have the pixels of plain ones, or are refused."""
    rng = np.random.default_rng(1)
    views = [np.kron(rng.integers(0, 16, (12, 16)), np.ones((8, 8), int)).astype(np.uint8) * 17 for _ in range(12)]
    for name in ("stored", "fifteen", "xmp", "upright", "kinds/a", "kinds/__MACOSX"):
        (folder / name).mkdir(parents=True)
    exif = Image.Exif()
    exif[274] = 3
    xmp = b"http://ns.adobe.com/xap/1.0/\0<x/>"
    for i, view in enumerate(views):
        Image.fromarray(view).save(folder / f"stored/{i}.png")
        (folder / f"fifteen/{i}.pgm").write_bytes(b"P5 128 96 15\n" + (view // 17).tobytes())
        Image.fromarray(view).save(folder / f"upright/{i}.jpg", quality=95)
        Image.fromarray(view[::-1, ::-1]).save(folder / "turned.jpg", quality=95, exif=exif)
        text = (folder / "turned.jpg").read_bytes()
        at = text.index(b"\xff\xe1")
        (folder / f"xmp/{i}.jpg").write_bytes(text[:at] + b"\xff\xe1" + (len(xmp) + 2).to_bytes(2, "big") + xmp + text[at:])
        for kind in ("color", "depth"):
            Image.fromarray(view).save(folder / f"kinds/a/{i}.{kind}.png")
    for plain, other, most in (("stored", "fifteen", 0), ("upright", "xmp", 100)):
        run("vpr-train", "images", "--train", plain, "-o", "views.vprdb", "--force", "--c-l", 1, "--quiet")
        run("vpr-query", "views.vprdb", "--query", other, "--method", "fastable", "--c-l", 1, "--t-r", 0.4, "--score", "raw",
            "--save-matrix", "views.npy", "-o", "views.json", "--force", "--quiet")
        assert np.load(folder / "views.npy").diagonal().max() <= most, (other, np.load(folder / "views.npy").diagonal())
    train = ("vpr-train", "images", "--train", "stored", "-o", "stored.vprdb")
    assert "2 images of each frame: .color.png, .depth.png" in said(*train[:2], "--train-folders", "kinds", "-o", "kinds.vprdb")
    (folder / "decimal").mkdir()
    for i, view in enumerate(views):
        Image.fromarray(view).save(folder / f"decimal/{i // 4}.{i % 4}.png")
    assert said(*train[:3], "decimal", "-o", "decimal.vprdb") == ""
    Image.fromarray(views[0]).save(folder / "stored/12.png", save_all=True, append_images=[Image.fromarray(v) for v in views[1:]])
    refused(3, "has several pages", *train)
    (folder / "stored/12.png").unlink()
    Image.fromarray(np.dstack([views[0]] * 3 + [views[1]]), "RGBA").save(folder / "stored/12.tif")
    refused(3, "has transparent pixels", *train)
    Image.fromarray(np.dstack([views[0]] * 3 + [np.full_like(views[0], 255)]), "RGBA").save(folder / "stored/12.tif")
    ok(call(*train))


def common_frames():
    """Gaps between frames that all methods judge say nothing about the path."""
    scores = np.eye(40) + 0.1
    np.save(folder / "all.npy", scores)
    scores[10:30] = np.nan
    np.save(folder / "some.npy", scores)
    for name in ("all", "some"):
        run("vpr-eval", "matrix", f"{name}.npy", "--similarity", "--threshold", 0.5, "--ground-truth", "aligned", "-o",
            f"{name}.json", "--quiet")
    compared = lambda *more: [one["localization"].get("longest_gap_frames")
                              for one in printed_json("vpr-eval", "compare", "all.json", "some.json", *more)["reports"]]
    assert compared() == [0, 20] and compared("--common") == [None, None], (compared(), compared("--common"))


def full_output():
    with open("/dev/full", "w") as full:
        assert subprocess.run([programs / "vpr-eval", "--help"], stdout=full, stderr=subprocess.DEVNULL).returncode == 3


def shrinking_array():
    """An array that another program rewrites while it is read."""
    rows = np.random.default_rng(1).standard_normal((200000, 128)).astype(np.float32)
    for delay in (0.05, 0.1, 0.2, 0.4):
        np.save(folder / "big.npy", rows)
        run = subprocess.Popen([programs / "vpr-train", "descriptors", "--train", "big.npy", "-o", "big.vprdb", "--threads", "1",
                                "--force", "--quiet"], cwd=folder, stderr=subprocess.PIPE, text=True)
        time.sleep(delay)
        with open(folder / "big.npy", "r+b") as file:
            file.truncate(4096)
        error = run.communicate()[1]
        assert run.returncode in (0, 3, 4), (delay, run.returncode, error)
        assert run.returncode == 0 or "big.npy" in error, error
        assert not list(folder.glob(".vpr-partial*")), list(folder.iterdir())


columns_of_poses()
headers()
recordings()
utm_names()
lists()
selected_frames()
times_of_frames()
names_of_datasets()
columns_of_scores()
arrays()
flags_without_effect()
loops_of_arrays()
columns_of_names()
units_of_positions()
gaps_of_loops()
frames_of_lists()
logs_of_robots()
written_times()
images_of_cameras()
common_frames()
full_output()
shrinking_array()
