#!/usr/bin/env python3
"""Runs every experiment of the paper with --quick, from rendering to the summary.

    experiments.py SOURCE BIN [--update]

Compares the numbers of a row of each experiment of counts with experiments.json; --update writes
that file. Times are only checked for their order."""
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile

source, programs = map(pathlib.Path, sys.argv[1:3])
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "scripts/reproduce"))
from experiments import SETTINGS  # noqa: E402
from reproduce import ORDER  # noqa: E402

KNOWN = source / "test/cli/experiments.json"
FABMAP_TOLERANCE = 0.15  # its vocabulary depends on the floating-point units of the machine
BROKEN = "tab5"


def check(condition, message):
    if not condition:
        sys.exit(f"experiments: {message}")


def broken_once(folder):
    """Programs with a vpr-bench whose first call (in tab5) fails."""
    for program in programs.glob("vpr-*"):
        (folder / program.name).symlink_to(program.absolute())
    stub = folder / "vpr-bench"
    stub.unlink()
    stub.write_text(f"#!/bin/sh\n[ -e {folder}/called ] || {{ touch {folder}/called; exit 3; }}\n"
                    f"exec {programs.absolute()}/vpr-bench \"$@\"\n")
    stub.chmod(0o755)
    return folder


def start(bin_folder, out, *words):
    done = subprocess.run(
        [source / "scripts/reproduce/run.sh", *words, "--quick", "--out", out], text=True,
        env={**os.environ, "VPR_BIN": str(bin_folder)}, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    print(done.stderr, file=sys.stderr)
    return done


def check_table(name, written):
    """One number for each of the paper's, or the reason why there is none; findings likewise."""
    config = json.loads((source / f"configs/paper/{name}.json").read_text())
    expected = [(row, measure) for row in config["rows"] for measure in row if measure not in SETTINGS]
    cells = written["cells"]
    check([(cell["measure"], cell["paper"]) for cell in cells]
          == [(measure, row[measure]) for row, measure in expected], f"{name}: the table's shape")
    for cell in cells:
        check((cell["ours"] is None) == ("unmeasured" in cell), f"{name}: {cell}")
        if config["kind"] == "bench" and cell["ours"] is not None:
            check(0 < cell["low"] <= cell["ours"] <= cell["high"], f"{name}: {cell}")
    check([outcome["finding"] for outcome in written["findings"]]
          == [finding["finding"] for finding in config["findings"]], f"{name}: the findings")
    for outcome in written["findings"]:
        check((outcome["holds"] is None) == bool(outcome.get("reason")), f"{name}: {outcome}")
        check((outcome["holds"] is None) == (not outcome["parts"]), f"{name}: {outcome}")
        check(outcome.get("reason") != "there are no such numbers", f"{name}: {outcome}")
    check(written["quick"] and "quick" in written["title"], f"{name}: {written['title']}")


def numbers_of(written):
    """Our numbers of the first row and of the last."""
    cells = [{key: value for key, value in cell.items() if key not in ("paper", "data", "query")}
             for cell in written["cells"]]
    rows = [{key: value for key, value in cell.items() if key in SETTINGS} for cell in cells]
    return [cell for cell, row in zip(cells, rows) if row in (rows[0], rows[-1])]


def check_numbers(name, numbers, known):
    check(len(numbers) == len(known), f"{name}: {numbers}, known: {known}")
    for found, expected in zip(numbers, known):
        is_fabmap = "c_l" not in found or found["measure"].startswith("FAB-MAP")
        tolerance = max(3, FABMAP_TOLERANCE * expected["ours"]) if is_fabmap else 0
        check({**found, "ours": 0} == {**expected, "ours": 0}
              and abs(found["ours"] - expected["ours"]) <= tolerance, f"{name}: {found}, known: {expected}. "
              "If the rendered worlds have changed, run test/cli/experiments.py SOURCE BIN --update")


def main():
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        bin_folder = pathlib.Path(folder) / "bin"
        bin_folder.mkdir()
        broken_once(bin_folder)

        done = start(bin_folder, out, "all")
        check(done.returncode == 1, f"all ended with {done.returncode}")
        failures = [line for line in done.stdout.splitlines() if line.startswith("Failed: ")]
        check(len(failures) == 1 and failures[0].startswith(f"Failed: {BROKEN}: vpr-bench"), done.stdout)
        check("| recognition | " in done.stdout and "| time | " in done.stdout, done.stdout)
        check(not (out / f"quick/{BROKEN}.json").exists(), f"{BROKEN} has a table")

        done = start(bin_folder, out, "all")
        check(done.returncode == 0 and "Failed" not in done.stdout, f"again: {done.returncode}, {done.stdout}")
        for name in ORDER:
            check((f"{name}: not repeated" in done.stderr) == (name != BROKEN), f"second start: {name}")
        check("not repeated" not in start(bin_folder, out, BROKEN, "--again").stderr, "--again")

        written = {name: json.loads((out / f"quick/{name}.json").read_text()) for name in ORDER}
        for name in ORDER:
            check_table(name, written[name])
        for drawn in ("put-mc-long", "tab6-1/openable-fps.svg", "tab6-1/fastable-cpu.svg",
                      "times-2/fabmap-fps.svg", "times-4/time-by-query_frames.svg"):
            check((out / "quick/figures" / drawn).exists(), f"{drawn} was not drawn")
        done = subprocess.run([sys.executable, source / "scripts/check_schemas.py",
                               *(out / f"quick/{name}.json" for name in ORDER)])
        check(done.returncode in (0, 77), "an output does not fit its schema")
        numbers = {name: numbers_of(written[name]) for name in ORDER if "machine" not in written[name]}
        if "--update" in sys.argv:
            KNOWN.write_text("{" + ",".join(f'\n"{name}": [\n' + ",\n".join(map(json.dumps, cells)) + "\n]"
                                            for name, cells in numbers.items()) + "\n}\n")
        elif platform.machine() == "x86_64":  # where images render to the same bytes
            known = json.loads(KNOWN.read_text())
            for name, found in numbers.items():
                check_numbers(name, found, known[name])


main()
