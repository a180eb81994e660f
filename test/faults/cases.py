"""All faults of all commands, in an order determined by a seed."""
import dataclasses
import pathlib
import random

import checks
import commands
import programs

FAULTS = {"calls": ["kill", "torn", "interrupt", "eintr", "eio", "dead", "enospc", "shorten"],
          "full": ["full"], "power": ["power", "power_off"]}
# No outputs; old outputs, with --force; or old outputs on a file system without rename flags, like
# most network file systems.
WHERE = {"calls": ("new", "over", "plain"), "full": ("new", "over"), "power": ("new", "over")}


@dataclasses.dataclass(frozen=True)
class Case:
    writer: commands.Writer
    where: str  # without or over old outputs: see WHERE
    fault: str
    number: int  # of the call, from 1; for a small disk, free pages, from 1
    call: str
    is_after_end: bool = False

    @property
    def plain(self):
        return self.where == "plain"

    def line(self):
        return self.writer.line(True) + (" --force" if self.where != "new" else "")

    def __str__(self):
        where = (f"with {self.number} free pages" if self.fault == "full" else
                 "after its end" if self.is_after_end else f"at call {self.number}, {self.call}")
        return f"{self.line()}: {self.fault} {where}" + (", plain renames" if self.plain else "")


@dataclasses.dataclass
class Known:
    """Known data of one command, with or without old outputs: both states and a complete run."""
    saved: pathlib.Path
    old: dict
    new: dict
    pages: int  # of the new outputs
    run: programs.Run


def all_cases(kind, writer, where, known):
    """Every case of a command: a list for each fault."""
    for fault in FAULTS[kind]:
        if fault == "full":
            yield [Case(writer, where, fault, pages, "") for pages in range(1, known.pages + 2)]
            continue
        cases = [Case(writer, where, fault, number, str(call))
                 for number, call in enumerate(known.run.calls, 1) if checks.applies(fault, call)]
        if kind == "power":
            cases.append(Case(writer, where, fault, len(known.run.calls) + 1, "", True))
        yield cases


def spread(groups, seed):
    """All cases of all groups, interleaved so that any prefix is spread over the groups."""
    engine = random.Random(seed)
    for group in groups:
        engine.shuffle(group)
    engine.shuffle(groups)
    longest = max(len(group) for group in groups)
    return [group[i] for i in range(longest) for group in groups if i < len(group)]
