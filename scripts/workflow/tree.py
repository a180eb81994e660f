"""The jobs defined by experiments.yaml, with their inputs and commands.

Jobs are identified by their kind and an id, the middle of their output's path: see Snakefile. Paths
of outputs are relative to the folder in which Snakemake was started.
"""
import dataclasses
import itertools
import json
import os
import pathlib
import shlex
import sys

import jsonschema
import yaml

from sources import Mistake, identifier, open_data_set, stamp, write_if_new

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SCHEMA = ROOT / "docs/schemas/experiments.schema.json"


@dataclasses.dataclass
class Job:
    inputs: list
    command: str


@dataclasses.dataclass
class Run:
    """A query with one method in one cell of its grids."""
    method: str
    id: str
    name: str  # in tables and comparisons


def words(*parts):
    return " ".join(shlex.quote(str(part)) for part in parts)


def flags(settings):
    """Settings as flags: a switch for true, nothing for false, list values separated by commas."""
    found = []
    for key, value in settings.items():
        flag = "--" + key.replace("_", "-")
        if isinstance(value, bool):
            found += [flag] if value else []
        else:
            values = value if isinstance(value, list) else [value]
            found.append(f"{flag}={','.join(map(str, values))}")
    return found


def filled(template, values):
    """A user's template with {name} replaced; other braces do not change."""
    if "{data}" in template and values["data"] is None:
        raise Mistake(f"\"{template}\" needs --config data=DIR")
    for name, value in values.items():
        template = template.replace("{" + name + "}", str(value))
    return template


def chosen(names, known, what):
    """The selected names, all by default; an unknown name is an error."""
    for name in names or []:
        if name not in known:
            raise Mistake(f"{what}: unknown name \"{name}\"; choose from {', '.join(map(str, known))}")
    return list(names or known)


class Tree:
    def __init__(self, content, folder, data, out):
        self.content, self.out, self.data = content, pathlib.Path(out), data
        self.threads = content.get("threads", 1)
        self.memory_mb = content.get("memory_mb", 4000)
        self.seeds = content.get("seeds", [1])
        self.jobs = {}
        self.sections = []  # of the page, one for each query
        self.left_out = []
        for name, row in content["data"].items():
            data_set = open_data_set(name, row, folder, data, self.out)
            if data_set is None:
                self.left_out.append(name)
            else:
                self.add_data_set(name, row, data_set)
        if not self.sections:
            raise Mistake("no data set is left: pass --config data=DIR")
        self.check_comparisons()
        write_if_new(self.out / "inputs/tree.json", json.dumps(
            {"title": content.get("title", "Experiments"), "left_out": self.left_out,
             "sections": self.sections}, indent=1))

    def path(self, kind, job):
        """The output of a job, as in the rules of Snakefile."""
        return {"data": f"{self.out}/data/{job}", "databases": f"{self.out}/databases/{job}.vprdb",
                "results": f"{self.out}/results/{job}/result.json",
                "reports": f"{self.out}/results/{job}/report.json",
                "sweeps": f"{self.out}/sweeps/{job}.json",
                "comparisons": f"{self.out}/comparisons/{job}.json"}[kind]

    def add(self, kind, job, inputs, command):
        self.jobs[kind, job] = Job(inputs, command)
        return self.path(kind, job)

    def common(self, seed, output):
        return ["--seed", seed, "--threads", self.threads, "-o", output, "--force", "--quiet"]

    def add_data_set(self, name, row, data_set):
        if hasattr(data_set, "world"):
            self.add("data", name, [data_set.world], words(
                "vpr-synth", data_set.world, "-o", data_set.folder, "--force", "--quiet"))
        descriptors = chosen(row.get("descriptors"), self.content["descriptors"], f"data {name}")
        queries = chosen(row.get("queries"), data_set.queries, f"data {name}")
        databases = {(descriptor, seed): self.add_database(name, data_set, descriptor, seed)
                     for descriptor in descriptors for seed in self.seeds
                     if seed == self.seeds[0] or self.is_random(descriptor)}
        for query in queries:
            section = {"data": data_set.title, "query": query, "runs": [], "sweeps": [],
                       "comparisons": []}
            runs = [run for method in self.content["methods"] for run in
                    self.add_method(name, data_set, query, method, databases, section)]
            self.add_comparisons(f"{name}/{identifier(query)}", runs, section)
            self.sections.append(section)

    def is_random(self, descriptor):
        return self.content["descriptors"][descriptor].get("random", False)

    def family(self, descriptor):
        return self.content["descriptors"][descriptor].get("family", "fastable")

    def files(self, name, descriptor):
        """The stamp of the files that a descriptor's commands read in addition to the data set."""
        files = self.content["descriptors"][descriptor].get("files")
        if not files:
            return []
        named = [filled(file, {"data": self.data, "set": name}) for file in files]
        return [stamp(self.out / "inputs" / name / f"files-{descriptor}", named, os.getcwd())]

    def add_database(self, name, data_set, descriptor, seed):
        row = self.content["descriptors"][descriptor]
        job = f"{name}/{descriptor}-s{seed}"
        database = self.path("databases", job)
        if "train" in row:
            command = filled(row["train"], {
                "dataset": data_set.description, "database": database, "seed": seed,
                "threads": self.threads, "data": self.data, "set": name})
        else:
            command = words("vpr-train", self.family(descriptor), "--dataset",
                            data_set.description, *flags(row.get("settings", {})),
                            *self.common(seed, database))
        return self.add("databases", job, data_set.training() + self.files(name, descriptor),
                        command)

    def query_words(self, key, of):
        """The input arguments of vpr-query (key query) or vpr-tune (tune)."""
        row = self.content["descriptors"][of["descriptor"]]
        description = of["data_set"].description
        if key not in row:
            return words("--dataset", description, "--query", of["query"])
        return filled(row[key], {"dataset": description, "query": of["query"], "data": self.data,
                                 "set": of["name"]})

    def add_method(self, name, data_set, query, method, databases, section):
        """Adds results, reports and sweeps of a method on a query; returns its runs."""
        row = self.content["methods"][method]
        named = chosen(row.get("descriptors"), self.content["descriptors"], f"method {method}")
        on = [descriptor for descriptor in named if (descriptor, self.seeds[0]) in databases]
        runs = []
        for descriptor in on:
            is_random = row.get("random", False) or self.is_random(descriptor)
            for seed in self.seeds if is_random else self.seeds[:1]:
                of = {"name": name, "data_set": data_set, "query": query, "method": method,
                      "descriptor": descriptor, "seed": seed,
                      "database": databases.get((descriptor, seed),
                                                databases[descriptor, self.seeds[0]])}
                title = " ".join([method, *([descriptor] if len(on) > 1 else [])])
                suffix = f" seed {seed}" if is_random and len(self.seeds) > 1 else ""
                for cell in self.cells(method, row):
                    runs.append(self.add_run(of, cell, title, suffix))
                    section["runs"].append([runs[-1].name, self.path("reports", runs[-1].id)])
                if "sweep" in row:
                    section["sweeps"].append([title + suffix, self.add_sweep(of, row)])
        return runs

    def grids(self, method, row, key):
        """The grids of a method under a key, with their values."""
        grids = {**self.content.get("grids", {}), **row.get("grids", {})}
        return {grid: grids[grid] for grid in chosen(row[key], grids, f"method {method}")}

    def cells(self, method, row):
        grids = self.grids(method, row, "runs") if "runs" in row else {}
        return [dict(zip(grids, values)) for values in itertools.product(*grids.values())]

    def job_name(self, of):
        return f"{of['name']}/{identifier(of['query'])}/{of['descriptor']}/{of['method']}"

    def query_command(self, program, key, of, settings, output):
        return " ".join([program, words(of["database"]), self.query_words(key, of),
                         words(*flags(settings), *self.common(of["seed"], output))])

    def query_inputs(self, of):
        return [of["database"], *of["data_set"].query(of["query"]),
                *self.files(of["name"], of["descriptor"])]

    def add_run(self, of, cell, title, suffix):
        settings = {**self.content["methods"][of["method"]].get("settings", {}), **cell}
        place = ",".join(f"{key}={value}" for key, value in cell.items()) or "default"
        job = f"{self.job_name(of)}/{place}-s{of['seed']}"
        shown = " ".join([title, *(f"{key} {value}" for key, value in cell.items())]) + suffix
        result = self.add("results", job, self.query_inputs(of), self.query_command(
            "vpr-query", "query", of, settings, self.path("results", job)))
        self.add("reports", job, [result, *of["data_set"].truth(of["query"])], words(
            "vpr-eval", result, "--dataset", of["data_set"].description, "--name", shown,
            "-o", self.path("reports", job), "--force", "--quiet"))
        return Run(of["method"], job, shown)

    def add_sweep(self, of, row):
        grids = self.grids(of["method"], row, "sweep")
        fixed = {key: value for key, value in row.get("settings", {}).items()
                 if key != "method" and key not in grids}
        job = f"{self.job_name(of)}-s{of['seed']}"
        program = f"vpr-tune {self.family(of['descriptor'])}"
        inputs = self.query_inputs(of) + of["data_set"].truth(of["query"])
        return self.add("sweeps", job, inputs, self.query_command(
            program, "tune", of, {**fixed, **grids}, self.path("sweeps", job)))

    def add_comparisons(self, place, runs, section):
        for name, row in self.content.get("comparisons", {}).items():
            reports = [self.path("reports", run.id) for method in row["methods"] for run in runs
                       if run.method == method]
            met = {run.method for run in runs} & set(row["methods"])
            if len(reports) < 2 or len(met) < min(2, len(row["methods"])):
                continue
            job = f"{place}/{name}"
            block = ["--block", row["block"]] if "block" in row else []
            section["comparisons"].append([name, self.add("comparisons", job, reports, words(
                "vpr-eval", "compare", *reports, *block, "-o", self.path("comparisons", job),
                "--force", "--quiet"))])

    def check_comparisons(self):
        for name, row in self.content.get("comparisons", {}).items():
            chosen(row["methods"], self.content["methods"], f"comparison {name}")

    def shown(self):
        """The inputs of the page."""
        return [f"{self.out}/inputs/tree.json",
                *(self.path(*key) for key in self.jobs
                  if key[0] in ("reports", "sweeps", "comparisons"))]

    def page_command(self):
        return words(sys.executable, HERE / "page.py", self.out / "inputs/tree.json",
                     self.out / "index.html")


def load(config):
    """The tree of --config experiments=FILE data=DIR out=DIR, each optional. Adds the programs
    to the PATH of commands."""
    path = pathlib.Path(config.get("experiments") or HERE / "experiments.yaml")
    try:
        content = yaml.safe_load(path.read_text())
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise Mistake(f"{path} cannot be read: {error}") from error
    schema = json.loads(SCHEMA.read_text())
    for error in jsonschema.Draft202012Validator(schema).iter_errors(content):
        raise Mistake(f"{path}: {'/'.join(map(str, error.path)) or 'the file'}: {error.message}")
    programs = pathlib.Path(os.environ.get("VPR_BIN") or ROOT / "build/release/bin").resolve()
    if not (programs / "vpr-query").exists():
        raise Mistake(f"{programs}/vpr-query is missing: build it with cmake --build --preset release, "
                      "or set VPR_BIN to a folder of built programs")
    os.environ["PATH"] = f"{programs}:{os.environ['PATH']}"
    data = os.path.abspath(config["data"]) if config.get("data") else None
    return Tree(content, path.resolve().parent, data, config.get("out") or "out/workflow")
