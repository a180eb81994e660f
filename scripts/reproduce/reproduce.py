#!/usr/bin/env python3
"""Runs one experiment of the paper and writes its numbers beside ours.

    reproduce.py EXPERIMENT [--data DIR]

EXPERIMENT is a file in configs/paper without .json. Without --data, the rendered stand-in of each
data set is used (vpr-synth, configs/worlds); with it, DIR/<data set>/dataset.json (data/README.md).
Writes out/EXPERIMENT.json (docs/reproduction.schema.json), .csv and .md. What was rendered and
trained stays in out/reproduce. The programs are those of build/release/bin, or of the folder that
the environment's VPR_BIN names.
"""
import argparse
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import time

from tables import cells_of, write_csv, write_json, write_markdown

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VPR_BIN") or ROOT / "build/release/bin")
WORK = ROOT / "out/reproduce"
SIGN_OF_LIFE_S = 30


def say(sentence):
    print(f"[{time.strftime('%H:%M:%S')}] {sentence}", file=sys.stderr, flush=True)


def run(what, program, *arguments):
    """Runs a program of the toolkit, and says what it does, how long it has been at it, and how long
    it took; what it prints on stdout is dropped, errors are shown."""
    if not (BIN / program).exists():
        sys.exit(f"reproduce: {BIN / program} is missing; build it with cmake --build --preset "
                 f"release --target {program}, or name the programs' folder in VPR_BIN")
    say(what)
    start = time.monotonic()
    child = subprocess.Popen([str(BIN / program), *map(str, arguments)], stdout=subprocess.DEVNULL)
    while True:
        try:
            code = child.wait(timeout=SIGN_OF_LIFE_S)
            break
        except subprocess.TimeoutExpired:
            if not sys.stderr.isatty():  # where there is no progress bar
                say(f"{what}: for {time.monotonic() - start:.0f} s")
        except KeyboardInterrupt:  # the program got the signal, too
            child.wait()
            sys.exit(130)
    if code != 0:
        sys.exit(code)
    if time.monotonic() - start > SIGN_OF_LIFE_S:
        say(f"{what}: done after {time.monotonic() - start:.0f} s")


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
                run(f"render the stand-in {name}", "vpr-synth", world, "-o", target, "--force")
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
            run(f"train {method} on {self.name}", "vpr-train", method, "--dataset", self.description, *options, "-o", database,
                "--force")
        return database


class Laboratory:
    """Data sets and databases of one run, each made once."""

    def __init__(self, folder):
        self.folder = folder
        self.data_sets = {}
        self.databases = {}
        self.machine = None  # that times were measured on
        self.makers = []  # program, version, commit and seed behind the numbers

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
        run(f"sweep {method} on {name}, query {query}", "vpr-tune", method,
            self.database(name, method), "--dataset", self.data(name).description, "--query", query,
            *flags, "-o", out, "--force", "--quiet")
        keys = ("c_w", "t_p") if method == "fabmap" else ("c_l", "t_r")
        return {tuple(cell[key] for key in keys): cell for cell in self.written(out)["cells"]}

    def report(self, method, name, query, *settings):
        """The evaluation report of one query."""
        family = "fabmap" if method == "fabmap" else "fastable"
        result, report = WORK / "result.json", WORK / "report.json"
        data = ["--dataset", self.data(name).description]
        words = " ".join(map(str, settings))
        run(f"query {name} with {query}: {method} {words}", "vpr-query",
            self.database(name, family), *data, "--query", query, "--method", method, *settings,
            "-o", result, "--force", "--quiet")
        run(f"evaluate {query}", "vpr-eval", result, *data, "-o", report, "--force", "--quiet")
        return self.written(report)

    def written(self, path):
        """A file that a program wrote, whose makers are remembered."""
        content = read(path)
        made_by = content["provenance"]
        maker = {key: made_by[key] for key in ("program", "version", "commit", "seed")}
        if maker not in self.makers:
            self.makers.append(maker)
        return content

    def provenance(self):
        """What made the numbers, from which data; without paths and times."""
        return {
            "program": "reproduce.py",
            "version": self.makers[0]["version"],
            "commit": self.makers[0]["commit"],
            "seed": self.makers[0]["seed"],
            "programs": self.makers,
            "data": [{"name": data.name, "title": data.title, "stand_in": data.is_stand_in,
                      "dataset_sha256": hashlib.sha256(data.description.read_bytes()).hexdigest()}
                     for _, data in sorted(self.data_sets.items())],
            "databases": {f"{name}.{method}": read(path / "manifest.json")["checksum"]
                          for (name, method), path in sorted(self.databases.items())}}


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
    say(f"{query}: OpenABLE has the same counts at c_l {row['c_l']}, t_r {row['t_r']}")


def run_floor(experiment, laboratory):
    """Each row a query of its own."""
    ours = []
    for row in experiment["rows"]:
        if row["method"] == "FAB-MAP" and not laboratory.data(row["data"]).has_places:
            say(f"{row['data']}: no FAB-MAP, its dataset.json names no places and pretraining")
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
        for title, method, settings, wrong in (
                ("FAB-MAP", "fabmap", ["--c-w", row["c_w"], "--t-p", row["t_p"]], "incorrect"),
                ("OpenABLE", "openable", ["--c-l", row["c_l"], "--t-r", row["t_r"]],
                 "incorrect places")):
            counts = measures(laboratory.report(method, name, query, *settings)["counts"])
            found[f"{title} places"] = counts["distinct"]
            found[f"{title} {wrong}"] = counts[wrong]
            keep_result(WORK / f"map-{method}")
        target = ROOT / "out/figures" / f"{name}-{query}"
        target.parent.mkdir(parents=True, exist_ok=True)
        run(f"draw {target.name}", "vpr-eval", WORK / "map-fabmap.json", "--dataset", laboratory.data(name).description,
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
    run(f"measure {' '.join(map(str, command))}", "vpr-bench", *command, "-o", out, "--force")
    measured = laboratory.written(out)
    laboratory.machine = {key: measured["machine"][key] for key in ("host", "threads", "simd")}
    rows = []
    for entry in measured["paper"]:
        if entry["table"] != experiment["table"]:
            continue
        row = {"what": entry["what"], "our_work": entry["our_work"],
               **{key: int(v) for key, v in entry["parameters"].items()},
               entry["unit"]: entry["paper"]}
        rows.append((row, {entry["unit"]: rounded(entry["ours"])},
                     {"low": rounded(entry["low"]), "high": rounded(entry["high"])}))
    return rows


def rounded(value):
    """To four digits."""
    return float(f"{value:.4g}")


KINDS = {"fabmap": run_grid, "sequence": run_grid, "floor": run_floor, "maps": run_maps,
         "bench": run_bench}


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
    write_json(out.with_suffix(".json"), experiment, title, data, cells, laboratory.provenance(),
               laboratory.machine)
    write_csv(out.with_suffix(".csv"), cells)
    write_markdown(out.with_suffix(".md"), title, experiment["kind"], cells,
                   experiment.get("notes", []))
    print(out.with_suffix(".md").read_text())


if __name__ == "__main__":
    main()
