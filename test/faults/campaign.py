"""Runs cases with workers, which have their own programs and folders and share the inputs."""
import dataclasses
import pathlib
import re
import sys
import threading

import cases
import checks
import commands
import outputs
import places
import programs


@dataclasses.dataclass
class Verdict:
    case: cases.Case
    outcome: str
    findings: list
    run: programs.Run


class Worker:
    """A working folder with its own programs."""

    def __init__(self, options, work, kind):
        self.work = pathlib.Path(work)
        self.place = places.PLACES[kind](self.work)
        (self.work / "read").mkdir()
        self.programs = programs.Programs(options.programs)

    def run(self, line, *fault):
        return self.programs.run(line, self.work, *fault)

    def look(self, writer):
        return outputs.snapshot(self.work / "out", writer.has_times)

    def prepare(self, writer, where, saved):
        """Both states, and a run without a fault."""
        out = self.work / "out"
        outputs.clear(out)
        for name, original in writer.start:
            outputs.fill(out / name, self.work / original)
        if where != "new" and not writer.start:
            self.must(writer.line(False), writer)
        outputs.fill(saved, out)
        old, _ = self.look(writer)
        run = self.must(writer.line(True) + (" --force" if where != "new" else ""), writer,
                        where == "plain")
        new, hidden = self.look(writer)
        if hidden or any(old.get(name) == new[name] for name in new
                         if name == writer.main or not writer.has_times):
            sys.exit(f"faults: {writer.name}: old and new outputs are equal: {old} {new}")
        for reader in writer.readers:
            outputs.clear(self.work / "read")
            self.must(reader.command, writer)
        return cases.Known(saved, old, new, places.pages_of(out), run)

    def must(self, line, writer, plain=False):
        run = self.run(line, "none", 0, plain)
        if run.status != 0:
            sys.exit(f"faults: {writer.name}: {line}: {run.stderr}")
        return run

    def read(self, reader):
        outputs.clear(self.work / "read")
        return self.run(reader.command)

    def judge(self, case, known):
        with self.place.case(known.saved, case.fault, case.number):
            fault = case.fault if case.fault != "full" else "none"
            run = self.run(case.line(), fault, case.number, case.plain)
            self.place.after_run(case.fault, case.number, run)
            return self.check(case, known, run)

    def check(self, case, known, run):
        stands, hidden = self.look(case.writer)
        findings = [*checks.check_status(case, run),
                    *checks.check_sentence(case, run, known.run),
                    *checks.check_outputs(case, run, stands, hidden, known.old, known.new),
                    *checks.check_hidden(case, run, hidden)]
        outcome = checks.outcome_of(stands, known.old, known.new)
        if outcome == "mixed":
            for reader in case.writer.readers:
                if reader.reads[0] not in stands:
                    continue  # there is nothing to accept
                findings += checks.check_reader(reader, self.read(reader), stands, known.old,
                                                known.new)
        if hidden:
            findings += self.check_next(case, known, stands)
        return Verdict(case, outcome, findings, run)

    def check_next(self, case, known, stands):
        out = self.work / "out"
        if all(name in stands for name in known.old):  # otherwise the next run restores missing outputs
            outputs.clear(out, keep_hidden=True)
            outputs.fill(out, known.saved)
        run = self.run(case.line())
        return checks.check_next(run, *self.look(case.writer), known.new)


class Campaign:
    """All cases of a kind, and workers that run them."""

    def __init__(self, options, scratch):
        self.options = options
        self.scratch = pathlib.Path(scratch)
        self.workers = []
        self.local = threading.local()
        self.known = {}
        self.numbers = iter(range(sys.maxsize))

    def worker(self):
        """The worker of this thread. All workers read the outputs of the first one."""
        if not hasattr(self.local, "worker"):
            work = self.scratch / f"worker{next(self.numbers)}"
            work.mkdir()
            self.local.worker = Worker(self.options, work, self.options.kind)
            self.workers.append(self.local.worker)
            if self.scratch.joinpath("in").exists():
                work.joinpath("in").symlink_to("../in")
            else:
                commands.make_inputs(work, self.local.worker.run)
                work.joinpath("in").rename(self.scratch / "in")
                work.joinpath("in").symlink_to("../in")
        return self.local.worker

    def prepare(self, writer, where):
        saved = self.scratch / "saved" / writer.name / where
        saved.mkdir(parents=True)
        self.known[writer.name, where] = self.worker().prepare(writer, where, saved)

    def judge(self, case):
        return self.worker().judge(case, self.known[case.writer.name, case.where])

    def all_cases(self, pool):
        chosen = [(writer, where) for writer in commands.WRITERS
                  if re.search(self.options.only, writer.name)
                  for where in cases.WHERE[self.options.kind] if where != "new" or not writer.start]
        self.worker()
        list(pool.map(lambda both: self.prepare(*both), chosen))
        groups = [group for both in chosen
                  for group in cases.all_cases(self.options.kind, *both,
                                               self.known[both[0].name, both[1]]) if group]
        return cases.spread(groups, self.options.seed)

    def close(self):
        for worker in self.workers:
            worker.programs.close()
