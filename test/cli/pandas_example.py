#!/usr/bin/env python3
"""Runs the example for data frames of docs/guide/evaluation.md on two results, and compares its output
with their reports. Skipped without pandas.   pandas_example.py SOURCE BIN"""
import json
import os
import shutil
import sys

from support import call, folder, ok, run, skip, source, write

try:
    import pandas  # noqa: F401
except ImportError:
    skip("pandas is missing")

page = (source / "docs/guide/evaluation.md").read_text()
start = page.index("```python\nimport pandas") + len("```python\n")
script = page[start:page.index("```", start)]
shutil.copytree(source / "data/example", folder, dirs_exist_ok=True)
head, *pairs = (folder / "pairs.csv").read_text().splitlines()  # the last ten frames have no match
truth = ("--ground-truth", write("truth.csv", "\n".join([head, *(line for line in pairs if int(line.split(",")[0]) < 30)]) + "\n"))
run("vpr-train", "images", "--train", "monday", "-o", "w.vprdb", "--quiet")
for name, length in (("short", 1), ("long", 10)):
    run("vpr-query", "w.vprdb", "--query", "tuesday", "--c-l", length, "--t-r", 0.7, "-o", f"{name}.json", "--quiet")
reports = json.loads(run("vpr-eval", "short.json", "long.json", *truth, "--outcomes-csv", "outcomes.csv", "--json"))["reports"]
lines = ok(call(sys.executable, "-c", script, env={**os.environ, "OMP_NUM_THREADS": "1"})).stdout.splitlines()
for name, report in zip(("short", "long"), reports):
    value = report["report"]["metrics"]["recall_at"]["1"]
    line = next(line for line in lines if line.startswith(name + " "))
    assert abs(float(line.split()[1]) - value) < 1e-5, (line, value)
