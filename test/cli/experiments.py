#!/usr/bin/env python3
"""Runs every experiment of the paper with --quick, from rendering to the summary.

    experiments.py SOURCE BIN [--update]

Compares the numbers of a row of each experiment of counts with experiments.json; --update writes
that file. Times are only checked for their order."""
import json
import os
import platform
import sys

from support import call, folder, programs, read_json, source, stub

sys.path.insert(0, str(source / "scripts/reproduce"))
from experiments import SETTINGS  # noqa: E402
from reproduce import ORDER  # noqa: E402

KNOWN = source / "test/cli/experiments.json"
FABMAP_TOLERANCE = 0.15  # its vocabulary depends on the floating-point units of the machine
BROKEN = "tab5"


def break_once():
    """Programs with a vpr-bench whose first call (in tab5) fails."""
    bin_folder = folder / "bin"
    bin_folder.mkdir()
    for program in programs.glob("vpr-*"):
        if program.name != "vpr-bench":
            (bin_folder / program.name).symlink_to(program)
    stub(bin_folder / "vpr-bench", f"""[ -e {folder}/called ] || {{ touch {folder}/called; exit 3; }}
exec {programs}/vpr-bench "$@\"""")


def start(*words):
    done = call(source / "scripts/reproduce/run.sh", *words, "--quick", "--out", "out",
                env={**os.environ, "VPR_BIN": str(folder / "bin")})
    print(done.stderr, file=sys.stderr)
    return done


def check_table(name, written):
    """One number for each of the paper's, or the reason why there is none; findings likewise."""
    config = read_json(source / f"scripts/reproduce/paper/{name}.json")
    expected = [(row, measure) for row in config["rows"] for measure in row if measure not in SETTINGS]
    cells = written["cells"]
    assert ([(cell["measure"], cell["paper"]) for cell in cells]
          == [(measure, row[measure]) for row, measure in expected]), f"{name}: the table's shape"
    for cell in cells:
        assert (cell["ours"] is None) == ("unmeasured" in cell), f"{name}: {cell}"
        if config["kind"] == "bench" and cell["ours"] is not None:
            assert 0 < cell["low"] <= cell["ours"] <= cell["high"], f"{name}: {cell}"
    assert ([outcome["finding"] for outcome in written["findings"]]
          == [finding["finding"] for finding in config["findings"]]), f"{name}: the findings"
    for outcome in written["findings"]:
        assert (outcome["holds"] is None) == bool(outcome.get("reason")), f"{name}: {outcome}"
        assert (outcome["holds"] is None) == (not outcome["parts"]), f"{name}: {outcome}"
        assert outcome.get("reason") != "there are no such numbers", f"{name}: {outcome}"
    assert written["quick"] and "quick" in written["title"], f"{name}: {written['title']}"


def numbers_of(written):
    """Our numbers of the first row and of the last."""
    cells = [{key: value for key, value in cell.items() if key not in ("paper", "data", "query")}
             for cell in written["cells"]]
    rows = [{key: value for key, value in cell.items() if key in SETTINGS} for cell in cells]
    return [cell for cell, row in zip(cells, rows) if row in (rows[0], rows[-1])]


def check_numbers(name, numbers, known):
    assert len(numbers) == len(known), f"{name}: {numbers}, known: {known}"
    for found, expected in zip(numbers, known):
        is_fabmap = "c_l" not in found or found["measure"].startswith("FAB-MAP")
        tolerance = max(3, FABMAP_TOLERANCE * expected["ours"]) if is_fabmap else 0
        assert ({**found, "ours": 0} == {**expected, "ours": 0}
              and abs(found["ours"] - expected["ours"]) <= tolerance), (f"{name}: {found}, known: {expected}. "
              "If the rendered worlds have changed, run test/cli/experiments.py SOURCE BIN --update")


break_once()
done = start("all")
assert done.returncode == 1, done.returncode
failures = [line for line in done.stdout.splitlines() if line.startswith("Failed: ")]
assert len(failures) == 1 and failures[0].startswith(f"Failed: {BROKEN}: vpr-bench"), done.stdout
assert "| recognition | " in done.stdout and "| time | " in done.stdout, done.stdout
assert not (folder / f"out/quick/{BROKEN}.json").exists(), f"{BROKEN} has a table"

done = start("all")
assert done.returncode == 0 and "Failed" not in done.stdout, (done.returncode, done.stdout)
for name in ORDER:
    assert (f"{name}: not repeated" in done.stderr) == (name != BROKEN), name
assert "not repeated" not in start(BROKEN, "--again").stderr

tables = {name: f"out/quick/{name}.json" for name in ORDER}
written = {name: read_json(path) for name, path in tables.items()}
for name in ORDER:
    check_table(name, written[name])
for drawn in ("put-mc-long", "tab6-1/openable-fps.svg", "tab6-1/fastable-cpu.svg", "times-2/fabmap-fps.svg",
              "times-4/time-by-query_frames.svg"):
    assert (folder / "out/quick/figures" / drawn).exists(), drawn
checked = call(sys.executable, source / "scripts/dev/check_schemas.py", *tables.values())
assert checked.returncode in (0, 77), checked
numbers = {name: numbers_of(written[name]) for name in ORDER if "machine" not in written[name]}
if "--update" in sys.argv:
    KNOWN.write_text("{" + ",".join(f'\n"{name}": [\n' + ",\n".join(map(json.dumps, cells)) + "\n]"
                                    for name, cells in numbers.items()) + "\n}\n")
elif platform.machine() == "x86_64":  # where images render to the same bytes
    for name, found in numbers.items():
        check_numbers(name, found, read_json(KNOWN)[name])
