#!/usr/bin/env python3
"""Runs experiments of the paper and writes the paper's numbers next to ours.

    reproduce.py EXPERIMENT|all [--seeds N] [--data DIR] [--quick] [--again] [--out DIR] [--page FILE]

EXPERIMENT is a file in scripts/reproduce/paper without .json. Without --data, the rendered stand-in of each
data set is used (vpr-synth, configs/worlds). Writes out/EXPERIMENT.json
(docs/schemas/reproduction.schema.json), .csv and .md, which end with the paper's findings and whether
they hold; figures are in out/figures. Rendered and trained data stay in out/reproduce. Builds the
programs into build/release, or uses those in the folder $VPR_BIN.

With --seeds, experiments on stand-ins run on N renderings of their buildings, in the folders out, out/seed-1,
out/seed-2, ..., two at a time. out/EXPERIMENT-seeds.json counts the seeds in which each finding holds, and
out/figures/EXPERIMENT-seeds.svg shows the paper's numbers and ours.

An experiment is not repeated if its output has the same programs, settings and data. After a failure,
`all` continues with the next experiment and ends with exit code 1.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time
import traceback
from concurrent.futures import ThreadPoolExecutor

import experiments
import findings
import seeds
from laboratory import ACTIVITY, BIN, INTERRUPTED, PROGRAMS, ROOT, Failure, Laboratory, data_state, read, say, sha256
from tables import write_csv, write_json, write_markdown

RECORD_SEEDS, QUICK_SEEDS = 8, 2  # of a page
PARALLEL_SEEDS = 2
QUICK_REASON = ("With --quick, images are 160x120 pixels, in which FAB-MAP finds few features: its findings mean "
                "nothing. Places of OpenABLE differ by up to 2 from those of full images.")
ORDER = ("tab1", "tab2", "tab3", "tab4", "floor1", "figures", "tab5", "tab6", "tab7", "times")


def arguments_of(words):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiment", choices=(*ORDER, "all"))
    parser.add_argument("--data", type=pathlib.Path, metavar="DIR", help=(
        "folder with your own copy of the recordings, as DIR/put-mc/dataset.json "
        "(scripts/reproduce/README.md)"))
    parser.add_argument("--quick", action="store_true", help=(
        "try the scripts in minutes: small images or two thirds of the recorded frames, short "
        "measurements. The numbers do not describe the paper. Writes into out/quick"))
    parser.add_argument("--seeds", type=int, metavar="N", help=(
        f"renderings of each stand-in (default: 1; with --page {RECORD_SEEDS}, or {QUICK_SEEDS} with --quick)"))
    parser.add_argument("--again", action="store_true", help="repeat finished experiments")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out", metavar="DIR",
                        help="folder of outputs (default: out)")
    parser.add_argument("--page", type=pathlib.Path, metavar="FILE", help=(
        "with all: write the findings into this page, as docs/benchmarks/reproduction.md, or into a "
        "new one"))
    arguments = parser.parse_args(words)
    if arguments.page and arguments.experiment != "all":
        parser.error("--page needs all")
    if arguments.seeds is None:
        arguments.seeds = 1
        if arguments.page and not arguments.data:
            arguments.seeds = QUICK_SEEDS if arguments.quick else RECORD_SEEDS
    if arguments.seeds < 1:
        parser.error("--seeds must be at least 1")
    if arguments.data and arguments.seeds > 1:
        parser.error("--seeds needs stand-ins, so it excludes --data")
    return arguments


def programs_of(experiment):
    return ("vpr-bench",) if experiment["kind"] == "bench" else PROGRAMS


def build(programs):
    """Builds the programs, unless VPR_BIN names a folder that has them."""
    if not os.environ.get("VPR_BIN"):
        say(f"building {' '.join(programs)} into build/release (VPR_BIN=DIR uses existing programs)")
        for command in ([ROOT / "scripts/install-deps.sh"], ["cmake", "--preset", "release"],
                        ["cmake", "--build", "--preset", "release", "--target", *programs]):
            if code := subprocess.run(command, cwd=ROOT, stdout=sys.stderr).returncode:
                sys.exit(code)
    for program in programs:
        if not (BIN / program).exists():
            sys.exit(f"reproduce: {BIN / program} is missing; build it with cmake --build --preset "
                     f"release --target {program}, or name the programs' folder in VPR_BIN")


class Reproduction:
    """Experiments with one choice of data, and their outputs. `seed` is added to the seed of each world."""

    def __init__(self, arguments, seed=0):
        self.seed = seed
        self.data = arguments.data
        self.is_quick = arguments.quick
        self.again = arguments.again
        self.out = arguments.out / "quick" if arguments.quick else arguments.out
        if seed:
            self.out = self.out / f"seed-{seed}"

    def config(self, name):
        return {**read(ROOT / f"scripts/reproduce/paper/{name}.json"), "name": name}

    def inputs(self, experiment):
        """Checksum of everything that determines the numbers: programs, scripts, settings, data."""
        data = {row["data"] for row in experiment["rows"] if "data" in row}
        if experiment["kind"] == "bench" and self.data:
            data = {"nordland"}
        scripts = [ROOT / f"scripts/reproduce/{name}.py" for name in ("along_path", "experiments", "laboratory")]
        settings = {key: experiment[key] for key in ("kind", "rows", "commands") if key in experiment}
        return sha256(json.dumps([
            self.is_quick, self.seed, settings, [data_state(name, self.data) for name in sorted(data)],
            [sha256(path.read_bytes())
             for path in [*scripts, *(BIN / program for program in programs_of(experiment))]]]))

    def stored(self, name):
        """The output of an earlier run; None if there is none, or it is of an older version."""
        path = self.out / f"{name}.json"
        content = read(path) if path.exists() else {}
        return content if "timing" in content else None

    def expected_s(self, name):
        """The duration of the last run, or one on two cores."""
        stored = self.stored(name)
        return (stored["timing"]["elapsed_s"] if stored else
                self.config(name)["typical_s"]["quick" if self.is_quick else "full"])

    def is_finished(self, name):
        stored = self.stored(name)
        return bool(stored and not self.again
                    and stored["provenance"]["inputs_sha256"] == self.inputs(self.config(name)))

    def run(self, name):
        """Runs an experiment unless it is finished, and writes its outputs."""
        experiment = self.config(name)
        if self.is_finished(name):
            say(f"{name}: not repeated, {self.out / name}.json has the same programs, settings and "
                "data (--again repeats it)")
            result = self.stored(name)
            result["findings"] = findings.check_all(experiment, result["cells"], not self.data)
            result["summary"] = findings.summary(result["findings"])
        else:
            result = self.measure(name, experiment)
        out = self.out / name
        write_json(out.with_suffix(".json"), result)
        write_csv(out.with_suffix(".csv"), result["cells"])
        write_markdown(out.with_suffix(".md"), result, experiment["kind"])
        return result

    def measure(self, name, experiment):
        start = time.monotonic()
        inputs = self.inputs(experiment)
        laboratory = Laboratory(self.out, self.data, self.is_quick, self.seed)
        rows = experiments.KINDS[experiment["kind"]](experiment, laboratory)
        cells = experiments.cells_of(rows)
        data = sorted(data.title for data in laboratory.data_sets.values())
        if experiment["kind"] == "bench":
            real = self.data and experiments.is_nordland(experiment["commands"][0])
            data = ["Nordland"] if real else ["generated codes, a stand-in"]
        outcomes = findings.check_all(experiment, cells, not self.data)
        quick = " (quick: not the paper's sizes)" if self.is_quick else ""
        return {"schema": "vpr.reproduction/3", "experiment": name,
                "title": f"{experiment['title']}{quick}: {', '.join(data)}",
                "paper": experiment["paper"], "data": data, "quick": self.is_quick, "cells": cells,
                "findings": outcomes, "summary": findings.summary(outcomes),
                "notes": [*experiment.get("notes", []), *laboratory.notes],
                "provenance": laboratory.provenance(inputs),
                **({"machine": laboratory.machine} if laboratory.machine else {}),
                "timing": {"elapsed_s": round(time.monotonic() - start, 1)}}

    def run_all(self, names):
        """The results by name, and what stopped the other experiments."""
        results, failures = {}, {}
        left_s = {name: self.expected_s(name) for name in names if not self.is_finished(name)}
        for index, name in enumerate(names, 1):
            if name in left_s:
                say(f"{name}, {index} of {len(names)}: about {minutes(left_s[name])}; "
                    f"all: about {minutes(sum(left_s.values()))} left")
            try:
                results[name] = self.run(name)
                say(f"{name}: {findings.lines(results[name]['findings'])[-1]}")
            except Failure as failure:
                if failure.code == INTERRUPTED:
                    raise
                failures[name] = failure
            except Exception as error:  # a mistake in the scripts must not cost the other experiments
                traceback.print_exc()
                failures[name] = Failure(f"{type(error).__name__}: {error}")
            if name in failures:
                say(f"{name} failed: {failures[name]}")
            left_s.pop(name, None)
        return results, failures


def run_seeds(arguments, names):
    """The records of experiments over all seeds, by name, the results of the first seed, and failures. Times do
    not depend on the seed, so they are measured once, alone."""
    made = [Reproduction(arguments, seed) for seed in range(arguments.seeds)]
    rendered = [name for name in names if made[0].config(name)["kind"] != "bench"]

    def run_seed(reproduction):
        ACTIVITY.label = f"seed {reproduction.seed + 1} of {arguments.seeds}: " if arguments.seeds > 1 else ""
        return reproduction.run_all(rendered)

    with ThreadPoolExecutor(min(PARALLEL_SEEDS, arguments.seeds)) as pool:
        outcomes = list(pool.map(run_seed, made))
    results, failures = outcomes[0]
    for name, failure in (item for _, failed in outcomes[1:] for item in failed.items()):
        failures.setdefault(name, failure)
    timed, failed = made[0].run_all([name for name in names if name not in rendered])
    records = {}
    for name in rendered:
        of_seeds = {seed: found[name] for seed, (found, _) in enumerate(outcomes) if name in found}
        if of_seeds:
            records[name] = seeds.combine(made[0].config(name), list(of_seeds.values()), list(of_seeds))
            if arguments.seeds > 1:
                write_record(made[0].out, name, records[name])
    return records, {**results, **timed}, {**failures, **failed}


def write_record(out, name, record):
    write_json(out / f"{name}-seeds.json", record)
    (out / f"{name}-seeds.md").write_text("\n".join(seeds.table(record)) + "\n")
    (out / f"figures/{name}-seeds.svg").write_text(seeds.figure(record))


def minutes(seconds):
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def context_of(results):
    """The programs, machine and data of a page."""
    made = [made for result in results for made in findings.as_list(result["provenance"])]
    taken = minutes(sum(result["timing"]["elapsed_s"] for result in results))
    commits = ", ".join(sorted({one["commit"] for one in made}))
    sizes = f" {QUICK_REASON}" if any(result["quick"] for result in results) else ""
    used = {data["title"] for one in made for data in one["data"] if not data["stand_in"]}
    data = "; ".join(sorted(used)) or "Rendered stand-ins and generated codes"
    return (f"{data}, commit {commits}. All programs together took {taken} on "
            f"{len(os.sched_getaffinity(0))} cores.{sizes}")


def main():
    arguments = arguments_of(sys.argv[1:])
    reproduction = Reproduction(arguments)
    names = ORDER if arguments.experiment == "all" else (arguments.experiment,)
    build(sorted({program for name in names for program in programs_of(reproduction.config(name))}))
    records, results, failures = run_seeds(arguments, names)
    if arguments.experiment != "all":
        for failure in failures.values():
            print(f"reproduce: {failure}", file=sys.stderr)
            sys.exit(failure.code)
        suffix = "-seeds" if arguments.seeds > 1 and records else ""
        print((reproduction.out / f"{arguments.experiment}{suffix}.md").read_text())
        return
    times = [result for name, result in results.items() if name not in records]
    print("\n".join(findings.summary_table([outcome for result in (*records.values(), *times)
                                            for outcome in result["findings"]])))
    print(f"\nTables: {reproduction.out}/*.md, figures: {reproduction.out}/figures")
    if arguments.quick:
        print(f"\n{QUICK_REASON} Findings that do not hold at these sizes:\n")
        print("\n".join(findings.failing_lines(results.values())))
    if arguments.page:
        write_page(arguments.page, list(records.values()), times)
    for name, failure in failures.items():
        print(f"Failed: {name}: {failure}")
    if failures:
        sys.exit(1)


def write_page(page, records, times):
    """Writes the blocks of a page that have results, and a figure per table next to it."""
    blocks = {}
    if records:
        outcomes = [outcome for record in records for outcome in record["findings"]]
        lines = [context_of(records), "", *findings.summary_table(outcomes, ("recognition",))]
        for record in records:
            figure = page.with_name(f"{page.stem}-{record['experiment']}.svg")
            figure.write_text(seeds.figure(record))
            lines += ["", *seeds.table(record), "", f"![Numbers of the paper (lines) and of each seed (points)]({figure.name})"]
        blocks["recognition"] = lines
    if times:
        blocks["time"] = [context_of(times), "", *findings.times_block(times)]
    findings.write_page(page, blocks)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:  # the programs received the signal as well
        sys.exit(INTERRUPTED)
