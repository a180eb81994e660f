#!/usr/bin/env python3
"""The commands of README and guide, exactly as printed, run and recognize places; the report has every
number of the worked example.   documents.py SOURCE BIN"""
import math
import pathlib
import struct
import tempfile

import numpy
from PIL import Image

from support import call, folder, ok, programs, read_json, run, source, with_path, write

recordings = folder / "recordings"
recordings.mkdir()


def read_page(path):
    """Blocks ```sh and comments <!-- sh, in order, and the lines of other blocks that begin with one of our
    programs."""
    commands, untested, end = [], [], None
    for line in path.read_text().splitlines():
        if end is None:
            is_tested = line in ("```sh", "<!-- sh")
            end = "-->" if line == "<!-- sh" else "```" if line.startswith("```") else None
        elif line == end:
            end = None
        elif is_tested:
            commands.append(line)
        elif line.startswith("vpr-"):
            untested.append(line)
    return "\n".join(commands), untested


def link_example():
    """Links to the images of data/example, and their poses on a ring as a TUM trajectory."""
    example = source / "data/example"
    for name in ("monday", "tuesday", "wednesday", "pairs.csv"):
        (recordings / name).symlink_to(example / name)
    for name in ("monday", "tuesday"):
        angles = (2 * math.pi * frame / 40 for frame in range(40))
        write(recordings / f"{name}.tum", "".join(
            f"{frame} {3 * math.cos(angle)} {3 * math.sin(angle)} 0 0 0 0 1\n" for frame, angle in enumerate(angles)))


def descriptors(name):
    """A row per frame: gray values of a small image, float32, with zero mean and unit length."""
    images = (Image.open(path).convert("L").resize((12, 9), Image.BOX) for path in sorted((recordings / name).glob("*.jpg")))
    rows = numpy.array([numpy.asarray(image, numpy.float32).ravel() for image in images])
    rows -= rows.mean(1, keepdims=True)
    return rows / numpy.linalg.norm(rows, axis=1, keepdims=True)


def video(frames, per_second=8):
    """An AVI file of JPEG images."""
    def chunk(name, *parts):
        data = b"".join(parts)
        return name + struct.pack("<I", len(data)) + data + b"\0" * (len(data) % 2)

    width, height = Image.open(frames[0]).size
    size = struct.pack("<14I", 10**6 // per_second, 0, 0, 0, len(frames), 0, 1, 0, width, height, 0, 0, 0, 0)
    stream = struct.pack("<12I", 0, 0, 0, 1, per_second, 0, len(frames), 0, 0, 0, 0, 0)
    image = struct.pack("<3I2H4s5I", 40, width, height, 1, 24, b"MJPG", 3 * width * height, 0, 0, 0, 0)
    head = chunk(b"LIST", b"strl", chunk(b"strh", b"vidsMJPG", stream), chunk(b"strf", image))
    images = (chunk(b"00dc", frame.read_bytes()) for frame in frames)
    return chunk(b"RIFF", b"AVI ", chunk(b"LIST", b"hdrl", chunk(b"avih", size), head), chunk(b"LIST", b"movi", *images))


def derive():
    """Arrays and a video of monday and tuesday."""
    train, query = descriptors("monday"), descriptors("tuesday")
    for name, values in (("monday", train), ("tuesday", query), ("S", query @ train.T)):
        numpy.save(recordings / f"{name}.npy", values)
    (recordings / "tuesday.avi").write_bytes(video(sorted((recordings / "tuesday").glob("*.jpg"))))


def render():
    """The building for maps, and its floor above as another place."""
    run("vpr-synth", source / "configs/worlds/small.json", "-o", recordings / "building")
    (recordings / "upstairs").symlink_to(recordings / "building/upstairs")


def run_page(path):
    """Runs the commands of a page in a new folder with links to all recordings."""
    commands, untested = read_page(path)
    with tempfile.TemporaryDirectory() as place:
        for one in recordings.iterdir():
            (pathlib.Path(place) / one.name).symlink_to(one)
        done = ok(call("bash", "-euo", "pipefail", "-c", commands, cwd=place, env=with_path(programs)))
    if path.parent == source:
        text = " ".join(done.stdout.split())
        assert " frames of tuesday:" in text and " recognized, all correctly." in text, text
    # A test has neither a camera nor other recordings.
    assert path.name in ("check-claims.md", "record.md") or all("/dev/video" in command for command in untested), untested


def worked_example():
    rows = {}  # by the first cell, without its quotes
    for line in (source / "docs/reference/metrics.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.split("|")]
        if len(cells) > 2:
            rows[cells[1].replace("`", "")] = cells[2:-1]
    frames = range(10)
    write("truth.csv", "query,reference\n" + "".join(
        f"{frame},{rows['truth'][frame]}\n" for frame in frames if rows["truth"][frame]))
    write("matches.csv", "query,reference,score\n" + "".join(
        f"{frame},{rows['best match'][frame]},{rows['score'][frame]}\n" for frame in frames if rows["best match"][frame]))
    run("vpr-eval", "matrix", "matches.csv", "--similarity", "--threshold", 0.55, "--ground-truth", "truth.csv", "-o",
        "report.json")
    checked = 0
    for name, cells in rows.items():
        if not name.startswith(("best_match.", "metrics.", "localization.")):
            continue
        value, keys = read_json("report.json"), name
        while keys:  # a key may have a point
            key = next(key for key in sorted(value, key=len, reverse=True) if f"{keys}.".startswith(f"{key}."))
            value, keys = value[key], keys[len(key) + 1:]
        assert abs(value - float(cells[0])) <= 0.00005, (name, value, cells)
        checked += 1
    assert checked == 23, checked


link_example()
derive()
render()
worked_example()
for page in (source / "README.md", source / "configs/worlds/README.md", *sorted((source / "docs/guide").glob("*.md"))):
    run_page(page)
