"""Runs the programs of experiments; each data set and database is made once."""
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(os.environ.get("VPR_BIN") or ROOT / "build/release/bin").absolute()
PROGRAMS = ("vpr-synth", "vpr-train", "vpr-query", "vpr-eval", "vpr-tune")  # of counts
SIGN_OF_LIFE_S = 30
INTERRUPTED = 130  # exit code
QUICK_WIDTH, QUICK_HEIGHT = 160, 120  # of rendered images, in pixels
VOCABULARY_STEP = 5  # of the frames of a vocabulary that is made of the recordings' own sequences
QUICK_SHARE = 2 / 3  # of the frames of recordings: windows of 80 frames still fit all sequences


class Failure(Exception):
    """An experiment cannot be finished; `code` is the exit code. After INTERRUPTED no other one is started."""

    def __init__(self, message, code=1):
        super().__init__(message)
        self.code = code


ACTIVITY = threading.local()  # with `label`: of this thread's messages


def say(sentence):
    label = getattr(ACTIVITY, "label", "")
    print(f"[{time.strftime('%H:%M:%S')}] {label}{sentence}", file=sys.stderr, flush=True)


def run(what, program, *arguments):
    """Runs a program of the toolkit and reports its purpose, its elapsed time at intervals, and its total
    time. Discards stdout, shows errors."""
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
    if code != 0:
        raise Failure(f"{program} ended with exit code {code} ({what})", code)
    if time.monotonic() - start > SIGN_OF_LIFE_S:
        say(f"{what}: done after {time.monotonic() - start:.0f} s")


def read(path):
    return json.loads(pathlib.Path(path).read_text())


def is_fresh(target, *sources):
    """Whether a file exists and is newer than its inputs."""
    return target.exists() and all(
        target.stat().st_mtime >= source.stat().st_mtime for source in sources)


def data_state(name, folder):
    """Text that changes with the world of a stand-in, or with any file of the user's recordings."""
    if folder is None:
        return (ROOT / f"configs/worlds/{name}.json").read_text()
    files = sorted(path for path in (pathlib.Path(folder) / name).rglob("*") if path.is_file())
    return "\n".join(f"{path} {path.stat().st_size} {path.stat().st_mtime_ns}" for path in files)


def sha256(text):
    return hashlib.sha256(text if isinstance(text, bytes) else text.encode()).hexdigest()


class DataSet:
    """The user's recordings, or a synthetic stand-in that is rendered on first use."""

    def __init__(self, name, laboratory):
        self.name = name
        self.work = laboratory.work
        self.is_stand_in = laboratory.folder is None
        if self.is_stand_in:
            self.description = self.work / name / "dataset.json"
            self.render(laboratory.is_quick, laboratory.seed)
        else:
            self.description = laboratory.folder / name / "dataset.json"
            if not self.description.exists():
                raise Failure(f"{self.description} is missing; scripts/reproduce/README.md "
                              "describes its contents", 2)
        self.content = read(self.description)
        self.title = self.content["name"]
        self.suffix = ""  # of names of databases
        if not self.is_stand_in:
            self.suffix = f".{sha256(data_state(name, laboratory.folder))[:8]}"
        marked = self.description.parent / "fabmap-places.csv"
        self.marked = None if self.content.get("places") or not marked.exists() else marked
        self.vocabulary = []  # of marked places without "pretrain": other queries, or else training sequences
        if self.marked and not self.content.get("pretrain"):
            others = [one for one in self.content["queries"] if one["name"] != "query"]
            self.vocabulary = [one["sequence"] + ("" if "@" in one["sequence"] else f"@::{VOCABULARY_STEP}")
                               for one in others or self.content["train"]]
        self.thinned = []  # flags that select a part of the frames
        if laboratory.is_quick and not self.is_stand_in and "fps" in self.content:
            self.thinned = ["--fps", f"{self.content['fps'] * QUICK_SHARE:g}"]

    def render(self, is_quick, seed):
        world = ROOT / f"configs/worlds/{self.name}.json"
        if is_fresh(self.description, world, BIN / "vpr-synth"):
            return
        content = read(world)
        changes = {"image_width": QUICK_WIDTH, "image_height": QUICK_HEIGHT} if is_quick else {}
        if seed:
            changes["seed"] = content["seed"] + seed
        if changes:
            world = self.work / f"{self.name}.json"
            world.write_text(json.dumps({**content, **changes}))
        run(f"render the stand-in {self.name}", "vpr-synth", world, "-o", self.description.parent,
            "--force")

    def lacks(self, query):
        """Why a query cannot be measured; empty if it can."""
        names = [one["name"] for one in self.content["queries"]]
        return "" if query in names else f"the recordings have no query {query}"

    def query(self, name):
        found = [query for query in self.content["queries"] if query["name"] == name]
        if not found:
            raise Failure(f"{self.description}: there is no query named {name}. Add it there", 2)
        return found[0]

    def fabmap_options(self):
        """The places that a person marked and, if the recordings have no frames of other places, frames for the
        vocabulary."""
        if not self.marked:
            return []
        options = ["--marked-places", self.marked]
        for text in self.vocabulary:
            options += ["--pretrain", self.description.parent / text]
        return options

    def train(self, method):
        database = self.work / f"{self.name}{self.suffix}.{method}.vprdb"
        options = ["--c-l", 40, *self.thinned] if method == "fastable" else self.fabmap_options()
        if not is_fresh(database / "manifest.json", self.description, BIN / "vpr-train"):
            run(f"train {method} on {self.name}", "vpr-train", method, "--dataset",
                self.description, *options, "-o", database, "--force")
        return database


class Laboratory:
    """Data sets and databases of one experiment, each made once. `seed` is added to the seed of each world."""

    def __init__(self, out, folder, is_quick, seed=0):
        self.seed = seed
        self.folder = pathlib.Path(folder) if folder else None
        self.is_quick = is_quick
        self.work = out / "reproduce"
        self.figures = out / "figures"
        self.data_sets = {}
        self.databases = {}
        self.machine = None  # on which times were measured
        self.makers = []  # program, version, commit and seed of the numbers
        self.notes = []  # of this run
        for made in (self.work, self.figures):
            made.mkdir(parents=True, exist_ok=True)

    def data(self, name):
        if name not in self.data_sets:
            self.data_sets[name] = DataSet(name, self)
        return self.data_sets[name]

    def database(self, name, method):
        if (name, method) not in self.databases:
            self.databases[name, method] = self.data(name).train(method)
        return self.databases[name, method]

    def sweep(self, method, name, query, grids):
        """Cells of a sweep by its two settings, from a single run of vpr-tune."""
        out = self.work / "sweep.json"
        flags = [word for flag, values in grids.items()
                 for word in (flag, ",".join(str(v) for v in sorted(set(values))))]
        run(f"sweep {method} on {name}, query {query}", "vpr-tune", method,
            self.database(name, method), "--dataset", self.data(name).description, "--query", query,
            *self.data(name).thinned, *flags, "-o", out, "--force", "--quiet")
        keys = ("c_w", "t_p") if method == "fabmap" else ("c_l", "t_r")
        return {tuple(cell[key] for key in keys): cell for cell in self.written(out)["cells"]}

    def report(self, method, name, query, *settings, evaluation=()):
        """The evaluation report of one query."""
        family = "fabmap" if method == "fabmap" else "fastable"
        result, report = self.work / "result.json", self.work / "report.json"
        data = ["--dataset", self.data(name).description]
        words = " ".join(map(str, settings))
        run(f"query {name} with {query}: {method} {words}", "vpr-query",
            self.database(name, family), *data, "--query", query, *self.data(name).thinned,
            "--method", method, *settings, "-o", result, "--force", "--quiet")
        run(f"evaluate {query}", "vpr-eval", result, *data, *evaluation, "-o", report, "--force",
            "--quiet")
        return self.written(report)

    def note(self, sentence):
        """Adds a sentence to the notes, once."""
        if sentence not in self.notes:
            self.notes.append(sentence)
            say(sentence)

    def keep_result(self, stem):
        """Renames the last result and its arrays; returns its path."""
        for file in self.work.glob("result.*"):
            file.replace(self.work / (stem + file.name.removeprefix("result")))
        return self.work / f"{stem}.json"

    def written(self, path):
        """Reads a file written by a program, and records its makers."""
        content = read(path)
        made_by = content["provenance"]
        maker = {key: made_by[key] for key in ("program", "version", "commit", "seed")}
        if maker not in self.makers:
            self.makers.append(maker)
        return content

    def provenance(self, inputs):
        """The makers of the numbers and their data, without paths and times."""
        return {
            "program": "reproduce.py",
            "version": self.makers[0]["version"],
            "commit": self.makers[0]["commit"],
            "seed": self.makers[0]["seed"],
            "inputs_sha256": inputs,
            "programs": self.makers,
            "data": [{"name": data.name, "title": data.title, "stand_in": data.is_stand_in,
                      "dataset_sha256": sha256(data.description.read_bytes())}
                     for _, data in sorted(self.data_sets.items())],
            "databases": {f"{name}.{method}": read(path / "manifest.json")["checksum"]
                          for (name, method), path in sorted(self.databases.items())}}
