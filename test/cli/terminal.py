#!/usr/bin/env python3
"""Progress bars on a terminal: they name their step, and are erased before other output.   terminal.py SOURCE BIN"""
import fcntl
import os
import pathlib
import pty
import re
import struct
import sys
import tempfile
import termios

source, programs = map(pathlib.Path, sys.argv[1:3])
COLUMNS = 60  # narrower than a whole bar
ERASE = "\r\x1b[K"


def check(condition, message):
    if not condition:
        sys.exit(f"terminal: {message}")


def run_at_terminal(program, *arguments):
    """Everything that a program writes to its terminal."""
    child, master = pty.fork()
    if child == 0:
        os.execv(programs / program, [program, *map(str, arguments)])
    fcntl.ioctl(master, termios.TIOCSWINSZ, struct.pack("HHHH", 24, COLUMNS, 0, 0))
    written = b""
    while True:
        try:
            some = os.read(master, 65536)
        except OSError:  # the child's end was closed
            break
        if not some:
            break
        written += some
    _, status = os.waitpid(child, 0)
    text = written.decode()
    check(os.waitstatus_to_exitcode(status) == 0, f"{program} failed: {text}")
    return text


def check_screen(text):
    """Bars are erased before the next line, fit the terminal, and have one width."""
    bars = []
    for line in text.replace("\r\n", "\n").split("\n"):
        states = line.split(ERASE)
        bars += [state for state in states if "%" in state and "[" in state]
        check(not re.search(r"\[[# ]*\]", states[-1]), f"a bar is left in the line: {line!r}")
    check(bars, f"no bar was drawn: {text!r}")
    for bar in bars:
        check(len(bar) < COLUMNS, f"a bar of {len(bar)} columns: {bar!r}")
    check(len({bar.index("[") for bar in bars}) == 1, f"bars of different widths: {bars}")
    return bars


with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder)
    text = run_at_terminal("vpr-synth", source / "configs/worlds/small.json", "-o", out / "building")
    check_screen(text)
    walks = sorted(path for path in (out / "building").iterdir()
                   if path.is_dir() and path.name != "places")[:2]
    train = [word for walk in walks for word in ("--train", walk)]
    text = run_at_terminal("vpr-train", "fastable", *train, "--c-l", 5, "-o", out / "w.vprdb")
    bars = check_screen(text)
    # A fast machine may draw only the first walk: bars are drawn ten times per second.
    steps = [f"describe {walk.name} {index + 1}/2" for index, walk in enumerate(walks)]
    check(all(any(step in bar for step in steps) for bar in bars if "describe" in bar) and
          any("describe" in bar for bar in bars), f"no bar says which walk of 2: {bars}")
    text = run_at_terminal("vpr-query", out / "w.vprdb", "--query", walks[0], "--c-l", 5, "--t-r",
                           0.3, "-o", out / "r.json")
    check_screen(text)
    check("Recognized 100 of 104 frames" in text, text)
