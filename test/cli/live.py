#!/usr/bin/env python3
"""vpr-query live follows a growing folder until Ctrl-C, and image paths on standard input.
   live.py SOURCE BIN"""
import json
import signal
import subprocess

from support import folder, programs, run, source, write

WINDOWS = ("--c-l", "3", "--score", "zscore", "--decide", "margin")


def start(*words):
    return subprocess.Popen([programs / "vpr-query", "live", "w.vprdb", "--query", *words], cwd=folder, text=True,
                            bufsize=1, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def growing_folder():
    expected = run("vpr-query", "live", "w.vprdb", "--query", "list.txt", *WINDOWS).splitlines()
    (folder / "frames").mkdir()
    live = start("frames", *WINDOWS)
    for number, frame in enumerate(frames):
        image = frame.read_bytes()
        if number % 2 == 0:  # in two halves; or at once under another name
            with open(folder / "frames" / frame.name, "wb") as file:
                file.write(image[:len(image) // 2])
                file.flush()
                file.write(image[len(image) // 2:])
        else:
            (folder / "frames/.part").write_bytes(image)
            (folder / "frames/.part").rename(folder / "frames" / frame.name)
        assert live.stdout.readline().rstrip("\n") == expected[number], frame
    live.send_signal(signal.SIGINT)
    out, error = live.communicate(timeout=60)
    assert live.returncode == 130 and out == "" and f"{len(frames)} frames; from frame to line" in error, (out, error)


def standard_input():
    live = start("-", "--c-l", "2", "--t-r", "300", "--t-r-scale", "bits")
    # Some editors write a byte order mark at the beginning.
    for frame, before in zip(frames, ("\ufeff", "# a note\n\n")):
        live.stdin.write(f"{before}{frame}\n")
        line = json.loads(live.stdout.readline())
        assert line["name"] == frame.name and (line["match"] is None) == (frame == frames[0]), line
    out, error = live.communicate(str(frames[2]), timeout=60)  # without a line feed
    assert live.returncode == 0 and json.loads(out)["frame"] == 2, (out, error)


run("vpr-synth", source / "test/golden/world.json", "-o", "world", "--quiet")
run("vpr-train", "fastable", "--dataset", "world/dataset.json", "-o", "w.vprdb", "--quiet")
frames = sorted((folder / "world/back").glob("*.png"))[:20]
write("list.txt", "".join(f"{frame}\n" for frame in frames))
growing_folder()
standard_input()
