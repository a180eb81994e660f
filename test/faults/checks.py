"""Conditions after a run with a fault. Each check yields one sentence per finding."""
import re

# A failing call must fail the run, unless nothing depends on it.
NEEDED = {"create", "fopen", "write", "pwrite", "writev", "mkdir", "rename", "fsync", "fdatasync",
          "syncfs", "fallocate", "ftruncate"}
TAKES_SPACE = NEEDED - {"rename"}  # calls that a full disk can refuse
WRITES = {"write", "pwrite", "writev"}
AGAIN = {"write", "pwrite", "fsync", "fallocate", "flock"}  # calls that signals may interrupt
CLEANS_UP = {"unlink", "rmdir", "open", "opendir"}
KILLING = {"kill", "torn", "power", "power_off"}
BREAKING = {"eio", "dead", "enospc"}


def applies(fault, call):
    """Whether a fault can happen to a call."""
    return {"torn": call.name in WRITES, "shorten": call.name in WRITES,
            "eintr": call.name in AGAIN, "enospc": call.name in TAKES_SPACE}.get(fault, True)


def first_failure(run):
    return next((call for call in run.calls if call.failed), None)


def allowed_status(case, run):
    fault, failed = case.fault, first_failure(run)
    if fault in KILLING:
        return {0} if case.is_after_end else {-9}
    if fault == "interrupt":
        return {0, 130}
    if fault in BREAKING:
        return {3} if failed and failed.name in NEEDED else {0, 3}
    if fault == "full":
        return {0, 3}
    return {0}


def check_status(case, run):
    if run.status not in allowed_status(case, run):
        yield f"ended with {run.status}: {run.stderr.strip()!r}"


def error_lines(run):
    return [line for line in run.stderr.splitlines() if not line.startswith("warning: ")]


def check_sentence(case, run, expected):
    """Requires one sentence with the error and the output, or none."""
    lines = error_lines(run)
    if run.status == 0:
        if run.stderr != expected.stderr:
            yield f"says something else: {run.stderr!r}"
        if run.stdout != expected.stdout and not case.writer.has_times:
            yield f"prints something else: {run.stdout!r}"
    if run.status <= 0:
        return
    if run.stdout:
        yield f"prints a result although it failed: {run.stdout!r}"
    if len(lines) != 1 or not lines[0].startswith(f"{case.writer.program}: "):
        yield f"says no single sentence: {run.stderr!r}"
        return
    sentence = lines[0].removeprefix(f"{case.writer.program}: ")
    if run.status == 130 and sentence != "interrupted; nothing was written":
        yield f"was interrupted, but says {sentence!r}"
    if run.status == 3 and not re.search(r"out/?\b.*: can't be (written|read)", sentence):
        yield f"does not say which output can't be written: {sentence!r}"
    if re.search(r"\.vpr-(partial|old)", sentence) and "the old folder is" not in sentence:
        yield f"names a temporary: {sentence!r}"


def outcome_of(outputs, old, new):
    """One word for the state of the outputs."""
    return "old" if outputs == old else "new" if outputs == new else "mixed"


def is_set_aside(case, run, hidden):
    """Whether a folder has no name: it was being replaced on a file system that cannot exchange names,
    and the process was killed, or could not restore it and reports its location."""
    return case.plain and any(name.startswith(".vpr-old") for name in hidden) and (
        run.status < 0 or re.search(r"the old folder is out/\.vpr-old", run.stderr))


def check_outputs(case, run, outputs, hidden, old, new):
    """Old or new, each output whole; after a killed run, a mixture with the old main output."""
    for name, content in outputs.items():
        if content not in (old.get(name), new.get(name)):
            yield f"out/{name} is neither old nor new"
    for name in old:
        if name not in outputs and not is_set_aside(case, run, hidden):
            yield f"out/{name} is gone"
    outcome = outcome_of(outputs, old, new)
    if run.status == 0 and outcome != "new":
        yield f"done, but the outputs are {outcome}"
    if run.status > 0 and outcome != "old":
        changed = [name for name in new if outputs.get(name) != old.get(name)]
        untold = [name for name in changed if f"out/{name} is new" not in run.stderr
                  and not (name not in outputs and is_set_aside(case, run, hidden))]
        if untold or "nothing was written" in run.stderr:
            yield f"does not say that {', '.join(untold)} is new: {run.stderr.strip()!r}"
    main = case.writer.main
    if outcome == "mixed" and outputs.get(main) == new[main] and new[main] != old.get(main):
        yield f"the main output out/{main} is new, but not all others are"


def may_leave(fault, run):
    """Whether a temporary may stay until the next run."""
    failed = first_failure(run)
    return fault in KILLING or fault == "dead" or (failed and failed.name in CLEANS_UP)


def check_hidden(case, run, hidden):
    if hidden and not may_leave(case.fault, run):
        yield f"{len(hidden)} temporaries are left"


def check_reader(reader, run, outputs, old, new):
    """A reader accepts only complete outputs: all that it reads is old, or all is new."""
    parts = [{name: state.get(name) for name in reader.reads} for state in (outputs, old, new)]
    whole = parts[0] in parts[1:] and None not in parts[0].values()
    if whole and run.status != 0:
        yield f"{reader.command}: refuses whole outputs: {run.stderr.strip()!r}"
    if not whole and run.status == 0:
        yield f"{reader.command}: accepts {parts[0]}, neither old nor new"
    if not whole and run.status not in (0, 3, 4):
        yield f"{reader.command}: ends with {run.status}: {run.stderr.strip()!r}"


def check_next(run, outputs, hidden, new):
    """The same command without a fault succeeds and removes all temporaries."""
    if run.status != 0 or outputs != new:
        yield f"the next run ends with {run.status}: {run.stderr.strip()!r}"
    if hidden:
        yield f"the next run leaves {len(hidden)} temporaries"
