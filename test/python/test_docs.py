"""Examples in docstrings and guides run, and types are checked."""

import ast
import doctest
import pathlib
import re
import subprocess
import sys

import matplotlib
import numpy as np
import pytest

import vpr
from vpr import _vpr

SOURCE = pathlib.Path(__file__).parents[2]
PACKAGE = pathlib.Path(vpr.__file__).parent


def test_examples_of_docstrings_run(walks):
    names = {"vpr": vpr, "np": np, "monday": np.load(walks / "monday.npy"),
             "tuesday": np.load(walks / "tuesday.npy")}
    result = doctest.testmod(vpr, extraglobs=names)
    assert result.attempted > 8 and result.failed == 0


def examples_of(page):
    return re.findall(r"```python\n(.*?)```", (SOURCE / page).read_text(), re.S)


@pytest.mark.parametrize("page", ["docs/guide/python.md"])
def test_examples_of_guides_run(walks, tmp_path, monkeypatch, page):
    matplotlib.use("agg")
    for name in ("monday", "tuesday", "monday.npy", "tuesday.npy"):
        (tmp_path / name).symlink_to(walks / name)
    (tmp_path / "pairs.csv").write_text(
        "query,reference\n" + "".join(f"{i},{i}\n" for i in range(200)))
    monkeypatch.chdir(tmp_path)
    names = {}
    examples = examples_of(page)
    assert examples
    for example in examples:
        exec(compile(example, page, "exec"), names)


def test_types_are_checked(tmp_path):
    example = tmp_path / "example.py"
    example.write_text("\n".join(examples_of("docs/guide/python.md")))
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--cache-dir",
         tmp_path / "cache", PACKAGE, example], text=True, capture_output=True, cwd=tmp_path)
    assert checked.returncode == 0, checked.stdout
    assert (PACKAGE / "py.typed").exists()


def test_stubs_have_the_names_of_the_module():
    stub = ast.parse((PACKAGE / "_vpr.pyi").read_text())

    def names_of(body):
        return {node.name if hasattr(node, "name") else node.target.id for node in body
                if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.AnnAssign))}
    assert names_of(stub.body) - {"__getattr__"} <= set(dir(_vpr))
    for node in stub.body:
        if isinstance(node, ast.ClassDef) and node.name != "Result" and "Error" not in node.name:
            assert names_of(node.body) <= set(dir(getattr(_vpr, node.name)))


def test_the_overhead_of_a_call_is_measured(request):
    programs = request.config.getoption("--programs")
    script = pathlib.Path(__file__).with_name("overhead.py")
    done = subprocess.run([sys.executable, script, programs, "1", "3000"], text=True,
                          capture_output=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("of the program") == 6
