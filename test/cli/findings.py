#!/usr/bin/env python3
"""The paper's findings (configs/paper): they hold on the paper's own numbers, each of them can
fail, and every kind has its documented condition.   findings.py SOURCE"""
import json
import pathlib
import random
import sys

source = pathlib.Path(sys.argv[1])
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "scripts/reproduce"))
import findings  # noqa: E402

SETTINGS = ("sequence", "data", "query", "c_w", "t_p", "c_l", "t_r", "method", "what", "our_work",
            "frames", "query_frames", "places")


def check(condition, message):
    if not condition:
        sys.exit(f"findings: {message}")


def paper_cells(experiment):
    """The paper's numbers as an experiment writes them, with themselves as ours."""
    return [{**{key: row[key] for key in row if key in SETTINGS},
             "measure": measure, "paper": row[measure], "ours": row[measure]}
            for row in experiment["rows"] for measure in row if measure not in SETTINGS]


def check_on_the_paper(name, experiment):
    """Holds, unless the data declare that the table contradicts it or has no numbers."""
    for finding in experiment["findings"]:
        holds = findings.check(finding, paper_cells(experiment), "paper")["holds"]
        expected = None if "unchecked" in finding else "contradicted" not in finding
        check(holds is expected, f"{name}: \"{finding['finding']}\" on the paper's: {holds}")


def check_that_it_can_fail(name, experiment):
    """Some numbers in place of the paper's refute it, and some confirm it."""
    engine = random.Random(1)
    cells = paper_cells(experiment)
    for finding in experiment["findings"]:
        found = set()
        for numbers in (lambda: 0, lambda: 1e6, lambda: engine.randrange(3), *[
                lambda: engine.randrange(1000)] * 20):
            found.add(findings.check(
                finding, [{**cell, "ours": numbers()} for cell in cells])["holds"])
        check(False in found, f"{name}: nothing refutes \"{finding['finding']}\": {found}")
        check(None not in found, f"{name}: \"{finding['finding']}\" finds no numbers")


def cells_of(values, **settings):
    """Cells of a measure over c_l 1, 2, 4, ..."""
    return [{**settings, "measure": "m", "c_l": 2 ** i, "ours": value}
            for i, value in enumerate(values)]


def holds(kind, values, other=None, **more):
    cells = cells_of(values, t_r=1) + cells_of(other or [], t_r=2)
    where = {"measure": "m", "t_r": 1}
    return findings.check({"kind": kind, "where": where, **more}, cells)["holds"]


def check_kinds():
    """Numbers at the bounds, on which each kind holds or does not hold, computed by hand."""
    over, than = {"over": ["c_l"]}, {"than": {"t_r": 2}}
    tried = {
        "zero": ([([0, 0], None)], [([0, 1], None)], {}),
        "at least": ([([5, 9], None)], [([5, 4], None)], {"low": 5}),
        "falls with": ([([3, 3, 1], None)], [([3, 3, 3], None), ([3, 4, 1], None)], over),
        "never rises with": ([([3, 3], None)], [([3, 3, 4], None)], over),
        "rises with": ([([1, 2], None)], [([1, 1], None)], over),
        "grows linearly with": ([([3, 6, 12], None), ([1, 2.2], None)],
                                [([1, 2.3], None), ([1, 1.7], None), ([0, 0], None)], over),
        "independent of": ([([4, 4.4], None)], [([4, 4.5], None), ([4, 3.5], None)], over),
        "more than": ([([2, 3], [1, 2])], [([2, 3], [1, 3])], than),
        "not more than": ([([1, 3], [1, 4])], [([1, 3], [1, 2])], than),
        "ratio": ([([10, 1], [5, 1])], [([10, 3], [5, 1]), ([1, 1], [0, 1])],
                  {**than, "low": 1, "high": 2}),
        "share of": ([([1, 2], [3, 6])], [([1, 3], [3, 6]), ([0], [0])], {**than, "high": 0.25}),
    }
    check(tried.keys() == findings.KINDS.keys(), f"kinds: {findings.KINDS.keys() - tried.keys()}")
    for kind, (right, wrong, more) in tried.items():
        for values, other in right:
            check(holds(kind, values, other, **more) is True, f"{kind}: {values}, {other}")
        for values, other in wrong:
            check(holds(kind, values, other, **more) is False, f"{kind}: {values}, {other}")
    check(holds("zero", [0, 7], rows=1) is True, "one row of two is enough")
    check(holds("zero", [7, 7], rows=1) is False, "no row of two is too few")


def check_missing():
    """Findings without measurements neither hold nor fail, and are not counted."""
    where = {"measure": "m", "c_l": [1, 2, 3]}  # there is no c_l of 3
    lacking = {"finding": "F", "place": "P", "kind": "zero", "where": where}
    full = {**lacking, "where": {"measure": "m"}}
    against = {**full, "kind": "more than", "than": {"c_l": 3}}
    wrong = {**full, "contradicted": "table 9 has 1"}
    outcomes = findings.check_all([lacking, full, against, wrong], cells_of([0, 1]))
    check([outcome["holds"] for outcome in outcomes] == [None, False, None, False], outcomes)
    check(findings.summary(outcomes) == {"hold": 0, "of": 1}, findings.summary(outcomes))
    check(findings.lines(outcomes) == [
        "- F (P): not measured",
        "- F (P): does not hold (ours 1 of 2 rows: c_l 2: 1)",
        "- F (P): not measured",
        "- F (P): not counted, since table 9 has 1; does not hold (ours 1 of 2 rows: c_l 2: 1)",
        "", "0 of 1 findings hold."], findings.lines(outcomes))


def check_overview():
    """The page lists failing findings with the numbers that do not fit, then those that hold."""
    zero = {"finding": "F", "place": "P", "kind": "zero", "where": {"measure": "m"}}
    holding = {**zero, "finding": "G", "kind": "at least", "low": 0}
    wrong = {**zero, "finding": "H", "contradicted": "table 9 has 1"}
    missing = {**zero, "finding": "I", "where": {"measure": "n"}}
    outcomes = findings.check_all([zero, holding, wrong, missing], cells_of([0, 1]))
    page = findings.overview([("Table 8", outcomes), ("Table 9", outcomes[1:2])])
    check(page["failing"] == [
        "2 of 3 findings hold on rendered stand-ins and generated codes.", "",
        "| finding | in the paper | our numbers that do not fit |", "|---|---|---|",
        "| F | P | 1 of 2 rows: c_l 2: 1 |"], page["failing"])
    check(page["holding"] == [
        "### Table 8", "", "1 of 2:", "", "- G (P)", "- not measured: I (P)",
        "- not counted, since table 9 has 1: H (P)", "", "### Table 9", "", "1 of 1:", "", "- G (P)"],
          page["holding"])


def main():
    experiments = {path.stem: json.loads(path.read_text())
                   for path in sorted((source / "configs/paper").glob("*.json"))}
    for name, experiment in experiments.items():
        check_on_the_paper(name, experiment)
        check_that_it_can_fail(name, experiment)
    check_kinds()
    check_missing()
    check_overview()


main()
