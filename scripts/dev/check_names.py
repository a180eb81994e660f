#!/usr/bin/env python3
"""check_names.py [ROOT]: two sources of a folder have no local helpers or types of one name.

The release preset compiles the sources of a folder together, where a call could then find the other file's helper
and convert the argument."""
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2])
ALONE = {"src/match"}  # compiled one by one
BY_TYPE = {"visit_fields"}  # overloads for types of their own
LOCAL = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.M | re.S)
NAME = re.compile(r"^(?=[\w\[])(?!namespace|template|VPR_)"
                  r"(?:.*?\b(?:struct|class) (\w+)|.*?(?<![.\w])(?!void\b)(\w+)(?:\(|\{| =))", re.M)

files = collections.defaultdict(set)
for path in [*ROOT.glob("src/*/*.cpp"), *ROOT.glob("apps/*/*.cpp")]:
    folder = str(path.parent.relative_to(ROOT))
    if folder in ALONE:
        continue
    for body in LOCAL.findall(path.read_text()):
        for match in NAME.finditer(body):
            if (name := match[1] or match[2]) not in BY_TYPE:
                files[folder, name].add(path.name)
shared = {key: names for key, names in files.items() if len(names) > 1}
for (folder, name), names in sorted(shared.items()):
    print(f"{folder}: {name} is in {' and '.join(sorted(names))}; rename one, or share it")
sys.exit(bool(shared))
