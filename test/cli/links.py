#!/usr/bin/env python3
"""Links of the documentation are valid, and scripts/check_links.py finds invalid ones.   links.py SOURCE"""
import pathlib
import subprocess
import sys
import tempfile

source = pathlib.Path(sys.argv[1])
script = source / "scripts/check_links.py"


def broken(root):
    """The complaints about a folder."""
    done = subprocess.run([sys.executable, script, root], capture_output=True, text=True)
    if done.returncode != (1 if done.stdout else 0):
        sys.exit(f"links: ended with {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout.splitlines()


if broken(source):
    sys.exit("\n".join(broken(source)))
with tempfile.TemporaryDirectory() as folder:
    root = pathlib.Path(folder)
    (root / "docs").mkdir()
    (root / "docs/b.md").write_text("# One `two`, three\n\n## Again\n\n## Again\n\n```\n# no heading\n```\n")
    (root / "a.md").write_text("[1](docs/b.md#one-two-three) [2](docs/b.md#again-1) [3](https://x.y/z#w)\n"
                               "[4](c.md) [5](docs/b.md#again-2) [6](docs/b.md#no-heading) [7](#none)\n"
                               "```\n[8](d.md)\n```\n")
    found = broken(root)
    if found != ["a.md: c.md: the file does not exist",
                 *(f"a.md: {link}: the heading does not exist"
                   for link in ("docs/b.md#again-2", "docs/b.md#no-heading", "#none"))]:
        sys.exit(f"links: {found}")
