#!/usr/bin/env python3
"""Runs the shell steps of docs/guide/ci/recognition.yml on a rendered building as in CI, except the
one that builds the toolkit.   ci_workflow.py SOURCE BIN"""
import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml


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


def run(script, folder, bin):
    environment = {**os.environ, "PATH": bin + ":" + os.environ["PATH"]}
    return subprocess.run(["bash", "-e", "-o", "pipefail", "-c", script], cwd=folder, text=True,
                          env=environment, capture_output=True)


def main(source, bin):
    steps = dict(steps_of(open(f"{source}/docs/guide/ci/recognition.yml").read()))
    assert list(steps) == ["Install the toolkit", "Train", "Recognize", "Judge"], list(steps)
    with tempfile.TemporaryDirectory() as folder:
        world = f"vpr-synth {source}/configs/worlds/building.json -o world --quiet && cp -r world/* ."
        first = run(world, folder, bin)
        assert first.returncode == 0, first.stderr
        dataset = json.load(open(f"{folder}/dataset.json"))
        dataset["queries"] = [query for query in dataset["queries"] if query["name"] == "tuesday"]
        dataset["queries"][0]["name"] = "walk"
        assert len(dataset["train"]) == 1, dataset["train"]
        json.dump(dataset, open(f"{folder}/walks.json", "w"))
        for name in ("Train", "Recognize"):
            found = run(steps[name], folder, bin)
            assert found.returncode == 0, (name, found.stderr)
        baseline = steps["Judge"].replace("--junit junit.xml", "--update")
        found = run(baseline, folder, bin)
        assert found.returncode == 0, found.stderr
        found = run(steps["Judge"] + " --force", folder, bin)
        assert found.returncode == 0, found.stderr
        assert "baseline.json: all of" in found.stdout, found.stdout
        suites = xml.parse(f"{folder}/junit.xml").getroot()
        assert suites.get("failures") == "0" and int(suites.get("tests")) > 20, suites.attrib
        # A worse run fails, and the file names the value.
        expected = {"schema": "vpr.expected/4", "best_match": {"rate": {"min": 1.5}}}
        json.dump(expected, open(f"{folder}/baseline.json", "w"))
        found = run(steps["Judge"] + " --force", folder, bin)
        assert found.returncode == 5, (found.returncode, found.stderr)
        case = xml.parse(f"{folder}/junit.xml").getroot()[0][0]
        assert case.get("name") == "best_match.rate", case.attrib
        assert case[0].get("message").startswith("expected at least 1.5, found "), case[0].attrib
        assert os.path.getsize(f"{folder}/report.html") > 10000
        # An update stores the value, and the next run passes.
        assert run(baseline + " --force", folder, bin).returncode == 0
        assert run(steps["Judge"] + " --force", folder, bin).returncode == 0


main(*sys.argv[1:])
