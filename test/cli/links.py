#!/usr/bin/env python3
"""Links of the documentation are valid, and scripts/dev/check_links.py finds invalid ones.   links.py SOURCE"""
import sys

from support import call, folder, source, write

script = source / "scripts/dev/check_links.py"


def broken(root):
    """The complaints about a folder."""
    done = call(sys.executable, script, root)
    assert done.returncode == (1 if done.stdout else 0), done
    return done.stdout.splitlines()


assert broken(source) == []
write("docs/b.md", "# One `two`, three\n\n## Again\n\n## Again\n\n```\n# no heading\n```\n")
write("a.md", "[1](docs/b.md#one-two-three) [2](docs/b.md#again-1) [3](https://x.y/z#w)\n"
              "[4](c.md) [5](docs/b.md#again-2) [6](docs/b.md#no-heading) [7](#none)\n```\n[8](d.md)\n```\n")
assert broken(folder) == ["a.md: c.md: the file does not exist",
                          *(f"a.md: {link}: the heading does not exist"
                            for link in ("docs/b.md#again-2", "docs/b.md#no-heading", "#none"))], broken(folder)
