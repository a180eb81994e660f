#!/usr/bin/env python3
"""The public recording of the paper, from the layout of its archive to counts by labeled places.

    first_floor.py SOURCE BIN"""
import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile

source, programs = map(pathlib.Path, sys.argv[1:3])


def check(condition, message):
    if not condition:
        sys.exit(f"first_floor: {message}")


def render(folder):
    """The stand-in of the first floor with tiny images."""
    world = json.loads((source / "configs/worlds/put-mc-floor1.json").read_text())
    (folder / "world.json").write_text(json.dumps({**world, "image_width": 80, "image_height": 60}))
    subprocess.run([programs / "vpr-synth", folder / "world.json", "-o", folder / "world", "--quiet"], check=True)
    return folder / "world"


def pack(folder, world, has_subfolders):
    """An archive of images only, as published."""
    archive = folder / "SP_PUT_CM_1.tar.gz"
    train = [path for path in sorted(world.iterdir()) if path.is_dir() and path.name[0] in "abcde"
             and path.name[1] == "-"]
    check(len(train) == 14, f"training sequences: {train}")
    with tarfile.open(archive, "w:gz", compresslevel=1) as tar:
        for path in train:
            add_images(tar, path, f"SP_PUT_CM_1_train/{path.name}")
        test = "SP_PUT_CM_1_test"
        add_images(tar, world / "query", f"{test}/Test3" if has_subfolders else test)
        if has_subfolders:
            for name, path in (("Test1", train[0]), ("Test2", train[1])):
                add_images(tar, path, f"{test}/{name}")
    return archive


def add_images(tar, folder, name):
    for path in sorted(folder.glob("*.jpg")) + sorted(folder.glob("*.png")):
        tar.add(path, f"{name}/{path.name}")


def fetch(folder, archive):
    """fetch-data.sh with a curl that copies the archive."""
    stubs = folder / "stubs"
    stubs.mkdir(exist_ok=True)
    size = archive.stat().st_size
    (stubs / "curl").write_text(f"""#!/bin/bash
case "$*" in *--head*) echo "Content-Length: {size}"; exit;; esac
while [[ $1 != --output ]]; do shift; done
cp {archive} "$2"
""")
    (stubs / "curl").chmod(0o755)
    downloads = folder / "downloads"
    shutil.rmtree(downloads, ignore_errors=True)
    done = subprocess.run([source / "scripts/fetch-data.sh", "put-mc-floor1", "--to", downloads], text=True,
                          env={**os.environ, "PATH": f"{stubs}:{os.environ['PATH']}"}, capture_output=True)
    check(done.returncode == 0, f"fetch-data.sh: {done.stdout}{done.stderr}")
    return downloads


def run_floor(folder, downloads):
    """The experiment's output, and its messages."""
    done = subprocess.run(
        [source / "scripts/reproduce/run.sh", "floor1", "--data", downloads, "--out", folder / "out"], text=True,
        env={**os.environ, "VPR_BIN": str(programs)}, capture_output=True)
    check(done.returncode == 0, f"run.sh floor1: {done.returncode}, {done.stderr}")
    return json.loads((folder / "out/floor1.json").read_text()), done.stderr


def numbers(written, c_l):
    return {cell["measure"]: cell["ours"] for cell in written["cells"] if cell.get("c_l") == c_l}


def answer_all(folder, downloads, c_l):
    """Answers yes to every place of the last report, but no to the first."""
    report = json.loads((folder / "out/reproduce/report.json").read_text())
    check(report["settings"]["c_l"] == c_l, f"the last report has c_l {report['settings']['c_l']}")
    places = report["recognized_places"]
    with (downloads / f"put-mc-floor1/places-c_l-{c_l}.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["place", "query", "sequence", "train", "same"])
        for number, place in enumerate(places, 1):
            writer.writerow([number, place["query"], place["sequence"], place["train"],
                             "no" if number == 1 else "yes"])
    return places


def check_unlabeled(folder, downloads):
    """Totals, a page of places and figures for each window length; findings are not measured."""
    written, messages = run_floor(folder, downloads)
    for c_l in (20, 40, 60, 80):
        found = numbers(written, c_l)
        check(found["correct recognitions"] is None and found["localized per cent"] is None, found)
        check(found["recognitions"] >= found["places in total"] > 0 and found["recognized per cent"] > 0, found)
        page = folder / f"out/figures/put-mc-floor1-c_l-{c_l}.html"
        check(page.exists() and str(page) in messages and f"places-c_l-{c_l}.csv" in messages, messages)
        check(list((folder / f"out/figures/put-mc-floor1-c_l-{c_l}").glob("*.svg")), f"c_l {c_l}: no figures")
    check(all(outcome["holds"] is None and outcome["reason"] for outcome in written["findings"]),
          written["findings"])
    return written


def check_labeled(folder, downloads, before):
    """Answers of c_l 80 are counted; they also cause the experiment to be repeated."""
    places = answer_all(folder, downloads, 80)
    written, _ = run_floor(folder, downloads)
    found = numbers(written, 80)
    sizes = [sum(place["recognitions"].values()) for place in places]
    check(found["incorrect recognitions"] == sizes[0], f"{found}, sizes of places: {sizes}")
    check(found["correct recognitions"] == sum(sizes[1:]), f"{found}, sizes of places: {sizes}")
    check(found["recognitions"] == numbers(before, 80)["recognitions"], found)
    check(numbers(written, 60) == numbers(before, 60), "c_l 60 has no answers")


with tempfile.TemporaryDirectory() as temporary:
    root = pathlib.Path(temporary)
    rendered = render(root)
    data = fetch(root, pack(root, rendered, has_subfolders=True))
    description = json.loads((data / "put-mc-floor1/dataset.json").read_text())
    queries = {query["name"]: query["sequence"] for query in description["queries"]}
    check(queries == {"Test1": "SP_PUT_CM_1_test/Test1", "Test2": "SP_PUT_CM_1_test/Test2",
                      "query": "SP_PUT_CM_1_test/Test3"}, queries)
    data = fetch(root, pack(root, rendered, has_subfolders=False))
    description = json.loads((data / "put-mc-floor1/dataset.json").read_text())
    check(description["queries"] == [{"name": "query", "sequence": "SP_PUT_CM_1_test"}], description)
    check(len(description["train"]) == 14, description["train"])
    check_labeled(root, data, check_unlabeled(root, data))
