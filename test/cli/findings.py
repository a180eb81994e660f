#!/usr/bin/env python3
"""The paper's findings (configs/paper): they hold on the paper's own numbers, each of them can
fail, and every kind has its documented condition.   findings.py SOURCE"""
import json
import pathlib
import random
import sys
import tempfile

source = pathlib.Path(sys.argv[1])
sys.dont_write_bytecode = True
sys.path.insert(0, str(source / "scripts/reproduce"))
import experiments as paper  # noqa: E402
import findings  # noqa: E402


def check(condition, message):
    if not condition:
        sys.exit(f"findings: {message}")


def paper_cells(experiment):
    """The paper's numbers as an experiment writes them, with themselves as ours."""
    return paper.cells_of([paper.Measured(row, row, {"low": 0, "high": 0}) for row in experiment["rows"]])


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
        if "needs" in finding:
            check(findings.check(finding, cells)["holds"] is None, f"{name}: {finding['finding']}")
            continue
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


ZERO = {"finding": "F", "place": "P", "kind": "zero", "where": {"measure": "m"}}
COUNTS = {"kind": "sequence", "title": "Table 8"}


def check_missing():
    """Findings without measurements neither hold nor fail, and state the reason."""
    lacking = {**ZERO, "where": {"measure": "m", "c_l": [1, 2, 3]}}  # there is no c_l of 3
    against = {**ZERO, "kind": "more than", "than": {"c_l": 3}}
    wrong = {**ZERO, "contradicted": "table 9 has 1"}
    phone = {**ZERO, "needs": "a phone"}
    tried = {**ZERO, "tried": "It holds without G."}
    outcomes = findings.check_all({**COUNTS, "findings": [lacking, ZERO, against, wrong, phone, tried]},
                                  cells_of([0, 1]))
    check([outcome["holds"] for outcome in outcomes] == [None, False, None, False, None, False], outcomes)
    check(findings.summary(outcomes) == {"hold": 0, "fail": 2, "not_measured": 3}, outcomes)
    check(findings.summary(outcomes, "time") == {"hold": 0, "fail": 0, "not_measured": 0}, outcomes)
    check(findings.lines(outcomes) == [
        "- F (P): not measured (there are no such numbers)",
        "- F (P): does not hold (ours 1 of 2 rows: c_l 2: 1)",
        "- F (P): not measured (there are no such numbers)",
        "- F (P): not counted, since table 9 has 1; does not hold (ours 1 of 2 rows: c_l 2: 1)",
        "- F (P): not measured (needs a phone)",
        "- F (P): does not hold (ours 1 of 2 rows: c_l 2: 1). It holds without G.",
        "", "0 of 2 findings hold, 3 not measured."], findings.lines(outcomes))


def check_unmeasured():
    """A series with a number that was not measured is not checked on the others."""
    cells = cells_of([1, 2]) + [{"measure": "m", "c_l": 4, "ours": None, "unmeasured": "it is too long"}]
    series = {**ZERO, "kind": "rises with", "over": ["c_l"]}
    pair = {**ZERO, "kind": "more than", "where": {"measure": "m", "c_l": 2}, "than": {"c_l": 4}}
    for finding in (series, pair, ZERO):
        found = findings.check(finding, cells)
        check(found == {"holds": None, "reason": "it is too long", "parts": []}, found)
    fine = {**ZERO, "kind": "at least", "where": {"measure": "m", "c_l": [1, 2]}, "low": 1}
    check(findings.check(fine, cells)["holds"], "the measured numbers")


def check_page():
    """The page lists findings that do not hold with their numbers, and counts the others."""
    every = [ZERO, {**ZERO, "finding": "G", "kind": "at least", "low": 0},
             {**ZERO, "finding": "H", "contradicted": "table 9 has 1"},
             {**ZERO, "finding": "I", "where": {"measure": "n"}}]
    found = [{"title": title, "findings": findings.check_all(
        {"kind": kind, "findings": listed}, cells_of([0, 1]))}
        for title, kind, listed in (("Table 8", "sequence", every),
                                    ("Table 9", "bench", [{**ZERO, "tried": "It holds idle."}]))]
    head = ["| finding | in the paper | our numbers that do not fit |", "|---|---|---|"]
    failing = findings.failing(found)
    check(failing == [
        "| findings on | hold | do not hold | not measured |", "|---|---:|---:|---:|",
        "| recognition | 1 | 1 | 1 |", "| time | 0 | 1 | 0 |",
        "", "### Findings on recognition that do not hold", "", *head,
        "| F | P | 1 of 2 rows: c_l 2: 1 |",
        "", "### Findings on time that do not hold", "", *head,
        "| F | P | 1 of 2 rows: c_l 2: 1 |"], failing)
    holding = findings.holding(found)
    check(holding == [
        "| experiment | hold | of |", "|---|---:|---:|", "| Table 8 | 1 | 2 |", "| Table 9 | 0 | 1 |"], holding)
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder) / "page.md"
        page.write_text("A\n<!-- failing: begin -->\nstale\n<!-- failing: end -->\nB\n"
                        "<!-- holding: begin -->\n<!-- holding: end -->\nC\n")
        findings.write_page(page, found, "Today.")
        text = page.read_text()
    check(text.startswith("A\n<!-- failing: begin -->\nToday.\n\n| findings on") and "stale" not in text
          and text.endswith("| Table 9 | 0 | 1 |\n<!-- holding: end -->\nC\n"), text)


def main():
    configs = {path.stem: json.loads(path.read_text())
                   for path in sorted((source / "configs/paper").glob("*.json"))}
    for name, experiment in configs.items():
        check_on_the_paper(name, experiment)
        check_that_it_can_fail(name, experiment)
    check_kinds()
    check_missing()
    check_unmeasured()
    check_page()


main()
