#!/usr/bin/env python3
"""The public recording of the paper, from the layout of its archive to counts by labeled places.

    first_floor.py SOURCE BIN"""
import csv
import math
import os
import shutil
import tarfile

from support import call, folder, ok, programs, read_json, run, source, stub, with_path, write

stubs, downloads = folder / "stubs", folder / "downloads"


def render():
    """The stand-in of the first floor with small images."""
    world = read_json(source / "configs/worlds/put-mc-floor1.json")
    run("vpr-synth", write("world.json", {**world, "image_width": 200, "image_height": 150}), "-o", "world", "--quiet")
    return folder / "world"


def pack(world, has_subfolders):
    """An archive of images only, as published."""
    archive = folder / "SP_PUT_CM_1.tar.gz"
    train = [path for path in sorted(world.iterdir()) if path.is_dir() and path.name[0] in "abcde"
             and path.name[1] == "-"]
    assert len(train) == 14, train
    with tarfile.open(archive, "w:gz", compresslevel=1) as tar:
        for path in train:
            add_images(tar, path, f"SP_PUT_CM_1_train/{path.name}")
        test = "SP_PUT_CM_1_test"
        add_images(tar, world / "query", f"{test}/Test3" if has_subfolders else test)
        if has_subfolders:
            for name, path in (("Test1", train[0]), ("Test2", train[1])):
                add_images(tar, path, f"{test}/{name}")
    return archive


def add_images(tar, walk, name):
    for path in sorted(walk.glob("*.jpg")) + sorted(walk.glob("*.png")):
        tar.add(path, f"{name}/{path.name}")


def fetch(archive):
    """The description that fetch-data.sh writes, with a curl that copies the archive."""
    stubs.mkdir(exist_ok=True)
    stub(stubs / "curl", f"""case "$*" in *--head*) echo "Content-Length: {archive.stat().st_size}"; exit;; esac
while [[ $1 != --output ]]; do shift; done
cp {archive} "$2\"""")
    shutil.rmtree(downloads, ignore_errors=True)
    run(source / "scripts/fetch-data.sh", "put-mc-floor1", "--to", downloads, env=with_path(stubs))
    return read_json("downloads/put-mc-floor1/dataset.json")


def run_floor():
    """The experiment's output, and its messages."""
    done = ok(call(source / "scripts/reproduce/run.sh", "floor1", "--data", downloads, "--out", "out",
                   env={**os.environ, "VPR_BIN": str(programs)}))
    return read_json("out/floor1.json"), done.stderr


def numbers(written, c_l):
    return {cell["measure"]: cell["ours"] for cell in written["cells"] if cell.get("c_l") == c_l}


def answer_all(c_l):
    """Answers yes to every place of the last report, but no to the first."""
    report = read_json("out/reproduce/report.json")
    assert report["settings"]["c_l"] == c_l, report["settings"]
    places = report["clusters"]
    with (downloads / f"put-mc-floor1/places-c_l-{c_l}.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["place", "query", "sequence", "train", "same"])
        for number, place in enumerate(places, 1):
            writer.writerow([number, place["query"], place["sequence"], place["train"],
                             "no" if number == 1 else "yes"])
    return places


def check_unlabeled():
    """Totals, a page of places and figures for each window length; findings are not measured."""
    written, messages = run_floor()
    for c_l in (20, 40, 60, 80):
        found = numbers(written, c_l)
        assert found["correct recognitions"] is None and found["localized percent"] is None, found
        assert found["recognitions"] >= found["places in total"] > 0 and found["recognized percent"] > 0, found
        page = folder / f"out/figures/put-mc-floor1-c_l-{c_l}.html"
        assert page.exists() and page.name in messages and f"places-c_l-{c_l}.csv" in messages, messages
        assert list((folder / f"out/figures/put-mc-floor1-c_l-{c_l}").glob("*.svg")), f"c_l {c_l}: no figures"
    assert all(outcome["holds"] is None and outcome["reason"] for outcome in written["findings"]), written["findings"]
    assert (folder / "out/figures/put-mc-floor1-fabmap.html").exists()
    text = (folder / "out/floor1.md").read_text()
    assert text.count("\nMap: not measured.") == text.count("\nFAB-MAP: not measured.") == 1, text
    return written


def check_labeled(before, written, places):
    """Answers of c_l 80 are counted."""
    found = numbers(written, 80)
    sizes = [sum(place["recognitions"].values()) for place in places]
    # An answer stands for the part of a long place around it.
    assert 0 < found["incorrect recognitions"] <= sizes[0], (found, sizes)
    assert 0 < found["correct recognitions"] <= sum(sizes[1:]), (found, sizes)
    assert found["recognitions"] == numbers(before, 80)["recognitions"], found
    assert numbers(written, 60) == numbers(before, 60), "c_l 60 has no answers"
    # Findings on FastABLE are checked at the c_l that has answers.
    for outcome in written["findings"][:3]:
        assert outcome["holds"] is not None and [part["settings"]["c_l"] for part in outcome["parts"]] == [80], outcome


def poses(walk):
    with (rendered / walk / "poses.csv").open() as file:
        return [tuple(float(row[key]) for key in ("x", "y", "heading")) for row in csv.DictReader(file)]


def mark_places():
    """Marks three frames of each training sequence; the number of those that the query passes in this direction."""
    query, passed = poses("query"), 0
    with (downloads / "put-mc-floor1/fabmap-places.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["sequence", "train", "query", "tolerance"])
        for train in description["train"]:
            walk = poses(train["sequence"].rpartition("/")[2])
            for frame in (len(walk) // 4, len(walk) // 2, len(walk) * 3 // 4):
                x, y, heading = walk[frame]
                near = [(math.hypot(one[0] - x, one[1] - y), i) for i, one in enumerate(query)
                        if abs(math.remainder(one[2] - heading, 360)) < 45]
                is_passed = bool(near) and min(near)[0] < 1
                passed += is_passed
                writer.writerow([train["name"], frame, *((min(near)[1], 8) if is_passed else ("", ""))])
    return passed


def check_marked(written, messages, passed):
    """FAB-MAP is measured on the places that a person marked."""
    assert 4 < passed < 2 * len(description["train"]), passed
    found = [{cell["measure"]: cell["ours"] for cell in written["cells"] if cell.get("c_w") == c_w} for c_w in (1, 3)]
    assert all(row["places on the path"] == passed for row in found), found
    assert 0 < max(row["distinct"] for row in found) <= passed, found
    assert all(outcome["holds"] is not None for outcome in written["findings"]), written["findings"]
    assert "FAB-MAP: not measured" not in messages, messages


rendered = render()
description = fetch(pack(rendered, has_subfolders=True))
queries = {query["name"]: query["sequence"] for query in description["queries"]}
assert queries == {"Test1": "SP_PUT_CM_1_test/Test1", "Test2": "SP_PUT_CM_1_test/Test2",
                   "query": "SP_PUT_CM_1_test/Test3"}, queries
description = fetch(pack(rendered, has_subfolders=False))
assert description["queries"] == [{"name": "query", "sequence": "SP_PUT_CM_1_test"}], description
assert len(description["train"]) == 14, description["train"]
unlabeled = check_unlabeled()
places, passed = answer_all(80), mark_places()
labeled, messages = run_floor()  # repeated, because there are answers and marks
check_labeled(unlabeled, labeled, places)
check_marked(labeled, messages, passed)
