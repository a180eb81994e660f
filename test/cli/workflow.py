#!/usr/bin/env python3
"""A tiny tree of experiments: it resumes after a kill, and rebuilds only results of changed inputs.
   workflow.py SOURCE BIN; ends with 77 (skipped) without snakemake."""
import json
import os
import shutil
import signal
import subprocess
import time

from support import call, folder, programs, read_json, run, skip, source, write

if not shutil.which("snakemake"):
    skip("snakemake is not installed (scripts/install-deps.sh --cluster)")
import yaml  # noqa: E402  snakemake needs it as well

out = folder / "out"
environment = {**os.environ, "VPR_BIN": str(programs), "XDG_CACHE_HOME": str(folder / "cache")}


def command(*words):
    return ["snakemake", "-s", source / "scripts/workflow/Snakefile", "-j2", *words, "--config",
            f"experiments={folder}/experiments.yaml", f"data={folder}/data", "out=out"]


def snakemake(*words):
    done = call(*command(*words), env=environment)
    return done.returncode, done.stdout + done.stderr


def build(*words):
    code, said = snakemake(*words)
    assert code == 0, said
    return said


def planned():
    """Outputs of a dry run, relative to out."""
    lines = build("-n").splitlines()
    return {line.split(": ", 1)[1].removeprefix("out/") for line in lines
            if line.startswith("    output: ")}


def write_experiments():
    """A rendered data set, and one with two queries, of the same frames under two names."""
    world = source / "test/golden/world.json"
    rendered = folder / "data"
    run("vpr-synth", world, "-o", rendered, "--quiet")
    shutil.copytree(rendered / "back", rendered / "again")
    content = read_json("data/dataset.json")
    truth = "{data}/" + content["queries"][0]["ground_truth"]["path"]
    shutil.copy(truth.format(data=rendered), rendered / "again.csv")
    queries = [{"name": name, "sequence": f"{{data}}/{name}",
                "ground_truth": {"format": "pairs", "path": path}}
               for name, path in (("back", truth), ("again", "{data}/again.csv"))]
    write("data/own.txt", "what the descriptor called own reads\n")
    (folder / "again").mkdir()  # a folder next to the tree is not the query of that name
    train = [{"name": name, "sequence": f"{{data}}/{name}"} for name in ("north", "south")]
    tree = {"schema": "vpr.experiments/3", "seeds": [1, 2], "grids": {"c_l": [5, 6]},
            "data": {"built": {"world": str(world)},
                     "told": {"dataset": {"train": train, "queries": queries}}},
            "descriptors": {"ldb": {}, "own": {"random": True, "train":
                "vpr-train fastable --dataset {dataset} --seed {seed} -o {database} --quiet",
                "query": "--dataset {dataset} --query {query}",
                "tune": "--dataset {dataset} --query {query} --tolerance 1",
                "files": ["{data}/own.txt"]}},
            "methods": {"raw": {"descriptors": ["ldb"], "runs": ["c_l"], "sweep": ["c_l"]},
                        "mine": {"descriptors": ["own"], "settings": {"c_l": 5},
                                 "sweep": ["c_l"]}},
            "comparisons": {"both": {"methods": ["raw", "mine"]}}}
    write("experiments.yaml", yaml.safe_dump(tree, sort_keys=False))
    return tree


def of_query(query, *, results):
    """Jobs that depend on a query of the data set "told", or only on its ground truth."""
    runs = [f"told/{query}/ldb/raw/c_l={c_l}-s1" for c_l in (5, 6)]
    runs += [f"told/{query}/own/mine/default-s{seed}" for seed in (1, 2)]
    kinds = ("result", "report") if results else ("report",)
    sweeps = {f"sweeps/told/{query}/{made}.json" for made in ("ldb/raw-s1", "own/mine-s1",
                                                              "own/mine-s2")}
    return sweeps | {f"results/{run}/{kind}.json" for run in runs for kind in kinds} | {
        f"comparisons/told/{query}/both.json", "index.html"}


def check_killed():
    """Kills the run after its first result, by a signal that cannot be caught; finished outputs are
    not rebuilt."""
    database = out / "databases/told/ldb-s1.vprdb/manifest.json"
    with open(folder / "killed.log", "w") as log:
        started = subprocess.Popen(command(), cwd=folder, env=environment, stdout=log, stderr=log,
                                   start_new_session=True)
        until = time.monotonic() + 120
        while not (database.exists() and list(out.glob("results/told/*/ldb/*/*/result.json"))):
            assert started.poll() is None and time.monotonic() < until, (folder / "killed.log").read_text()
            time.sleep(0.02)
        os.killpg(started.pid, signal.SIGKILL)
        started.wait()
    assert not (out / "index.html").exists(), "killed too late to tell"
    made = database.stat().st_mtime_ns
    assert snakemake()[0] != 0, "a folder that a killed run has locked was not refused"
    build("--unlock")
    build("--rerun-incomplete")
    assert database.stat().st_mtime_ns == made, "a database was made twice"
    assert planned() == set(), "a complete tree is not complete"


def check_page():
    page = (out / "index.html").read_text()
    for text in ("raw c_l 5", "mine seed 2", "told: again", "golden: back",
                 "differences to raw c_l 5"):
        assert text in page, f"{text} is missing in {page}"
    report = read_json("out/results/told/back/ldb/raw/c_l=5-s1/report.json")
    swept = read_json("out/sweeps/told/back/own/mine-s1.json")
    best = swept["cells"][swept["queries"][0]["recommended"]]
    assert f"recommended: c_l {best['c_l']}, t_r {best['t_r']:.4g}<" in page, best
    assert "each widened by 1 training frame" in json.dumps(swept["queries"]), swept["queries"]
    assert f"<td>{report['counts']['pairs']['correct']}</td>" in page, "counts are missing"


def replace(path):
    """The same bytes in a new file, whose folder may be as old as before."""
    content = path.read_bytes()
    path.unlink()
    path.write_bytes(content)


def same(found, expected):
    assert found == expected, f"too much {sorted(found - expected)}, too little " f"{sorted(expected - found)}"


def check_changes():
    replace(folder / "data/again.csv")
    same(planned(), of_query("again", results=False))
    os.utime(sorted((folder / "data/again").iterdir())[3])
    same(planned(), of_query("again", results=True))
    build()
    same(planned(), set())
    os.utime(folder / "experiments.yaml")
    same(planned(), set())
    os.utime(folder / "data/own.txt")
    same({made for made in planned() if "/ldb" in made}, set())
    replace(sorted((folder / "data/north").iterdir())[0])
    databases = {f"databases/told/{name}.vprdb" for name in ("ldb-s1", "own-s1", "own-s2")}
    built = {made for made in planned() if "built/" in made}
    told = of_query("back", results=True) | of_query("again", results=True)
    same(planned() - built, told | databases)
    assert built and not any("/ldb" in made for made in built), built


def check_mistakes(tree):
    """Errors are one sentence, with the valid choices."""
    for wrong, said in (({"methods": {"raw": {"runs": ["c_x"]}}}, "c_x"),
                        ({"methods": {"raw": {"descriptors": ["ldc"]}}}, "ldb, own"),
                        ({"sweeps": 1}, "sweeps"), ({"seeds": ["one"]}, "seeds/0")):
        write("experiments.yaml", yaml.safe_dump({**tree, **wrong}))
        code, printed = snakemake("-n")
        assert code != 0 and said in printed and "Traceback" not in printed, (wrong, printed)


written = write_experiments()
check_killed()
check_page()
check_changes()
check_mistakes(written)
