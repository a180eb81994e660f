"""Runs the programs of experiments; each data set and database is made once."""
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VPR_BIN") or ROOT / "build/release/bin")
WORK = ROOT / "out/reproduce"
SIGN_OF_LIFE_S = 30


def say(sentence):
    print(f"[{time.strftime('%H:%M:%S')}] {sentence}", file=sys.stderr, flush=True)


def run(what, program, *arguments):
    """Runs a program of the toolkit and reports its purpose, its elapsed time at intervals, and its total
    time. Discards stdout, shows errors."""
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
            if not sys.stderr.isatty():  # there is no progress bar
                say(f"{what}: for {time.monotonic() - start:.0f} s")
        except KeyboardInterrupt:  # the program received the signal as well
            child.wait()
            sys.exit(130)
    if code != 0:
        sys.exit(code)
    if time.monotonic() - start > SIGN_OF_LIFE_S:
        say(f"{what}: done after {time.monotonic() - start:.0f} s")


def read(path):
    return json.loads(pathlib.Path(path).read_text())


def is_fresh(target, *sources):
    """Whether a file exists and is newer than its inputs."""
    return target.exists() and all(
        target.stat().st_mtime >= source.stat().st_mtime for source in sources)


class DataSet:
    """The user's recordings, or a synthetic stand-in that is rendered on first use."""

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
                sys.exit(f"reproduce: {self.description} is missing; "
                         "docs/benchmarks/datasets.md describes its contents")
        description = read(self.description)
        self.title = description["name"]
        self.has_places = bool(description.get("places") and description.get("pretrain"))

    def train(self, method):
        database = WORK / f"{self.name}{'' if self.is_stand_in else '.data'}.{method}.vprdb"
        options = ["--c-l", 40] if method == "fastable" else []
        if not is_fresh(database / "manifest.json", self.description, BIN / "vpr-train"):
            run(f"train {method} on {self.name}", "vpr-train", method, "--dataset",
                self.description, *options, "-o", database, "--force")
        return database


class Laboratory:
    """Data sets and databases of one run, each made once."""

    def __init__(self, folder):
        self.folder = folder
        self.data_sets = {}
        self.databases = {}
        self.machine = None  # on which times were measured
        self.makers = []  # program, version, commit and seed of the numbers

    def data(self, name):
        if name not in self.data_sets:
            self.data_sets[name] = DataSet(name, self.folder)
        return self.data_sets[name]

    def database(self, name, method):
        if (name, method) not in self.databases:
            self.databases[name, method] = self.data(name).train(method)
        return self.databases[name, method]

    def sweep(self, method, name, query, grids):
        """Cells of a sweep by its two settings, from a single run of vpr-tune."""
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
        """Reads a file written by a program, and records its makers."""
        content = read(path)
        made_by = content["provenance"]
        maker = {key: made_by[key] for key in ("program", "version", "commit", "seed")}
        if maker not in self.makers:
            self.makers.append(maker)
        return content

    def provenance(self):
        """The makers of the numbers and their data, without paths and times."""
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
