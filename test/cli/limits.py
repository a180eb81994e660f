#!/usr/bin/env python3
"""Large inputs, small files of huge numbers, interrupts, and unusual surroundings; prints time and memory.

limits.py SOURCE BIN [FRAMES]     FRAMES: training frames (default: 100 000). 10 000 000 need 4 GB of disk.
"""
import os
import signal
import subprocess
import sys
import tempfile
import time

import numpy

from support import folder as root, programs, read_json

train_frames = int(sys.argv[3]) if len(sys.argv) > 3 else 100_000
random = numpy.random.default_rng(1)
# Programs with sanitizers, whose options scripts/dev/sanitizers.sh sets, need more time and memory.
slack = 4 if {"ASAN_OPTIONS", "TSAN_OPTIONS"} & set(os.environ) else 1


def run(*command, status=0, seconds=60.0, megabytes=1000, interrupt_after=None, prefix=(), **surroundings):
    """Runs a program, checks exit code, processor time and memory, and returns what it prints."""
    with tempfile.TemporaryFile() as printed:
        started = time.monotonic()
        words = [word if isinstance(word, (bytes, os.PathLike)) else str(word) for word in command[1:]]
        child = subprocess.Popen([*prefix, programs / command[0], *words], stdout=printed, stderr=subprocess.STDOUT,
                                 **surroundings)
        if interrupt_after is not None:
            time.sleep(interrupt_after)
            os.kill(child.pid, signal.SIGINT)
            started = time.monotonic()
        _, wait_status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(wait_status)
        memory = usage.ru_maxrss / 1024
        # Processor time, because tests may run in parallel; after an interrupt, time on the clock.
        elapsed = time.monotonic() - started if interrupt_after else usage.ru_utime + usage.ru_stime
        printed.seek(0)
        text = printed.read().decode(errors="surrogateescape")
    allowed = status if isinstance(status, tuple) else (status,)
    if child.returncode not in allowed or elapsed > slack * seconds or memory > slack * megabytes:
        sys.exit(f"limits: {command}: exit code {child.returncode}, {elapsed:.1f} s, {memory:.0f} MB\n{text[-2000:]}")
    return text, f"{elapsed:.2f} s, {memory:.0f} MB"


def write_codes(file, frames):
    """Random codes of 1392 bits, one row per frame."""
    codes = numpy.lib.format.open_memmap(file, "w+", numpy.uint8, (frames, 174))
    for first in range(0, frames, 100_000):
        part = codes[first:first + 100_000]
        part[:] = random.integers(0, 256, part.shape, numpy.uint8)
    return codes


def noisy(codes):
    """Codes with one in eight bits changed."""
    a, b, c = (random.integers(0, 256, codes.shape, numpy.uint8) for _ in range(3))
    return codes ^ (a & b & c)


def large_database(folder):
    codes = write_codes(folder / "train.npy", train_frames)
    middle = train_frames // 2
    numpy.save(folder / "query.npy", noisy(codes[middle:middle + 400]))
    size = codes.nbytes / 2**20
    database, query = folder / "large.vprdb", ["--query", folder / "query.npy"]
    long = train_frames / 100_000 * 60
    print("train:", run("vpr-train", "descriptors", "--train", folder / "train.npy", "--bits", "-o", database,
                        seconds=long, megabytes=1000 + 3 * size)[1])
    for name, flags in {"FastABLE": ["--c-l", 20, "--t-r", 0.5],
                        "FastABLE online": ["--method", "fastable-online", "--c-l", 20, "--t-r", 0.5],
                        "filter": []}.items():
        result = folder / "result.json"
        text, cost = run("vpr-query", database, *query, *flags, "--threads", 1, "-o", result, "--force",
                         seconds=long, megabytes=1000 + 4 * size)
        timing = read_json(result)["timing"]
        print(f"{name}, {train_frames} training frames, 400 query frames: {cost}; match_s {timing['match_s']}")
        if "Recognized" not in text:
            sys.exit(f"limits: {name} recognizes nothing: {text}")


def many_recognitions(folder):
    codes = write_codes(folder / "many.npy", 100_000)
    numpy.save(folder / "few.npy", codes[:11])
    run("vpr-train", "descriptors", "--train", folder / "many.npy", "--bits", "-o", folder / "many.vprdb")
    cost = run("vpr-query", folder / "many.vprdb", "--query", folder / "few.npy", "--c-l", 1, "--t-r", 5000,
               "--t-r-scale", "bits", "-o", folder / "many.json")[1]
    evaluation = run("vpr-eval", folder / "many.json", "--ground-truth", "aligned", "--html", folder / "many.html",
                     "--plot", folder / "many", "-o", folder / "report.json")[1]
    counts = read_json(folder / "report.json")["counts"]["pairs"]
    if (counts["correct"], counts["incorrect"]) != (11, 1_099_989):
        sys.exit(f"limits: of 1 100 000 recognitions, vpr-eval counts {counts}")
    print(f"1.1 million recognitions: query {cost}; evaluation {evaluation}")


def advice(folder):
    """Advice on a query without a match follows its complete outputs, and takes no time with --quiet."""
    write_codes(folder / "train.npy", 200_000)
    write_codes(folder / "query.npy", 150).flush()
    run("vpr-train", "descriptors", "--train", folder / "train.npy", "--bits", "-o", folder / "other.vprdb")
    result = folder / "result.json"
    command = ["vpr-query", folder / "other.vprdb", "--query", folder / "query.npy", "--c-l", 20, "--t-r", 0.1,
               "-o", result, "--threads", 1, "--force"]
    text, with_advice = run(*command)
    without = run(*command, "--quiet")[1]
    print(f"advice on 200 000 training frames: {with_advice}; without: {without}")
    seconds, quiet_seconds = (float(cost.split()[0]) for cost in (with_advice, without))
    if "another place" not in " ".join(text.split()) or 2 * quiet_seconds > seconds:
        sys.exit(f"limits: --quiet takes the time of advice, or there is none: {text}")
    result.unlink()
    child = subprocess.Popen([programs / command[0], *map(str, command[1:])], stdout=subprocess.DEVNULL,
                             stderr=subprocess.PIPE, text=True)
    while not result.exists() and child.poll() is None:
        time.sleep(0.01)
    child.send_signal(signal.SIGINT)
    said = child.communicate()[1]
    if child.returncode != 130 or "the output files are complete" not in said:
        sys.exit(f"limits: a query is interrupted during its advice: exit code {child.returncode}, {said}")
    read_json(result)


def many_loops(folder):
    poses = "".join(f"{i / 10} {i % 1000} {i // 1000 % 2} 0 0 0 0 1\n" for i in range(110_000))
    (folder / "poses.tum").write_text(poses)
    (folder / "loops.csv").write_text("query,match,score\n" + "".join(
        f"{i + 2000},{i + random.integers(0, 3)},{i % 997 / 997}\n" for i in range(100_000)))
    command = ["vpr-eval", "loops", folder / "loops.csv", "--poses", folder / "poses.tum", "--radius", 2, "--gap",
               1000, "--similarity", "--plot", folder / "loops", "--html", folder / "loops.html", "-o",
               folder / "loops.json"]
    started = time.monotonic()
    print("100 000 loops with plots:", run(*command)[1])
    whole = time.monotonic() - started
    before = sorted(path.name for path in folder.iterdir())
    for share in (0.1, 0.3, 0.5, 0.7, 0.9):
        run(*command, "--force", status=(0, 130, -signal.SIGINT), seconds=share * whole + 2, interrupt_after=share * whole)
        if sorted(path.name for path in folder.iterdir()) != before:
            sys.exit("limits: an interrupted vpr-eval loops leaves files")
    print("interrupts at 10 to 90 % of it: end within 2 s, no file is left")


def huge_numbers(folder):
    """Small files that claim huge indices are refused quickly."""
    def file(name, content):
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        return folder / name
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2147483648, 0), }".ljust(117) + "\n"
    shape = file("shape.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode())
    pairs = file("pairs.csv", "query,reference\n4194303,4194303\n")
    anchors = file("anchors.csv", "query,sequence,anchor\n" + "".join(
        f"0,s{s},0\n4194303,s{s},4194303\n" for s in range(16)))
    poses = file("poses.csv", "frame,x,y\n" + "".join(f"{i},0,0\n" for i in range(70_000)))
    lists = file("lists.txt", "9999999 9999999\n")
    dicom = folder / "dicom"
    dicom.mkdir()
    (dicom / "a.dcm").write_bytes(b"\0" * 128 + b"DICM" + bytes(range(256)) * 20)
    (dicom / "b.png").write_bytes((dicom / "a.dcm").read_bytes())
    for expected, *command in [
            ["17592186044416 values of a matrix", "convert", pairs, "--to", "matrix", "-o", folder / "x.npz"],
            ["pairs; the limit is", "convert", "aligned", "--tolerance", 1000000, "--query-frames", 1000000,
             "--train-frames", 1000000, "--to", "pairs", "-o", folder / "x.csv"],
            ["", "check", anchors],
            ["", "convert", poses, "--ground-truth-train", poses, "--radius", 1, "--to", "pairs", "-o", folder / "x.csv"],
            ["need 10000000 x 10000000 scores", "matrix", lists, "--ground-truth", "aligned"],
            ["limits are 268435456 scores and 262144 frames", "matrix", file("many.txt", "4194303 0\n"), "--ground-truth", "aligned"],
            ["expected a matrix of scores", "matrix", shape, "--similarity", "--ground-truth", "aligned"]]:
        text, cost = run("vpr-eval", *command, status=(2, 3, 4), seconds=5, megabytes=600)
        if expected not in " ".join(text.split()):
            sys.exit(f"limits: {command}: expected {expected}, found {text}")
        print(f"vpr-eval {command[0]} {command[1]}: {cost}: {text.strip()[:160]}")
    text, cost = run("vpr-train", "fastable", "--train", dicom, "-o", folder / "x.vprdb", status=3)
    print(f"DICOM: {cost}: {text.strip()[:160]}")


def surroundings(folder):
    """No environment, a name that is not UTF-8, and folders that cannot be written."""
    odd = os.fsencode(folder) + b"/caf\xe9 \x1b[1m"
    os.mkdir(odd)
    for i in range(40):
        pixels = random.integers(0, 256, (8, 8), numpy.uint8).repeat(16, 0).repeat(16, 1)
        with open(odd + b"/%04d.pgm" % i, "wb") as image:
            image.write(b"P5 128 128 255\n" + pixels.tobytes())
    run("vpr-train", "fastable", "--train", odd, "-o", odd + b".vprdb", env={})
    run("vpr-query", odd + b".vprdb", "--query", odd, "--c-l", 5, "--t-r", 0.5, "-o", odd + b".json", env={})
    text = run("vpr-eval", odd + b".json", "--ground-truth", "aligned", "--html", odd + b".html", env={})[0]
    if "\x1b" in text:
        sys.exit(f"limits: escapes of names are printed: {text!r}")
    for name in (b".json", b".html"):
        with open(odd + name, "rb") as written:
            written.read().decode()
    locked = folder / "locked"
    locked.mkdir(mode=0o555)
    # Root may write everywhere; without this capability, permissions hold for it as well.
    prefix = ["setpriv", "--bounding-set", "-dac_override", "--inh-caps", "-dac_override"] if os.getuid() == 0 else []
    text = run("vpr-query", odd + b".vprdb", "--query", odd, "-o", locked / "r.json", status=3, prefix=prefix)[0]
    print(f"folder without write permission: {text.strip()[:160]}")
    print("no environment, names that are not UTF-8: ok")


for part in (surroundings, huge_numbers, advice, many_loops, many_recognitions, large_database):
    (root / part.__name__).mkdir()
    part(root / part.__name__)
