#!/usr/bin/env python3
"""Runs each command that writes with a fault at each of its file calls, and checks its outputs.
A seed selects the cases; seed and case number repeat one of them.

  faults.py                        500 cases, spread evenly over commands and faults
  faults.py --cases 0              all cases
  faults.py --seed 7 --case 42     one of them, with its calls
"""
import argparse
import collections
import concurrent.futures
import contextlib
import os
import pathlib
import sys
import tempfile

import campaign
import cases
import commands
import places

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent


def parse_options():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", default=SOURCE / "build/release/bin", type=pathlib.Path,
                        help="folder of the programs (default build/release/bin)")
    parser.add_argument("--kind", choices=cases.FAULTS, default="calls",
                        help="calls that fail (default), full disks, disks without power")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=500, help="number of cases; 0: all (default: 500)")
    parser.add_argument("--case", type=int, help="only this one")
    parser.add_argument("--only", default="", help="only commands whose name has this (a regular "
                        "expression); which changes the numbers of cases")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--folder", default="/dev/shm" if os.access("/dev/shm", os.W_OK) else None,
                        help="for scratch files (default: memory)")
    options = parser.parse_args()
    options.programs = options.programs.resolve()
    return options


def table(verdicts, kind):
    """Cases of each command and fault, and how many of them have findings."""
    cells = collections.defaultdict(lambda: [0, 0])
    for verdict in verdicts:
        for row in (verdict.case.writer.name, "all"):
            for column in (verdict.case.fault, "all"):
                cells[row, column][0] += 1
                cells[row, column][1] += bool(verdict.findings)
    rows = [writer.name for writer in commands.WRITERS] + ["all"]
    columns = cases.FAULTS[kind] + ["all"]
    head = "cases (of them with findings)"
    lines = [head + "".join(f"{name:>11}" for name in columns)]
    for row in rows:
        texts = [f"{count} ({found})" if found else str(count)
                 for count, found in (cells[row, column] for column in columns)]
        if texts[-1] != "0":
            lines.append(f"{row:{len(head)}}" + "".join(f"{text:>11}" for text in texts))
    return "\n".join(lines)


def tell(verdict, number, options):
    for finding in verdict.findings:
        print(f"{verdict.case}\n  {finding}", flush=True)
    only = f" --only '{options.only}'" if options.only else ""
    print(f"  again: test/faults/faults.py --programs {options.programs} --kind {options.kind}"
          f"{only} --seed {options.seed} --case {number}")


def describe(verdict):
    run = verdict.run
    print(verdict.case)
    for number, call in enumerate(run.calls, 1):
        print(f"{number:4} {'fails ' if call.failed else ''}{call}")
    print(f"status {run.status}, outputs {verdict.outcome}\n{run.stderr}", end="")
    for finding in verdict.findings:
        print(f"finding: {finding}")


def reason_to_skip(options, scratch):
    """The reason why cases of this kind cannot run on this machine."""
    if options.kind == "calls":
        return None
    probe = pathlib.Path(scratch) / "probe"
    probe.mkdir()
    return places.why_not(options.kind, probe)


def told(verdicts, count, options):
    """Reports findings at once, and the progress at intervals."""
    for number, verdict in enumerate(verdicts):
        if verdict.findings:
            tell(verdict, number, options)
        if number % 1000 == 999:
            print(f"{number + 1} of {count} cases", file=sys.stderr, flush=True)
        yield verdict


def report(verdicts, count, options):
    print(table(verdicts, options.kind))
    outcomes = collections.Counter(verdict.outcome for verdict in verdicts)
    found = sum(bool(verdict.findings) for verdict in verdicts)
    print(f"{len(verdicts)} of {count} cases, seed {options.seed}: outputs old in "
          f"{outcomes['old']}, new in {outcomes['new']}, mixed in {outcomes['mixed']}; "
          f"findings in {found}")
    return bool(found)


def main():
    options = parse_options()
    with contextlib.ExitStack() as stack:
        scratch = stack.enter_context(
            tempfile.TemporaryDirectory(dir=options.folder, prefix="vpr-faults-"))
        reason = reason_to_skip(options, scratch)
        if reason:
            print(f"faults: {options.kind}: skipped: {reason}")
            return 77
        trial = stack.enter_context(contextlib.closing(campaign.Campaign(options, scratch)))
        pool = stack.enter_context(concurrent.futures.ThreadPoolExecutor(options.workers))
        found = trial.all_cases(pool)
        if options.case is not None:
            verdict = trial.judge(found[options.case])
            describe(verdict)
            return bool(verdict.findings)
        chosen = found[:options.cases or len(found)]
        verdicts = list(told(pool.map(trial.judge, chosen), len(chosen), options))
        return report(verdicts, len(found), options)


if __name__ == "__main__":
    sys.exit(main())
