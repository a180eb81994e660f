#!/usr/bin/env python3
"""python_reference.py [--check] [FOLDER]: writes docs/reference/python.md from the docstrings of the module vpr
in FOLDER (default: build/release/python). --check fails if the page differs."""
import inspect
import pathlib
import sys

root = pathlib.Path(__file__).resolve().parents[2]
PAGE = root / "docs/reference/python.md"


def block(text):
    return ["```", inspect.cleandoc(text), "```", ""]


def signature(name, function):
    parameters = [p.replace(annotation=p.empty) for p in inspect.signature(function).parameters.values()
                  if p.name != "self"]
    return f"{name}{inspect.Signature(parameters)}"


def page(vpr):
    out = ["# Python module", "", "The docstrings of `vpr`. Written by `scripts/dev/python_reference.py`.", ""]
    out += block(vpr.__doc__)
    for name in ["train", "load", "query", "loops", "evaluate", "evaluate_scores", "distances"]:
        out += [f"## vpr.{name}", "", f"`{signature(name, getattr(vpr, name))}`", ""]
        out += block(getattr(vpr, name).__doc__)
    for name in ["Database", "Result", "Report", "Distances", "Live", "Fields"]:
        kind = getattr(vpr, name)
        out += [f"## vpr.{name}", ""] + block(kind.__doc__)
        for member, value in vars(kind).items():
            if member.startswith("_") or not inspect.getdoc(value):
                continue
            is_python = inspect.isfunction(value)
            out += [f"`{signature(member, value) if is_python else member}`", ""] + block(inspect.getdoc(value))
    errors = [name for name in vpr.__all__ if name.endswith("Error") and name != "Error"]
    out += ["## Errors", "", "|class|meaning|", "|---|---|"]
    out += [f"|vpr.{name}|{getattr(vpr, name).__doc__}|" for name in errors]
    return "\n".join(out) + "\n"


words = sys.argv[1:]
folders = [word for word in words if word != "--check"]
sys.path.insert(0, str(pathlib.Path(folders[0]).resolve() if folders else root / "build/release/python"))
import vpr  # noqa: E402

text = page(vpr)
if "--check" not in words:
    PAGE.write_text(text)
elif not PAGE.exists() or PAGE.read_text() != text:
    sys.exit("docs/reference/python.md differs from the docstrings of vpr: run scripts/generate.sh")
