#!/usr/bin/env python3
"""Runs the example for data frames of docs/guide/evaluation.md on two results, and compares its output
with their reports. Skipped without pandas.   pandas_example.py SOURCE BIN"""
import json
import os
import subprocess
import sys
import tempfile

try:
    import pandas  # noqa: F401
except ImportError:
    print("pandas is missing")
    sys.exit(77)


def example(text):
    start = text.index("```python\nimport pandas") + len("```python\n")
    return text[start:text.index("```", start)]


def main(source, bin):
    script = example(open(f"{source}/docs/guide/evaluation.md").read())
    with tempfile.TemporaryDirectory() as folder:
        def run(*words):
            done = subprocess.run([f"{bin}/{words[0]}", *words[1:]], cwd=folder, text=True,
                                  capture_output=True)
            assert done.returncode == 0, done.stderr
            return done.stdout

        run("vpr-synth", f"{source}/configs/worlds/small.json", "-o", "world", "--quiet")
        data = ["--dataset", "world/dataset.json"]
        run("vpr-train", "fastable", *data, "-o", "w.vprdb", "--quiet")
        for name, length in (("short", "1"), ("long", "10")):
            run("vpr-query", "w.vprdb", *data, "--query", "query", "--c-l", length, "--t-r", "0.3",
                "-o", f"{name}.json", "--quiet")
        reports = json.loads(run("vpr-eval", "short.json", "long.json", *data, "--outcomes-csv",
                                 "outcomes.csv", "--json"))["reports"]
        done = subprocess.run([sys.executable, "-c", script], cwd=folder, text=True,
                              capture_output=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
        assert done.returncode == 0, done.stderr
        for name, report in zip(("short", "long"), reports):
            value = report["report"]["metrics"]["recall_at"]["1"]
            line = [line for line in done.stdout.splitlines() if line.startswith(name + " ")][0]
            assert abs(float(line.split()[1]) - value) < 1e-5, (line, value)


main(*sys.argv[1:])
