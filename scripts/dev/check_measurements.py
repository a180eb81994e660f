#!/usr/bin/env python3
"""check_measurements.py [ROOT]: pages with measured numbers state their date or commit, and do not pass for newer.

A comment `<!-- measures: PATH... -->` lists the sources that a page measures, or `nothing`. The page is refused if
these have changed since its first stated commit or its last stated date (`November 27, 2026`, to the end of the day),
unless it tells its readers that it is "a record of" that time. Without the history of git, everything passes."""
import datetime
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2])
MONTHS = "January February March April May June July August September October November December".split()
DATE = re.compile(rf"\b({'|'.join(MONTHS)}) (\d{{1,2}}), (20\d\d)\b")
RECORD = re.compile(r"\b[Rr]ecord of\b")
COMMIT = re.compile(r"\bcommit ([0-9a-f]{7,40})\b")


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True)


def newer(text, paths):
    """The newest commit that changed the paths after the page was measured; empty if there is none."""
    if stated := COMMIT.search(text):
        since = [f"{stated[1]}..HEAD"]
    else:
        year, month, day = max((int(y), MONTHS.index(m), int(d)) for m, d, y in DATE.findall(text))
        since = ["--since", f"{datetime.date(year, month + 1, day)} 23:59:59 +0000", "HEAD"]
    found = git("log", "-1", "--format=%h of %cs", *since, "--", *paths)
    return found.stdout.strip() if found.returncode == 0 else "an unknown commit"


def problem(path, text):
    measures = re.search(r"^<!-- measures: (.*) -->$", text, re.M)
    is_dated = bool(DATE.search(text) or COMMIT.search(text))
    if not measures and (RECORD.search(text) or not is_dated and "benchmarks" not in path.parts):
        return ""
    if not measures:
        return "no comment <!-- measures: PATH... -->"
    paths = measures[1].split()
    if paths == ["nothing"]:
        return ""
    if missing := [name for name in paths if not (ROOT / name).exists()]:
        return f"it measures {', '.join(missing)}, which do not exist"
    if not is_dated:
        return "no date and no commit of its measurement"
    changed = "" if RECORD.search(text) else newer(text, paths)
    return changed and f"{' '.join(paths)} changed in {changed}. Measure again, or call it a record of its time"


if git("rev-parse", "--is-shallow-repository").stdout.strip() != "false":
    print("measurements: unknown without the history of git")
    sys.exit(0)
pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
found = {name: problem(name, (ROOT / name).read_text()) for name in (page.relative_to(ROOT) for page in pages)}
print("".join(f"{name}: {text}\n" for name, text in found.items() if text), end="")
sys.exit(any(found.values()))
