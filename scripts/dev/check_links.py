#!/usr/bin/env python3
"""check_links.py [ROOT]: checks that the links in all Markdown files point to files and headings.

Does not follow links to web pages. Forms anchors like GitHub."""
import pathlib
import re
import subprocess
import sys


def without_code(text):
    text = re.sub(r"^(```|~~~).*?^\1", "", text, flags=re.S | re.M)
    return re.sub(r"`[^`\n]*`", lambda code: code[0].replace("[", "").replace("]", ""), text)


def anchors(path):
    """Anchors of the headings; a repeated one has a number."""
    found = set()
    for heading in re.findall(r"^#+ +(.*)$", without_code(path.read_text()), flags=re.M):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        number = 0
        while (name := f"{slug}-{number}" if number else slug) in found:
            number += 1
        found.add(name)
    return found


root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2])
listed = subprocess.run(["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard", "*.md"],
                        capture_output=True, text=True)
if listed.returncode == 0:
    files = [root / name for name in listed.stdout.split("\n") if name and (root / name).exists()]
else:
    files = sorted(root.rglob("*.md"))
broken = 0
for file in files:
    for link in re.findall(r"\]\(([^)\s]+)\)", without_code(file.read_text())):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = file.parent / path if path else file
        if not target.exists():
            problem = "the file does not exist"
        elif anchor and target.suffix == ".md" and anchor not in anchors(target):
            problem = "the heading does not exist"
        else:
            continue
        print(f"{file.relative_to(root)}: {link}: {problem}")
        broken += 1
sys.exit(broken > 0)
