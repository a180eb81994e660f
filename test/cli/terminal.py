#!/usr/bin/env python3
"""Progress bars on a terminal: they name their step, and are erased before other output.   terminal.py SOURCE BIN"""
import fcntl
import os
import pty
import re
import struct
import termios

from support import folder, programs, source

COLUMNS = 60  # narrower than a whole bar
ERASE = "\r\x1b[K"


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
    assert os.waitstatus_to_exitcode(status) == 0, f"{program} failed: {text}"
    return text


def check_screen(text):
    """Bars are erased before the next line, fit the terminal, and have one width."""
    bars = []
    for line in text.replace("\r\n", "\n").split("\n"):
        states = line.split(ERASE)
        bars += [state for state in states if "%" in state and "[" in state]
        assert not re.search(r"\[[# ]*\]", states[-1]), f"a bar is left in the line: {line!r}"
    assert bars, f"no bar was drawn: {text!r}"
    for bar in bars:
        assert len(bar) < COLUMNS, f"a bar of {len(bar)} columns: {bar!r}"
    assert len({bar.index("[") for bar in bars}) == 1, f"bars of different widths: {bars}"
    return bars


check_screen(run_at_terminal("vpr-synth", source / "configs/worlds/small.json", "-o", folder / "building"))
walks = sorted(path for path in (folder / "building").iterdir() if path.is_dir() and path.name != "places")[:2]
train = [word for walk in walks for word in ("--train", walk)]
bars = check_screen(run_at_terminal("vpr-train", "fastable", *train, "--c-l", 5, "-o", folder / "w.vprdb"))
# A fast machine may draw only the first walk: bars are drawn ten times per second.
steps = [f"describe {walk.name} {index + 1}/2" for index, walk in enumerate(walks)]
described = [bar for bar in bars if "describe" in bar]
assert described and all(any(step in bar for step in steps) for bar in described), bars
text = run_at_terminal("vpr-query", folder / "w.vprdb", "--query", walks[0], "--c-l", 5, "--t-r", 0.3, "-o",
                       folder / "r.json")
check_screen(text)
assert "Recognized 100 of 104 frames" in text, text
