#!/usr/bin/env python3
"""Runs one experiment of the paper and writes the paper's numbers next to ours.

    reproduce.py EXPERIMENT [--data DIR]

EXPERIMENT is a file in configs/paper without .json. Without --data, the rendered stand-in of each
data set is used (vpr-synth, configs/worlds); with it, DIR/<data set>/dataset.json
(docs/benchmarks/datasets.md). Writes out/EXPERIMENT.json (docs/schemas/reproduction.schema.json),
.csv and .md, which end with the paper's findings and whether they hold. Rendered and trained data
stay in out/reproduce. Uses the programs in build/release/bin, or in the folder $VPR_BIN.
"""
import argparse
import pathlib
import sys

import findings
from laboratory import ROOT, WORK, Laboratory, read, run, say
from tables import cells_of, write_csv, write_json, write_markdown

PARAMETERS = ("frames", "c_l", "query_frames", "places")  # of measurements by vpr-bench


def measures(counts):
    """Counts of a cell or report, with the names of the paper's columns."""
    found = {"correct": counts["recognitions"]["correct"], "incorrect": counts["recognitions"]["incorrect"],
             "correct recognitions": counts["recognitions"]["correct"],
             "incorrect recognitions": counts["recognitions"]["incorrect"],
             "recognitions": sum(counts["recognitions"][key] for key in ("correct", "incorrect", "ignored")), "distinct": counts["recognitions"]["distinct"]}
    if "places" in counts:
        found["correct places"] = counts["places"]["correct"]
        found["incorrect places"] = counts["places"]["incorrect"]
    return found


def run_grid(experiment, laboratory):
    """FAB-MAP over c_w and t_p, or OpenABLE over c_l and t_r (computed by FastABLE; the last
    cell of each query also without reuse, which must be equal)."""
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
    """Checks that OpenABLE without reuse has the same counts."""
    report = laboratory.report("openable", name, query, "--c-l", row["c_l"], "--t-r", row["t_r"])
    if report["counts"] != counts:
        sys.exit(f"reproduce: OpenABLE and FastABLE differ on {query}: "
                 f"{report['counts']}, {counts}")
    say(f"{query}: OpenABLE has the same counts at c_l {row['c_l']}, t_r {row['t_r']}")


def run_floor(experiment, laboratory):
    """A separate query per row."""
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
        found["localized per cent"] = localized_per_cent(report)
        ours.append((row, found))
    return ours


def localized_per_cent(report):
    """Share of the query's frames with a correct recognition."""
    return round(100 * report["localization"]["share"], 1)


def run_maps(experiment, laboratory):
    """Draws FAB-MAP and OpenABLE on the plan, as SVG and PNG in out/figures."""
    ours = []
    for row in experiment["rows"]:
        name, query = row["data"], row["query"]
        found = {}
        for title, method, settings, wrong in (
                ("FAB-MAP", "fabmap", ["--c-w", row["c_w"], "--t-p", row["t_p"]], "incorrect"),
                ("OpenABLE", "openable", ["--c-l", row["c_l"], "--t-r", row["t_r"]],
                 "incorrect places")):
            report = laboratory.report(method, name, query, *settings)
            counts = measures(report["counts"])
            found[f"{title} places"] = counts["recognitions"]["distinct"]
            found[f"{title} {wrong}"] = counts[wrong]
            found[f"{title} per cent of path"] = localized_per_cent(report)
            keep_result(WORK / f"map-{method}")
        target = ROOT / "out/figures" / f"{name}-{query}"
        target.parent.mkdir(parents=True, exist_ok=True)
        run(f"draw {target.name}", "vpr-eval", WORK / "map-fabmap.json", "--dataset",
            laboratory.data(name).description, "--map", target,
            "--map-with", WORK / "map-openable.json", "--force")
        ours.append((row, found))
    return ours


def keep_result(stem):
    """Renames the last result and its companions."""
    for file in WORK.glob("result.*"):
        file.replace(stem.parent / (stem.name + file.name.removeprefix("result")))


def run_bench(experiment, laboratory):
    """Timings by vpr-bench: the time of one work, or the ratio of two."""
    measured = []
    figures = ROOT / "out/figures"
    figures.mkdir(parents=True, exist_ok=True)
    for index, command in enumerate(experiment["commands"]):
        stem = f"{experiment['name']}-{index + 1}"
        out = WORK / f"bench-{stem}.json"
        data = nordland_data(laboratory.folder) if is_nordland(command) else []
        run(f"measure {' '.join(command)}", "vpr-bench", *command, *data, "--plot",
            figures / stem, "-o", out, "--force")
        bench = laboratory.written(out)
        laboratory.machine = {key: bench["machine"][key] for key in ("host", "threads", "simd")}
        measured += bench["rows"]
    rows = ((row, times_of(row, measured)) for row in experiment["rows"])
    return [(row, *found) for row, found in rows if found]


def is_nordland(command):
    """Whether a command measures the paper's Nordland tables, which have c_l 300."""
    return "--c-l" in command and command[command.index("--c-l") + 1] == "300"


def nordland_data(folder):
    """Real frames instead of generated codes, if the user has them."""
    if not folder:
        return []
    nordland = pathlib.Path(folder) / "nordland"
    return ["--train", nordland / "summer", "--query", nordland / "winter"]


def times_of(row, measured):
    """Our time or ratio for a number of the paper, with its quartiles; for a ratio the smallest and the
    largest of both. None if a work was not measured."""
    works = row["our_work"].split(" / ")  # "slow / fast" for a ratio
    found = [bench for work in works for bench in measured if bench["work"] == work
             and all(bench["parameters"].get(key) == row[key] for key in PARAMETERS if key in row)]
    if len(found) < len(works):
        return None
    slow, fast = found[0], found[-1]
    median, low, high = slow["median_ms"], slow["lower_quartile_ms"], slow["upper_quartile_ms"]
    if "ms" in row:
        return {"ms": rounded(median)}, {"low": rounded(low), "high": rounded(high)}
    return ({"times": rounded(median / fast["median_ms"])},
            {"low": rounded(low / fast["upper_quartile_ms"]),
             "high": rounded(high / fast["lower_quartile_ms"])})


def rounded(value):
    """Rounds to four digits."""
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
    experiment["name"] = arguments.experiment
    WORK.mkdir(parents=True, exist_ok=True)
    laboratory = Laboratory(arguments.data)
    cells = cells_of(KINDS[experiment["kind"]](experiment, laboratory))
    data = sorted(data.title for data in laboratory.data_sets.values())
    if experiment["kind"] == "bench":
        real = arguments.data and is_nordland(experiment["commands"][0])
        data = ["Nordland"] if real else ["generated codes, a stand-in"]
    title = f"{experiment['title']}: {', '.join(data)}"
    out = ROOT / "out" / arguments.experiment
    outcomes = findings.check_all(experiment["findings"], cells)
    write_json(out.with_suffix(".json"), experiment, title, data, cells, outcomes,
               laboratory.provenance(), laboratory.machine)
    write_csv(out.with_suffix(".csv"), cells)
    write_markdown(out.with_suffix(".md"), title, experiment["kind"], cells,
                   experiment.get("notes", []), outcomes)
    print(out.with_suffix(".md").read_text())


if __name__ == "__main__":
    main()
