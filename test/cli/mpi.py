#!/usr/bin/env python3
"""Several processes give the bytes of one, and end together.   mpi.py SOURCE BIN
Ends with 77 (skipped) without mpirun, or in a build without MPI."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import numpy

source, programs = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
for missing, why in ((not shutil.which("mpirun"), "mpirun is not installed"),
                     (not (programs / "../lib/vpr-toolkit/vpr_mpi.so").exists(), "built without MPI")):
    if missing:
        print(f"skipped: {why} (scripts/install-deps.sh --cluster)")
        sys.exit(77)

folder = pathlib.Path(tempfile.mkdtemp())
# More processes than cores, and root, are fine here.
environment = {**os.environ, "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
               "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "TMPDIR": "/tmp"}
# Of programs with AddressSanitizer: Open MPI ends without giving back what its components took, which
# it has unloaded by then, so that no suppression can name them. Without mpirun leaks are looked for.
beside_mpi = {**environment,
              "ASAN_OPTIONS": ":".join(filter(None, (os.environ.get("ASAN_OPTIONS"), "detect_leaks=0")))}


def check(condition, message):
    if not condition:
        sys.exit(f"mpi: {message}")


def command(processes, words):
    program, *rest = words.split()
    start = ["mpirun", "-n", str(processes)] if processes else []
    return [*start, programs / program, *rest, "--threads", "1"]


def run(processes, words, code=0):
    """What was said; of no processes: without mpirun."""
    done = subprocess.run(command(processes, words), cwd=folder,
                          env=beside_mpi if processes else environment,
                          capture_output=True, text=True)
    check(done.returncode == code,
          f"{processes} processes: {words}: code {done.returncode}\n{done.stderr}")
    return done


def sentences(said, program):
    return [line for line in said.stderr.splitlines() if line.startswith(f"{program}: ")]


def content(path):
    """A JSON less what differs from run to run."""
    parsed = json.loads(path.read_text())
    return {key: value for key, value in parsed.items() if key not in ("machine", "timing")}


def compare_outputs(alone, shared, what):
    """Files that begin with these names; their printed tables were compared before."""
    names = sorted(path.name[len(alone):] for path in folder.glob(f"{alone}.*"))
    check(names and names == sorted(path.name[len(shared):] for path in folder.glob(f"{shared}.*")),
          f"{what}: other files")
    for name in names:
        one, other = folder / f"{alone}{name}", folder / f"{shared}{name}"
        if name == ".json":
            check(content(one) == content(other), f"{what}: {name} differs")
        else:
            check(one.read_bytes() == other.read_bytes(), f"{what}: {name} differs")


def same_bytes(words, counts):
    alone = run(0, f"{words} -o alone.json")
    for processes in counts:
        shared = run(processes, f"{words} -o shared.json")
        what = f"{processes} processes: {words}"
        check(shared.stdout.replace("shared", "alone") == alone.stdout, f"{what}: other output")
        compare_outputs("alone", "shared", what)
        remove("shared")
    remove("alone")


def remove(name):
    for path in folder.glob(f"{name}.*"):
        path.unlink()


def compare_runs():
    run(0, f"vpr-synth {source}/test/golden/world.json -o data --quiet")
    walks = json.loads((folder / "data/dataset.json").read_text())["train"]
    frames = sorted((folder / "data" / walks[0]["sequence"]).glob("*.jpg")) or sorted(
        (folder / "data" / walks[0]["sequence"]).glob("*.png"))
    frames[len(frames) // 3].write_bytes(b"no image")  # ends a run of windows
    data = "--dataset data/dataset.json --skip-unreadable"
    run(0, f"vpr-train fastable {data} --c-l 6 -o walks.vprdb --quiet")
    query = f"vpr-query walks.vprdb {data}"
    same_bytes(f"{query} --c-l 6", (1, 4))
    same_bytes(f"{query} --c-l 5 --score standardized --decide margin --margin 0.01", range(1, 8))
    same_bytes(f"{query} --c-l 4 --margin 0.1 --decide margin", (2, 5))
    same_bytes(f"{query} --c-l 4 --t-r 0.6 --method fastable-online", (3,))
    same_bytes(f"{query} --c-l 4 --t-r 300 --t-r-scale bits --method openable", (4,))
    same_bytes(f"{query} --c-l 3 --score standardized-offline --t-r -1", (2, 6))


def refused(start, what):
    """One sentence, exit code 2, and nothing is written."""
    done = subprocess.run(start, cwd=folder, env=beside_mpi, capture_output=True, text=True, timeout=60)
    said = [line for line in done.stderr.splitlines() if line.startswith("vpr-")]
    check(done.returncode == 2 and len(said) == 1, f"{what}: code {done.returncode}\n{done.stderr}")
    return said[0]


def compare_failures():
    data = "--dataset data/dataset.json"
    alone = run(0, f"vpr-query walks.vprdb --query data/{broken()} -o failed.json", code=3)
    shared = run(3, f"vpr-query walks.vprdb --query data/{broken()} -o failed.json", code=3)
    check(sentences(shared, "vpr-query") == sentences(alone, "vpr-query") != [],
          f"a frame that can't be read: {shared.stderr}")
    query = f"vpr-query walks.vprdb {data} --skip-unreadable"
    run(0, f"vpr-train fabmap --pretrain data/back --features orb --words 20 --train data/back "
        "-o places.vprdb --quiet")
    numpy.save(folder / "v.npy", numpy.random.default_rng(7).normal(size=(90, 8)))
    run(0, "vpr-train descriptors --npy v.npy --c-l 20 -o vectors.vprdb --quiet")
    for words in (f"{query} --method filter", f"{query} --c-l 4 --rates 1/2,1 --t-r 0.5",
                  f"{query} --c-l 4 --save-matrix failed.npy --t-r 0.5", f"{query} --c-l 4 --verify 5",
                  "vpr-query vectors.vprdb --query-npy v.npy --c-l 20 --score standardized --t-r -1",
                  "vpr-query places.vprdb --query data/back",
                  "vpr-query --loop --loop-gap 20 --query data/back --t-r 0.3",
                  f"vpr-train fastable {data} -o failed.vprdb", "vpr-train info walks.vprdb",
                  "vpr-tune fastable walks.vprdb --query data/back --ground-truth aligned",
                  "vpr-eval failed.json", "vpr-query --no-such-flag"):
        said = refused(command(2, words), words)
        check("mpirun" in said or "no-such-flag" in said, f"{words}: {said}")
    different = [*command(1, f"{query} --c-l 4 -o failed.json"), ":",
                 *command(1, f"{query} --c-l 5 -o failed.json")[1:]]
    check("different arguments" in refused(different, "another --c-l"), "another --c-l is named")
    check(not list(folder.glob("failed*")) and not list(folder.glob(".failed*")), "something was written")


def broken():
    """The training sequence with a frame that can't be decoded."""
    return json.loads((folder / "data/dataset.json").read_text())["train"][0]["sequence"]


def processes_of(parent):
    """Processes that mpirun has started, by their number, once all of them are connected."""
    found = {}
    for path in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if int((path / "stat").read_text().rsplit(")", 1)[1].split()[1]) != parent:
                continue
            if "vpr_mpi.so" not in (path / "maps").read_text():
                continue
            variables = (path / "environ").read_bytes().decode(errors="replace").split("\0")
        except OSError:
            continue
        number = dict(v.split("=", 1) for v in variables if "=" in v)["OMPI_COMM_WORLD_RANK"]
        found[int(number)] = int(path.name)
    return found


def interrupted(end, leaves_parts=False):
    """What is said by a run of minutes that `end` ends, given mpirun and its three processes. A
    first process that is killed leaves the parts of outputs that the next run removes."""
    words = "vpr-query long.vprdb --query-npy long.npy --method openable --c-l 900 --t-r 0.3 -o long.json"
    mpirun = subprocess.Popen(command(3, words), cwd=folder, env=beside_mpi, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    deadline = time.monotonic() + 60
    while len(processes_of(mpirun.pid)) < 3:
        check(mpirun.poll() is None and time.monotonic() < deadline, "the processes did not start")
        time.sleep(0.1)
    time.sleep(1)
    started = processes_of(mpirun.pid)
    end(mpirun.pid, started)
    _, said = mpirun.communicate(timeout=60)
    while any(pathlib.Path(f"/proc/{pid}").exists() for pid in started.values()):
        check(time.monotonic() < deadline, "a process goes on")
        time.sleep(0.1)
    check(mpirun.returncode != 0 and not list(folder.glob("long*json*"))
          and (leaves_parts or not list(folder.glob(".*"))),
          f"something was written: {sorted(os.listdir(folder))}")
    return [line for line in said.splitlines() if line.startswith("vpr-query: ")]


def stop_one_and_kill_mpirun(mpirun, started):
    os.kill(started[1], signal.SIGSTOP)
    os.kill(mpirun, signal.SIGKILL)


def compare_ends():
    codes = numpy.random.default_rng(1).integers(0, 256, (20000, 8), dtype=numpy.uint8)
    numpy.save(folder / "long.npy", codes)
    run(0, "vpr-train descriptors --npy long.npy --bits --c-l 10 -o long.vprdb --quiet")
    # mpirun may end before it has printed what its processes wrote (docs/clusters.md).
    endings = ([], ["vpr-query: interrupted; nothing was written"])
    said = interrupted(lambda mpirun, started: os.kill(started[1], signal.SIGKILL))
    check(said in endings, f"a process is killed: {said}")
    said = interrupted(lambda mpirun, started: os.kill(mpirun, signal.SIGINT))
    check(said in endings, f"mpirun is interrupted: {said}")
    said = interrupted(lambda mpirun, started: os.kill(mpirun, signal.SIGTERM))
    check(said in endings, f"mpirun is terminated: {said}")
    interrupted(stop_one_and_kill_mpirun)
    said = interrupted(lambda mpirun, started: os.kill(started[0], signal.SIGKILL), leaves_parts=True)
    check(said == [], f"the first process is killed, and mpirun alone says so: {said}")


try:
    compare_runs()
    compare_failures()
    compare_ends()
finally:
    shutil.rmtree(folder)
print("mpi: the bytes of one process, and one end for all")
