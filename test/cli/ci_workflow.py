#!/usr/bin/env python3
"""Runs the shell steps of docs/guide/ci/recognition.yml on data/example as in CI, except the one that
builds the toolkit.   ci_workflow.py SOURCE BIN"""
import xml.etree.ElementTree as xml

from support import call, folder, ok, programs, read_json, source, with_path, write


def steps_of(text):
    """Names of steps and the lines of their `run: |`, from a workflow of this simple form."""
    steps, name, lines = [], None, None
    for line in text.splitlines():
        indent = len(line) - len(line.lstrip())
        if lines is not None and line.strip() and indent < 10:
            steps.append((name, "\n".join(lines)))
            lines = None
        if line.startswith("      - name: "):
            name = line.split(": ", 1)[1]
        elif line == "        run: |":
            lines = []
        elif lines is not None:
            lines.append(line[10:])
    return steps


def shell(script):
    return call("bash", "-e", "-o", "pipefail", "-c", script, env=with_path(programs))


steps = dict(steps_of((source / "docs/guide/ci/recognition.yml").read_text()))
assert list(steps) == ["Install the toolkit", "Train", "Recognize", "Judge"], list(steps)
ok(shell(f"cp -r {source}/data/example/* ."))
for name in ("Train", "Recognize"):
    ok(shell(steps[name]))
baseline, judge = steps["Judge"].replace("--junit junit.xml", "--update"), steps["Judge"] + " --force"
ok(shell(baseline))
found = ok(shell(judge))
assert "baseline.json: all of" in found.stdout, found.stdout
suites = xml.parse(folder / "junit.xml").getroot()
assert suites.get("failures") == "0" and int(suites.get("tests")) > 20, suites.attrib
# A worse run fails, and the file names the value.
write("baseline.json", {"schema": "vpr.expected/5", "best_match": {"rate": {"min": 1.5}}})
found = shell(judge)
assert found.returncode == 5, (found.returncode, found.stderr)
case = xml.parse(folder / "junit.xml").getroot()[0][0]
assert case.get("name") == "best_match.rate", case.attrib
assert case[0].get("message").startswith("expected at least 1.5, found "), case[0].attrib
assert (folder / "report.html").stat().st_size > 10000
# An update stores the value, and the next run passes.
ok(shell(baseline + " --force"))
ok(shell(judge))
