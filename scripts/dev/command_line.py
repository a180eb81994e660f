#!/usr/bin/env python3
"""command_line.py [--check] [BIN]: writes docs/reference/command-line.md from the --help of the programs
in BIN (default: build/release/bin). --check fails if the page differs."""
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parents[2]
PAGE = root / "docs/reference/command-line.md"
PROGRAMS = ["vpr-train", "vpr-query", "vpr-tune", "vpr-eval", "vpr-bench", "vpr-synth"]
COMMON = "Common options"
# Sections that are the same for all commands that have them.
SHARED = ["Speeds", "Exit codes"]


def sections(folder, command):
    """The help of a command: pairs of a heading, first an empty one, and its text."""
    program, *words = command
    text = subprocess.run([folder / program, *words, "--help"], check=True, capture_output=True, text=True).stdout
    parts = re.split(r"^([A-Z][^\n:]*):\n", text, flags=re.M)
    return [("", parts[0].strip())] + [(name, body.rstrip()) for name, body in zip(parts[1::2], parts[2::2])]


def page(folder):
    common, shared = {}, {}  # texts of common options by their names; sections by their headings
    out = ["# Command line", "", "The `--help` of every command. `-h` prints the essential options only.",
           "Written by `scripts/dev/command_line.py`.", ""]
    for program in PROGRAMS:
        names = re.findall(r"^  ([a-z]+) ", dict(sections(folder, [program])).get("Commands", ""), flags=re.M)
        for command in [[program], *([program, name] for name in names)]:
            blocks = []
            for heading, body in sections(folder, command):
                if heading == COMMON:
                    options = re.split(r"\n(?=  -)", body)
                    for option in options:
                        common.setdefault(option.split()[0], option)
                    blocks.append(f"{heading}: " + " ".join(option.split()[0] for option in options))
                elif heading in SHARED:
                    shared[heading] = body
                else:
                    blocks.append(f"{heading}:\n{body}" if heading else body)
            out += [f"{'#' * (1 + len(command))} {' '.join(command)}", "", "```", "\n\n".join(blocks), "```", ""]
    shared[COMMON] = "\n".join(common.values())
    for heading in [COMMON, *SHARED]:
        out += [f"## {heading}", "", "```", shared[heading], "```", ""]
    return "\n".join(out[:-1]) + "\n"


words = sys.argv[1:]
check = "--check" in words
folders = [word for word in words if word != "--check"]
text = page(pathlib.Path(folders[0]).resolve() if folders else root / "build/release/bin")
if not check:
    PAGE.write_text(text)
elif not PAGE.exists() or PAGE.read_text() != text:
    sys.exit("docs/reference/command-line.md differs from the programs' --help: run scripts/generate.sh")
