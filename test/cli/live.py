#!/usr/bin/env python3
"""vpr-query live matches image paths on standard input as they arrive, also those of new images in a
folder by the command of docs/guide/inputs.md, and a folder to its end.   live.py SOURCE BIN"""
import json
import os
import shutil
import signal
import subprocess

from support import call, folder, ok, programs, run, skip, source, with_path, write

WINDOWS = ("--c-l", "3", "--score", "zscore", "--decide", "margin")


def start(*words, **more):
    return subprocess.Popen(words, cwd=folder, text=True, bufsize=1, **{
        "stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more})


def recording():
    expected = run("vpr-query", "live", "monday.vprdb", "--query", "list.txt", *WINDOWS)
    (folder / "walk").mkdir()
    for frame in frames:
        (folder / "walk" / frame.name).symlink_to(frame)
    live = ok(call("vpr-query", "live", "monday.vprdb", "--query", "walk", *WINDOWS))
    assert live.stdout == expected and guide_command("walk") in live.stderr, (live.stdout, live.stderr)
    assert "inotifywait" not in ok(call("vpr-query", "live", "monday.vprdb", "--query", "walk", "--quiet")).stderr


def standard_input():
    lines = (folder / "list.txt").read_text()
    piped = run("vpr-query", "live", "monday.vprdb", "--query", "-", input=lines)
    assert piped == run("vpr-query", "live", "monday.vprdb", "--query", "list.txt"), piped
    # Names that are gone take no time.
    thinned = ("vpr-query", "live", "monday.vprdb", "--fps", "1", "--recorded-fps", "2", "--query")
    both = "".join(f"frames/gone.jpg\n{frame}\n" for frame in frames)
    assert run(*thinned, "-", input=both) == run(*thinned, "list.txt")
    live = start(programs / "vpr-query", "live", "monday.vprdb", "--query", "-", "--c-l", "2", "--t-r", "300",
                 "--t-r-scale", "bits")
    # Some editors write a byte order mark at the beginning. A temporary name may be gone.
    for frame, before in zip(frames, ("\ufeff", "# a note\n\nframes/gone.jpg\n")):
        live.stdin.write(f"{before}{frame}\n")
        line = json.loads(live.stdout.readline())
        assert line["name"] == frame.name and (line["match"] is None) == (frame == frames[0]), line
    out, error = live.communicate(str(frames[2]), timeout=60)  # without a line feed
    assert live.returncode == 0 and json.loads(out)["frame"] == 2, (out, error)
    assert error.count("warning: ") == 1 and "frames/gone.jpg: does not exist, and is omitted" in error, error


def guide_command(name):
    lines = (source / "docs/guide/inputs.md").read_text().splitlines()
    return next(line for line in lines if line.startswith("inotifywait ")).replace(" frames ", f" {name} ")


def put(frame, kind):
    """Writes an image in two halves; or at once to another name, then renames it."""
    image, path = frame.read_bytes(), folder / "frames" / frame.name
    if kind == 0:
        with open(path, "wb") as file:
            file.write(image[:len(image) // 2])
            file.flush()
            file.write(image[len(image) // 2:])
    else:
        temporary = path.with_name(f".{frame.name}" if kind == 1 else f"{frame.name}.tmp")
        temporary.write_bytes(image)
        temporary.rename(path)


def new_images():
    expected = run("vpr-query", "live", "monday.vprdb", "--query", "list.txt").splitlines()
    (folder / "frames").mkdir()
    errors = folder / write("errors", "")
    live = start("bash", "-c", guide_command("frames"), env=with_path(programs), start_new_session=True,
                 stderr=errors.open("w"))
    while "frames/0.tmp: is not the name of an image" not in errors.read_text():  # until inotifywait watches
        (folder / "frames/0.tmp").write_text("")
        assert live.poll() is None, errors.read_text()
    for number, frame in enumerate(frames):
        put(frame, number % 3)
        assert live.stdout.readline().rstrip("\n") == expected[number], frame
    os.killpg(live.pid, signal.SIGINT)  # as Ctrl-C
    out, _ = live.communicate(timeout=60)
    error = errors.read_text()
    assert live.returncode in (130, -signal.SIGINT), (live.returncode, error)  # -SIGINT: of the shell
    assert out.splitlines() == expected[len(frames):], (out, expected[len(frames):])
    assert f"{len(frames)} frames; from frame to line" in error and error.count("warning: ") == 1, error


run("vpr-synth", source / "test/golden/world.json", "-o", "world", "--quiet")
run("vpr-train", "fastable", "--dataset", "world/dataset.json", "-o", "monday.vprdb", "--quiet")
frames = sorted((folder / "world/back").glob("*.png"))[:20]
write("list.txt", "".join(f"{frame}\n" for frame in frames))
recording()
standard_input()
if not shutil.which("inotifywait"):
    skip("there is no inotifywait; install inotify-tools")
new_images()
