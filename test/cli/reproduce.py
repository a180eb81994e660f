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


def check_files(folder):
    """JSON fits its schema, and times keep their quartiles and the paper's grid."""
    times = tables.cells_of(
        [({"what": f"FastABLE over OpenABLE, {phone}", "our_work": "fastable", "frames": frames,
           "c_l": 20, "times": paper}, {"times": 12.5}, {"low": 11.0, "high": 14.0})
         for phone, papers in (("A", (11.4, 9.8)), ("B", (15.3, 11.0)))
         for frames, paper in zip((500, 1000), papers)])
    tables.write_markdown(folder / "tab6.md", "Table 6", "bench", times, [], [])
    lines = (folder / "tab6.md").read_text().splitlines()
    check("| c_l | whose | 500 | 1000 |" in lines, lines)
    check("| 20 | ours: fastable | 12.5 (11 to 14) | 12.5 (11 to 14) |" in lines, lines)
    check("| 20 | paper: FastABLE over OpenABLE, A | 11.4 | 9.8 |" in lines, lines)
    check(len(lines) == 14 and lines[-1] == "0 of 0 findings hold.", lines)

    counts = tables.cells_of([({"sequence": "S", "data": "d", "query": "q", "c_l": 40, "recognitions": 3},
                               {"recognitions": 5})])
    outcomes = findings.check_all(
        [{"finding": "F", "place": "table 4", "kind": "zero", "where": {"measure": "recognitions"}},
         {"finding": "G", "place": "table 4", "kind": "zero", "where": {"measure": "places"}},
         {"finding": "H", "place": "table 4", "kind": "falls with", "where": {"measure": "recognitions"},
          "over": ["c_l"], "contradicted": "table 4 rises"}],
        [{**counts[0], "c_l": 20}, *counts])
    tables.write_markdown(folder / "tab4.md", "Table 4", "sequence", counts, ["A note."], outcomes)
    text = (folder / "tab4.md").read_text()
    check("| S | 40 | 5 (3) |" in text and "\nA note.\n\nThe paper's findings:\n" in text, text)
    check(text.endswith("\n- F (table 4): does not hold (ours c_l 20: 5; c_l 40: 5)\n"
                        "- G (table 4): not measured\n- H (table 4): not counted, since table 4 "
                        "rises; does not hold (ours 5, 5)\n\n0 of 1 findings hold.\n"), text)

    maker = {"program": "vpr-tune", "version": "0.1.0", "commit": "unknown", "seed": 1}
    provenance = {**maker, "program": "reproduce.py", "programs": [maker],
                  "data": [{"name": "d", "title": "D", "stand_in": True, "dataset_sha256": "0" * 64}],
                  "databases": {"d.fastable": "xxh3:" + "0" * 32}}
    machine = {"host": "h", "threads": 1, "simd": "AVX2"}
    tables.write_json(folder / "tab4.json", {"paper": "P"}, "T", ["D"], counts, outcomes,
                      provenance, None)
    tables.write_json(folder / "tab6.json", {"paper": "P"}, "T", ["D"], times, [], provenance,
                      machine)
    summary = json.loads((folder / "tab4.json").read_text())["summary"]
    check(summary == {"hold": 0, "of": 1}, summary)
    done = subprocess.run([sys.executable, source / "scripts/check_schemas.py",
                           folder / "tab4.json", folder / "tab6.json"])
    if done.returncode != 0:
        sys.exit(done.returncode)  # 77: cannot be checked here


def check_ratio():
    """A ratio compares the medians of two works, with the extremes of their quartiles."""
    settings = {"frames": 500, "c_l": 20}
    measured = [{"work": work, "parameters": {**settings, "query_frames": 1000},
                 "median_ms": median, "lower_quartile_ms": low, "upper_quartile_ms": high}
                for work, low, median, high in (("openable", 8, 10, 12),
                                                ("fastable-online", 1, 2, 4))]
    row = {"what": "W", "our_work": "openable / fastable-online", **settings, "times": 9.2}
    found = reproduce.times_of(row, measured)
    check(found == ({"times": 5}, {"low": 2, "high": 12}), found)
    found = reproduce.times_of({"what": "W", "our_work": "openable", **settings, "ms": 1}, measured)
    check(found == ({"ms": 10}, {"low": 8, "high": 12}), found)
    check(reproduce.times_of({**row, "frames": 1000}, measured) is None, "1000 frames")


def check_experiments():
    """Common settings of experiments quote the same number of the paper (tables take precedence)."""
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
check_ratio()
check_experiments()
with tempfile.TemporaryDirectory() as out:
    check_files(pathlib.Path(out))
