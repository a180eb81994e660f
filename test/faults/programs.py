"""Runs programs with a fault at one of their file calls."""
import dataclasses
import pathlib
import re
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
import served  # noqa: E402

# In the order of faults.h.
FAULTS = ["none", "kill", "torn", "interrupt", "eintr", "eio", "dead", "enospc", "shorten",
          "power", "power_off"]


@dataclasses.dataclass(frozen=True)
class Call:
    name: str
    failed: bool
    path: str

    def __str__(self):
        return re.sub(r"(partial-)\w+-\w+", r"\1*", f"{self.name} {self.path}".strip())


@dataclasses.dataclass(frozen=True)
class Run:
    status: int  # exit code; below 0: the signal that ended it
    stdout: str
    stderr: str
    calls: list


def parse_calls(text):
    return [Call(name, mark == "!", path)
            for name, mark, path in re.findall(r"^(\w+)([ !])(.*)$", text, re.MULTILINE)]


class Programs(served.Served):
    """The programs of a build, each loaded once."""

    def run(self, line, folder, fault="none", number=0, plain=False):
        """Runs a command line in `folder`; among the calls below folder/out, call `number` (from 1)
        has the fault. `plain`: renames have no flags."""
        words = [*line.split(), "--threads", "1"]
        status, notes = super().run(words, folder, fault=("out", FAULTS.index(fault), number, int(plain)))
        text = [(pathlib.Path(folder) / name).read_text(errors="replace")
                for name in ("stdout", "stderr")]
        return Run(status, *text, parse_calls(notes))
