#!/usr/bin/env python3
"""Runs one experiment of the paper and writes its numbers beside ours.

    reproduce.py EXPERIMENT [--data DIR]

EXPERIMENT is a file in configs/paper without .json. Without --data, the rendered stand-in of each
data set is used (vpr-synth, configs/worlds); with it, DIR/<data set>/dataset.json (data/README.md).
Writes out/EXPERIMENT.json, .csv and .md. What was rendered and trained stays in out/reproduce.
"""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VPR_BIN") or ROOT / "build/release/bin")
WORK = ROOT / "out/reproduce"


def run(program, *arguments):
    """Runs a program of the toolkit; what it prints on stdout is dropped, errors are shown."""
    words = [str(BIN / program), *map(str, arguments)]
    done = subprocess.run(words, stdout=subprocess.DEVNULL)
    if done.returncode != 0:
        sys.exit(done.returncode)


def read(path):
    return json.loads(pathlib.Path(path).read_text())


def is_fresh(target, *sources):
    """Whether a file is there and younger than what it was made from."""
    return target.exists() and all(
        target.stat().st_mtime >= source.stat().st_mtime for source in sources)


class DataSet:
    """The user's recordings, or a rendered stand-in that is made when first needed."""

    def __init__(self, name, folder):
        self.name = name
        self.is_stand_in = folder is None
        if self.is_stand_in:
            world = ROOT / f"configs/worlds/{name}.json"
            target = WORK / name
            self.description = target / "dataset.json"
            if not is_fresh(self.description, world, BIN / "vpr-synth"):
                print(f"rendering {name}", file=sys.stderr)
                run("vpr-synth", world, "-o", target, "--force")
        else:
            self.description = pathlib.Path(folder) / name / "dataset.json"
            if not self.description.exists():
                sys.exit(f"reproduce: {self.description} is missing; data/README.md says what it holds")
        description = read(self.description)
        self.title = description["name"]
        self.has_places = bool(description.get("places") and description.get("pretrain"))

    def train(self, method):
        database = WORK / f"{self.name}{'' if self.is_stand_in else '.data'}.{method}.vprdb"
        options = ["--c-l", 40] if method == "fastable" else []
        if not is_fresh(database / "manifest.json", self.description, BIN / "vpr-train"):
            run("vpr-train", method, "--dataset", self.description, *options, "-o", database,
                "--force")
        return database


class Laboratory:
    """Data sets and databases of one run, each made once."""

    def __init__(self, folder):
        self.folder = folder
        self.data_sets = {}
        self.databases = {}

    def data(self, name):
        if name not in self.data_sets:
            self.data_sets[name] = DataSet(name, self.folder)
        return self.data_sets[name]

    def database(self, name, method):
        if (name, method) not in self.databases:
            self.databases[name, method] = self.data(name).train(method)
        return self.databases[name, method]

    def sweep(self, method, name, query, grids):
        """Cells of a sweep by its two settings, one vpr-tune for all of them."""
        out = WORK / "sweep.json"
        flags = [word for flag, values in grids.items()
                 for word in (flag, ",".join(str(v) for v in sorted(set(values))))]
        run("vpr-tune", method, self.database(name, method), "--dataset",
            self.data(name).description, "--query", query, *flags, "-o", out, "--force", "--quiet")
        keys = ("c_w", "t_p") if method == "fabmap" else ("c_l", "t_r")
        return {tuple(cell[key] for key in keys): cell for cell in read(out)["cells"]}

    def report(self, method, name, query, *settings):
        """The evaluation report of one query."""
        family = "fabmap" if method == "fabmap" else "fastable"
        result, report = WORK / "result.json", WORK / "report.json"
        data = ["--dataset", self.data(name).description]
        run("vpr-query", self.database(name, family), *data, "--query", query, "--method", method,
            *settings, "-o", result, "--force", "--quiet")
        run("vpr-eval", result, *data, "-o", report, "--force", "--quiet")
        return read(report)


def measures(counts):
    """Counts of a cell or report under the names of the paper's columns."""
    found = {"correct": counts["hits"]["correct"], "incorrect": counts["hits"]["incorrect"],
             "correct hits": counts["hits"]["correct"],
             "incorrect hits": counts["hits"]["incorrect"],
             "hits": sum(counts["hits"].values()), "distinct": counts["distinct"]}
    if "places" in counts:
        found["correct places"] = counts["places"]["correct"]
        found["incorrect places"] = counts["places"]["incorrect"]
    return found


def run_grid(experiment, laboratory):
    """FAB-MAP over c_w and t_p, or OpenABLE over c_l and t_r (by FastABLE; the last cell of each
    query also without re-use, which must give the same)."""
    is_fabmap = experiment["kind"] == "fabmap"
    method, keys = ("fabmap", ("c_w", "t_p")) if is_fabmap else ("fastable", ("c_l", "t_r"))
    groups = {}
    for row in experiment["rows"]:
        groups.setdefault((row["data"], row["query"]), []).append(row)
    ours = []
    for (name, query), rows in groups.items():
        grids = {"--" + key.replace("_", "-"): [row[key] for row in rows] for key in keys}
        cells = laboratory.sweep(method, name, query, grids)
        for row in rows:
            counts = cells[tuple(row[key] for key in keys)]["counts"]
            ours.append((row, measures(counts)))
        if not is_fabmap:
            check_openable(laboratory, name, query, rows[-1], counts)
    return ours


def check_openable(laboratory, name, query, row, counts):
    """OpenABLE without any re-use gives the very same counts."""
    report = laboratory.report("openable", name, query, "--c-l", row["c_l"], "--t-r", row["t_r"])
    if report["counts"] != counts:
        sys.exit(f"reproduce: OpenABLE and FastABLE differ on {query}: {report['counts']}, {counts}")
    print(f"{query}: OpenABLE has the same counts at c_l {row['c_l']}, t_r {row['t_r']}",
          file=sys.stderr)


def run_floor(experiment, laboratory):
    """Each row a query of its own."""
    ours = []
    for row in experiment["rows"]:
        if row["method"] == "FAB-MAP" and not laboratory.data(row["data"]).has_places:
            print(f"{row['data']}: no FAB-MAP, its dataset.json names no places and pretraining",
                  file=sys.stderr)
            continue
        if row["method"] == "FAB-MAP":
            report = laboratory.report("fabmap", row["data"], row["query"], "--c-w", row["c_w"],
                                       "--t-p", row["t_p"])
        else:
            report = laboratory.report("fastable", row["data"], row["query"], "--c-l", row["c_l"],
                                       "--t-r", row["t_r"])
        found = measures(report["counts"])
        found["localised per cent"] = localised_per_cent(report)
        ours.append((row, found))
    return ours


def localised_per_cent(report):
    """Share of the query's frames with a correct recognition."""
    return round(100 * report["localisation"]["share"], 1)


def run_maps(experiment, laboratory):
    """FAB-MAP and OpenABLE side by side on the plan, as SVG and PNG in out/figures."""
    ours = []
    for row in experiment["rows"]:
        name, query = row["data"], row["query"]
        found = {}
        for column, method, settings in (
                ("FAB-MAP places", "fabmap", ["--c-w", row["c_w"], "--t-p", row["t_p"]]),
                ("OpenABLE places", "openable", ["--c-l", row["c_l"], "--t-r", row["t_r"]])):
            found[column] = laboratory.report(method, name, query, *settings)["counts"]["distinct"]
            keep_result(WORK / f"map-{method}")
        target = ROOT / "out/figures" / f"{name}-{query}"
        target.parent.mkdir(parents=True, exist_ok=True)
        run("vpr-eval", WORK / "map-fabmap.json", "--dataset", laboratory.data(name).description,
            "--map", target, "--map-with", WORK / "map-openable.json", "--force")
        ours.append((row, found))
    return ours


def keep_result(stem):
    """Moves the last result and its companions aside."""
    for file in WORK.glob("result.*"):
        file.replace(stem.parent / (stem.name + file.name.removeprefix("result")))


def run_bench(experiment, laboratory):
    """Timings: the paper's stand in vpr-bench itself."""
    out = WORK / f"bench-{experiment['command'][0]}.json"
    command = list(experiment["command"])
    if laboratory.folder and command[0] == "nordland":
        nordland = pathlib.Path(laboratory.folder) / "nordland"
        command += ["--train", nordland / "summer", "--query", nordland / "winter"]
    run("vpr-bench", *command, "-o", out, "--force")
    rows = []
    for entry in read(out)["paper"]:
        if entry["table"] != experiment["table"]:
            continue
        row = {"what": entry["what"], **{key: int(v) for key, v in entry["parameters"].items()},
               entry["unit"]: entry["paper"]}
        rows.append((row, {entry["unit"]: float(f"{entry['ours']:.4g}")}))
    return rows


KINDS = {"fabmap": run_grid, "sequence": run_grid, "floor": run_floor, "maps": run_maps,
         "bench": run_bench}


def cells_of(rows):
    """One entry a number: settings, name, the paper's and ours."""
    cells = []
    for row, ours in rows:
        measured = [key for key in row if key in ours]
        settings = {key: value for key, value in row.items() if key not in measured}
        for key in measured:
            cells.append({**settings, "measure": key, "paper": row[key], "ours": ours[key]})
    return cells


def write_markdown(path, title, cells):
    """A row for each setting, a column for each measure: ours (the paper's)."""
    keys = [key for key in dict.fromkeys(key for cell in cells for key in cell)
            if key not in ("measure", "paper", "ours", "data", "query")]
    names = list(dict.fromkeys(cell["measure"] for cell in cells))
    table = {}
    for cell in cells:
        settings = tuple(str(cell.get(key, "")) for key in keys)
        table.setdefault(settings, {})[cell["measure"]] = f"{cell['ours']} ({cell['paper']})"
    lines = [f"# {title}", "", "Ours (the paper's).", "",
             "| " + " | ".join(keys + names) + " |",
             "|" + "---|" * len(keys) + "---:|" * len(names)]
    for settings, values in table.items():
        lines.append("| " + " | ".join([*settings, *(values.get(n, "") for n in names)]) + " |")
    path.write_text("\n".join(lines) + "\n")


def write_csv(path, cells):
    keys = list(dict.fromkeys(key for cell in cells for key in cell))
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, keys, lineterminator="\n")
        writer.writeheader()
        writer.writerows(cells)


def main():
    names = sorted(path.stem for path in (ROOT / "configs/paper").glob("*.json"))
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiment", choices=names)
    parser.add_argument("--data", help="folder with your own copy of the recordings")
    arguments = parser.parse_args()
    experiment = read(ROOT / f"configs/paper/{arguments.experiment}.json")
    WORK.mkdir(parents=True, exist_ok=True)
    laboratory = Laboratory(arguments.data)
    cells = cells_of(KINDS[experiment["kind"]](experiment, laboratory))
    data = sorted(data.title for data in laboratory.data_sets.values())
    if experiment["kind"] == "bench":
        real = arguments.data and experiment["command"][0] == "nordland"
        data = ["Nordland"] if real else ["generated codes, a stand-in"]
    title = f"{experiment['title']}: {', '.join(data)}"
    out = ROOT / "out" / arguments.experiment
    out.with_suffix(".json").write_text(json.dumps(
        {"title": title, "paper": experiment["paper"], "data": data, "cells": cells}, indent=1) + "\n")
    write_csv(out.with_suffix(".csv"), cells)
    write_markdown(out.with_suffix(".md"), title, cells)
    print(out.with_suffix(".md").read_text())


if __name__ == "__main__":
    main()
