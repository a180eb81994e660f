"""Common functions of the tests of scripts/convert.
   NAME.py SOURCE BIN; exits with 77 (skipped) without the imported packages."""
import pathlib
import subprocess
import sys
import tempfile

source, programs = map(pathlib.Path, sys.argv[1:3])
temporary = tempfile.TemporaryDirectory()
folder = pathlib.Path(temporary.name)


def packages(*names):
    """The modules, or the end of the test."""
    try:
        return [__import__(name, fromlist=["*"]) for name in names]
    except ModuleNotFoundError as error:
        print(f"skipped: {error}")
        sys.exit(77)


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True)


def converter(script):
    """A function that runs the script with these words."""
    return lambda *words: run(sys.executable, source / "scripts/convert" / script, *words)


def good(outcome):
    assert outcome.returncode == 0, outcome
    return outcome


def refused(outcome, code, words):
    """One sentence and an exit code."""
    assert outcome.returncode == code and outcome.stdout == "", outcome
    assert words in outcome.stderr and outcome.stderr.count("\n") == 1, outcome
    assert not list(folder.glob(".vpr-partial-*")), outcome


def evaluated(*words):
    """The report of vpr-eval check about a ground truth."""
    return good(run(programs / "vpr-eval", "check", *words, "--json")).stdout


def named(path, script, *more):
    """The programs refuse the unconverted file and name the script."""
    outcome = run(programs / "vpr-eval", "check", path, *more)
    assert outcome.returncode == 2 and f"scripts/convert/{script}" in outcome.stderr, outcome
