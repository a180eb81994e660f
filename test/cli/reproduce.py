#!/usr/bin/env python3
"""Output and messages of scripts/reproduce, without running an experiment.   reproduce.py SOURCE"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

source = pathlib.Path(sys.argv[1])
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "scripts/reproduce"))
import experiments  # noqa: E402
import findings  # noqa: E402
import reproduce  # noqa: E402
import tables  # noqa: E402


def check(condition, message):
    if not condition:
        sys.exit(f"reproduce: {message}")


def check_mistyped_name():
    """A mistyped name is reported before anything is installed or built."""
    with tempfile.TemporaryDirectory() as folder:
        for program in ("cmake", "apt-get", "dpkg-query"):
            stub = pathlib.Path(folder) / program
            stub.write_text("#!/bin/sh\necho started >&2\nexit 1\n")
            stub.chmod(0o755)
        environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}
        environment.pop("VPR_BIN", None)
        done = subprocess.run([source / "scripts/reproduce/run.sh", "nosuch"], env=environment,
                              capture_output=True, text=True)
    check(done.returncode == 2, f"nosuch ended with {done.returncode}")
    check("started" not in done.stderr, "nosuch began to build")
    check("nosuch" in done.stderr and "tab4" in done.stderr, f"nosuch: {done.stderr}")


def result_of(name, cells, outcomes, machine):
    maker = {"program": "vpr-tune", "version": "0.1.0", "commit": "unknown", "seed": 1}
    provenance = {**maker, "program": "reproduce.py", "inputs_sha256": "0" * 64, "programs": [maker],
                  "data": [{"name": "d", "title": "D", "stand_in": True, "dataset_sha256": "0" * 64}],
                  "databases": {"d.fastable": "xxh3:" + "0" * 32}}
    return {"schema": "vpr.reproduction/3", "experiment": name, "title": "Table", "paper": "P", "data": ["D"],
            "quick": False, "cells": cells, "findings": outcomes, "summary": findings.summary(outcomes),
            "notes": ["A note."], "provenance": provenance, **machine, "timing": {"elapsed_s": 1.5}}


def check_files(folder):
    """JSON fits its schema, and times keep their quartiles and the paper's grid."""
    times = experiments.cells_of(
        [experiments.Measured(
            {"what": f"FastABLE over OpenABLE, {phone}", "our_work": "fastable", "frames": frames,
             "c_l": 20, "times": paper}, {"times": 12.5} if frames < 2000 else {},
            {"low": 11.0, "high": 14.0}, "it is too large")
         for phone, papers in (("A", (11.4, 9.8, 9.3)), ("B", (15.3, 11.0, 9.7)))
         for frames, paper in zip((500, 1000, 2000), papers)])
    written = result_of("tab6", times, [], {"machine": {"host": "h", "threads": 1, "simd": "AVX2"}})
    tables.write_json(folder / "tab6.json", written)
    tables.write_markdown(folder / "tab6.md", written, "bench")
    lines = (folder / "tab6.md").read_text().splitlines()
    check("| c_l | whose | 500 | 1000 | 2000 |" in lines, lines)
    check("| 20 | ours: fastable | 12.5 (11 to 14) | 12.5 (11 to 14) | not measured |" in lines, lines)
    check("| 20 | paper: FastABLE over OpenABLE, A | 11.4 | 9.8 | 9.3 |" in lines, lines)
    check(len(lines) == 16 and lines[-1] == "0 of 0 findings hold.", lines)

    counts = experiments.cells_of([experiments.Measured(
        {"sequence": "S", "data": "d", "query": "q", "c_l": 40, "recognitions": 3, "distinct": 2},
        {"recognitions": 5}, reason="it has no labels")])
    outcomes = findings.check_all({"kind": "sequence", "findings": [
        {"finding": "F", "place": "table 4", "kind": "zero", "where": {"measure": "recognitions"}},
        {"finding": "G", "place": "table 4", "kind": "zero", "where": {"measure": "distinct"}},
        {"finding": "H", "place": "table 4", "kind": "falls with", "where": {"measure": "recognitions"},
         "over": ["c_l"], "contradicted": "table 4 rises"}]}, [{**counts[0], "c_l": 20}, *counts])
    written = result_of("tab4", counts, outcomes, {})
    tables.write_json(folder / "tab4.json", written)
    tables.write_markdown(folder / "tab4.md", written, "sequence")
    text = (folder / "tab4.md").read_text()
    check("| S | 40 | 5 (3) | not measured (2) |" in text, text)
    check("\nA note.\n\nThe paper's findings:\n" in text, text)
    check(text.endswith("\n- F (table 4): does not hold (ours c_l 20: 5; c_l 40: 5)\n"
                        "- G (table 4): not measured (it has no labels)\n- H (table 4): not counted, "
                        "since table 4 rises; does not hold (ours 5, 5)\n\n"
                        "0 of 1 findings hold, 1 not measured.\n"), text)
    done = subprocess.run([sys.executable, source / "scripts/check_schemas.py",
                           folder / "tab4.json", folder / "tab6.json"])
    if done.returncode != 0:
        sys.exit(done.returncode)  # 77: cannot be checked here


def check_times():
    """A ratio compares the medians of two works, with the extremes of their quartiles; a rate
    belongs to the sum of two."""
    settings = {"frames": 500, "c_l": 20}
    measured = [{"work": work, "parameters": {**settings, "query_frames": 1000},
                 "median_ms": median, "lower_quartile_ms": low, "upper_quartile_ms": high}
                for work, low, median, high in (("openable", 8, 10, 12),
                                                ("fastable-online", 1, 2, 4))]

    def found(**row):
        times = experiments.times_of({"what": "W", **settings, **row}, measured, ["1000 is too large", "no"])
        return times.ours, times.spread, times.reason

    ratio = "openable / fastable-online"
    check(found(our_work=ratio, times=9.2) == ({"times": 5}, {"low": 2, "high": 12}, ""), "ratio")
    check(found(our_work="openable", ms=1) == ({"ms": 10}, {"low": 8, "high": 12}, ""), "time")
    rate = found(our_work="openable + fastable-online", fps="around 5")
    check(rate == ({"fps": 83.33}, {"low": 62.5, "high": 111.1}, ""), rate)
    check(found(our_work=ratio, frames=1000, times=1) == ({}, {}, "1000 is too large"), "no such size")
    check(found(our_work="lsh", ms=1) == ({}, {}, "1000 is too large; no"), "no such work")
    check(found(our_work="openable", ms=1, unmeasured="R") == ({}, {}, "R"), "not measurable")


def check_quick():
    """Quick measurements are short, and omit large databases."""
    omitted = []
    command = experiments.quick_command(
        ["matching", "--databases", "1000,100000", "--c-l", "300", "--seconds", "1"], omitted)
    check(command == ["matching", "--databases", "1000", "--c-l", "300", "--seconds",
                      experiments.QUICK_SECONDS], command)
    check(omitted == ["100000 database frames, because of --quick"], omitted)


def check_counts():
    """Recognitions of a sequence method are judged by their place; without labels there are totals."""
    one_by_one = {"correct": 5, "incorrect": 3, "ignored": 2}
    places = {"correct": 1, "incorrect": 2, "ignored": 0}
    by_place = {"correct": 7, "incorrect": 3, "ignored": 0}
    check(experiments.measures({"pairs": one_by_one, "distinct": 1}) == {
        "recognitions": 10, "correct": 5, "incorrect": 3, "distinct": 1}, "FAB-MAP")
    totals = {"recognitions": 10, "places in total": 3}
    check(experiments.measures({"pairs": one_by_one, "places": places}) == totals, "no labels")
    check(experiments.measures({"pairs": one_by_one, "places": places,
                                "pairs_by_place": by_place}) == {
        **totals, "correct recognitions": 7, "incorrect recognitions": 3, "correct places": 1,
        "incorrect places": 2}, "by place")


def check_experiments():
    """Each experiment has its turn, and common settings quote the same number of the paper (tables take precedence)."""
    names = {path.stem for path in (source / "configs/paper").glob("*.json")}
    check(set(reproduce.ORDER) == names, names ^ set(reproduce.ORDER))
    rows = {name: json.loads((source / f"configs/paper/{name}.json").read_text())["rows"]
            for name in ("tab1", "tab2", "tab4", "figures")}
    of = {}
    for name in ("tab1", "tab2"):
        for row in rows[name]:
            of[row["data"], row["query"], "c_w", row["c_w"], row["t_p"]] = row["distinct"]
    for row in rows["tab4"]:
        of[row["data"], row["query"], "c_l", row["c_l"], row["t_r"]] = row["correct places"]
    compared = 0
    for row in rows["figures"]:
        for column, window, threshold in (("FAB-MAP places", "c_w", "t_p"),
                                          ("OpenABLE places", "c_l", "t_r")):
            key = row["data"], row["query"], window, row[window], row[threshold]
            if key in of:
                compared += 1
                check(row[column] == of[key], f"figures: {key}: {row[column]}, table: {of[key]}")
    check(compared == 5, f"{compared} numbers of figures stand in tables")


check_mistyped_name()
check_times()
check_quick()
check_counts()
check_experiments()
with tempfile.TemporaryDirectory() as out:
    check_files(pathlib.Path(out))
