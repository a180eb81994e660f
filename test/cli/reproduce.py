#!/usr/bin/env python3
"""Output and messages of scripts/reproduce, without running an experiment; and the paper's findings
(scripts/reproduce/paper): they hold on the paper's own numbers, each of them can fail, and every kind has its
documented condition.   reproduce.py SOURCE"""
import random
import sys

from support import call, folder, read_json, source, stub, with_path, write

sys.path.insert(0, str(source / "scripts/reproduce"))
import experiments  # noqa: E402
import findings  # noqa: E402
import laboratory as experiments_laboratory  # noqa: E402
import reproduce  # noqa: E402
import tables  # noqa: E402


def check_mistyped_name():
    """A mistyped name is reported before anything is installed or built."""
    for program in ("cmake", "apt-get", "dpkg-query"):
        stub(folder / program, "echo started >&2; exit 1")
    environment = with_path(folder)
    environment.pop("VPR_BIN", None)
    done = call(source / "scripts/reproduce/run.sh", "nosuch", env=environment)
    assert done.returncode == 2, f"nosuch ended with {done.returncode}"
    assert "started" not in done.stderr, "nosuch began to build"
    assert "nosuch" in done.stderr and "tab4" in done.stderr, f"nosuch: {done.stderr}"


def result_of(name, cells, outcomes, machine):
    maker = {"program": "vpr-tune", "version": "0.1.0", "commit": "unknown", "seed": 1}
    provenance = {**maker, "program": "reproduce.py", "inputs_sha256": "0" * 64, "programs": [maker],
                  "data": [{"name": "d", "title": "D", "stand_in": True, "dataset_sha256": "0" * 64}],
                  "databases": {"d.fastable": "xxh3:" + "0" * 32}}
    return {"schema": "vpr.reproduction/3", "experiment": name, "title": "Table", "paper": "P", "data": ["D"],
            "quick": False, "cells": cells, "findings": outcomes, "summary": findings.summary(outcomes),
            "notes": ["A note."], "provenance": provenance, **machine, "timing": {"elapsed_s": 1.5}}


def check_files():
    """JSON fits its schema, and times keep their quartiles and the paper's grid."""
    times = experiments.cells_of(
        [experiments.Measured(
            {"what": f"FastABLE over OpenABLE, {phone}", "our_work": "fastable", "frames": frames,
             "c_l": 20, "times": paper}, {"times": 12.5} if frames < 2000 else {},
            {"low": 11.0, "high": 14.0}, "it is too large")
         for phone, papers in (("A", (11.4, 9.8, 9.3)), ("B", (15.3, 11.0, 9.7)))
         for frames, paper in zip((500, 1000, 2000), papers)])
    written = result_of("tab6", times, [], {"machine": {"host": "h", "threads": 1, "simd": "AVX2"}})
    tables.write_json(folder / "tab6.json", written)
    tables.write_markdown(folder / "tab6.md", written, "bench")
    lines = (folder / "tab6.md").read_text().splitlines()
    assert "| c_l | whose | 500 | 1000 | 2000 |" in lines, lines
    assert "| 20 | ours: fastable | 12.5 (11 to 14) | 12.5 (11 to 14) | not measured |" in lines, lines
    assert "| 20 | paper: FastABLE over OpenABLE, A | 11.4 | 9.8 | 9.3 |" in lines, lines
    assert len(lines) == 16 and lines[-1] == "0 of 0 findings hold.", lines

    counts = experiments.cells_of([experiments.Measured(
        {"sequence": "S", "data": "d", "query": "q", "c_l": 40, "recognitions": 3, "distinct": 2},
        {"recognitions": 5}, reason="it has no labels")])
    outcomes = findings.check_all({"kind": "sequence", "findings": [
        {"finding": "F", "place": "table 4", "kind": "zero", "where": {"measure": "recognitions"}},
        {"finding": "G", "place": "table 4", "kind": "zero", "where": {"measure": "distinct"}},
        {"finding": "H", "place": "table 4", "kind": "falls with", "where": {"measure": "recognitions"},
         "over": ["c_l"], "contradicted": "table 4 rises"}]}, [{**counts[0], "c_l": 20}, *counts])
    written = result_of("tab4", counts, outcomes, {})
    tables.write_json(folder / "tab4.json", written)
    tables.write_markdown(folder / "tab4.md", written, "sequence")
    text = (folder / "tab4.md").read_text()
    assert "| S | 40 | 5 (3) | not measured (2) |" in text, text
    assert "\nA note.\n\nThe paper's findings:\n" in text, text
    assert text.endswith("\n- F (table 4): does not hold (ours c_l 20: 5; c_l 40: 5)\n"
                        "- G (table 4): not measured (it has no labels)\n- H (table 4): not counted, "
                        "since table 4 rises; does not hold (ours 5, 5)\n\n"
                        "0 of 1 findings hold, 1 not measured.\n"), text
    checked = call(sys.executable, source / "scripts/dev/check_schemas.py", "tab4.json", "tab6.json")
    if checked.returncode != 0:
        print(checked.stdout, checked.stderr)
        sys.exit(checked.returncode)  # 77: cannot be checked here


def check_times():
    """A ratio compares the medians of two works, with the extremes of their quartiles; a rate
    belongs to the sum of two."""
    settings = {"frames": 500, "c_l": 20}
    measured = [{"work": work, "parameters": {**settings, "query_frames": 1000},
                 "median_ms": median, "lower_quartile_ms": low, "upper_quartile_ms": high}
                for work, low, median, high in (("openable", 8, 10, 12),
                                                ("fastable-online", 1, 2, 4))]

    def found(**row):
        times = experiments.times_of({"what": "W", **settings, **row}, measured, ["1000 is too large", "no"])
        return times.ours, times.spread, times.reason

    ratio = "openable / fastable-online"
    assert found(our_work=ratio, times=9.2) == ({"times": 5}, {"low": 2, "high": 12}, ""), "ratio"
    assert found(our_work="openable", ms=1) == ({"ms": 10}, {"low": 8, "high": 12}, ""), "time"
    rate = found(our_work="openable + fastable-online", fps="around 5")
    assert rate == ({"fps": 83.33}, {"low": 62.5, "high": 111.1}, ""), rate
    assert found(our_work=ratio, frames=1000, times=1) == ({}, {}, "1000 is too large"), "no such size"
    assert found(our_work="lsh", ms=1) == ({}, {}, "1000 is too large; no"), "no such work"
    assert found(our_work="openable", ms=1, unmeasured="R") == ({}, {}, "R"), "not measurable"


def check_quick():
    """Quick measurements are short, and omit large databases."""
    omitted = []
    command = experiments.quick_command(
        ["matching", "--databases", "1000,100000", "--c-l", "300", "--seconds", "1"], omitted)
    assert command == ["matching", "--databases", "1000", "--c-l", "300", "--seconds",
                      experiments.QUICK_SECONDS], command
    assert omitted == ["100000 database frames, because of --quick"], omitted


def check_counts():
    """Recognitions of a sequence method are judged by their place; without labels there are totals."""
    one_by_one = {"correct": 5, "incorrect": 3, "ignored": 2}
    places = {"correct": 1, "incorrect": 2, "ignored": 0}
    by_place = {"correct": 7, "incorrect": 3, "ignored": 0}
    assert experiments.measures({"pairs": one_by_one, "distinct": 1}) == {
        "recognitions": 10, "correct": 5, "incorrect": 3, "distinct": 1}, "FAB-MAP"
    totals = {"recognitions": 10, "places in total": 3}
    assert experiments.measures({"pairs": one_by_one, "clusters": places}) == totals, "no labels"
    assert experiments.measures({"pairs": one_by_one, "clusters": places,
                                "pairs_by_cluster": by_place}) == {
        **totals, "correct recognitions": 7, "incorrect recognitions": 3, "correct places": 1,
        "incorrect places": 2}, "by place"


def check_experiments():
    """Each experiment has its turn, and common settings quote the same number of the paper (tables take precedence)."""
    names = {path.stem for path in (source / "scripts/reproduce/paper").glob("*.json")}
    assert set(reproduce.ORDER) == names, names ^ set(reproduce.ORDER)
    rows = {name: read_json(source / f"scripts/reproduce/paper/{name}.json")["rows"]
            for name in ("tab1", "tab2", "tab4", "figures")}
    of = {}
    for name in ("tab1", "tab2"):
        for row in rows[name]:
            of[row["data"], row["query"], "c_w", row["c_w"], row["t_p"]] = row["distinct"]
    for row in rows["tab4"]:
        of[row["data"], row["query"], "c_l", row["c_l"], row["t_r"]] = row["correct places"]
    compared = 0
    for row in rows["figures"]:
        for column, window, threshold in (("FAB-MAP places", "c_w", "t_p"),
                                          ("OpenABLE places", "c_l", "t_r")):
            key = row["data"], row["query"], window, row[window], row[threshold]
            if key in of:
                compared += 1
                assert row[column] == of[key], f"figures: {key}: {row[column]}, table: {of[key]}"
    assert compared == 5, f"{compared} numbers of figures stand in tables"


def paper_cells(experiment):
    """The paper's numbers as an experiment writes them, with themselves as ours."""
    return experiments.cells_of([experiments.Measured(row, row, {"low": 0, "high": 0}) for row in experiment["rows"]])


def check_on_the_paper(name, experiment):
    """Holds, unless the data declare that the table contradicts it or has no numbers."""
    for finding in experiment["findings"]:
        holds = findings.check(finding, paper_cells(experiment), "paper")["holds"]
        expected = None if "unchecked" in finding else "contradicted" not in finding
        assert holds is expected, f"{name}: \"{finding['finding']}\" on the paper's: {holds}"


def check_that_it_can_fail(name, experiment):
    """Some numbers in place of the paper's refute it, and some confirm it."""
    engine = random.Random(1)
    cells = paper_cells(experiment)
    for finding in experiment["findings"]:
        if "needs" in finding:
            assert findings.check(finding, cells)["holds"] is None, f"{name}: {finding['finding']}"
            continue
        draws = (lambda: 1e6, lambda: engine.randrange(3), *[lambda: engine.randrange(1000)] * 20)
        found = {findings.check(finding, [{**cell, "ours": draw()} for cell in cells])["holds"] for draw in draws}
        assert False in found, f"{name}: nothing refutes \"{finding['finding']}\": {found}"
        assert None not in found, f"{name}: \"{finding['finding']}\" finds no numbers"


def check_absence():
    """That nothing is wrong is a finding only where something is right; rows without both do not count."""
    def cells(*rows):
        return [{"c_l": c_l, "measure": measure, "ours": value} for c_l, right, wrong in rows
                for measure, value in (("right", right), ("wrong", wrong))]

    none = {"kind": "zero", "where": {"measure": "wrong"}}
    falling = {"kind": "never rises with", "where": {"measure": "wrong"}, "over": ["c_l"]}
    for finding in (none, falling):
        silent = findings.check(finding, cells((1, 0, 0), (2, 0, 0)))
        assert (silent["holds"], silent["reason"]) == (None, "nothing was recognized"), silent
        assert findings.check(finding, cells((1, 3, 0), (2, 0, 0)))["holds"] is True
    assert len(findings.check(none, cells((1, 3, 0), (2, 0, 0)))["parts"]) == 1
    assert findings.check({**none, "rows": 2}, cells((1, 3, 0), (2, 0, 0)))["holds"] is True
    assert findings.check(none, cells((1, 3, 0), (2, 0, 1)))["holds"] is False
    tried = {"kind": "sequence", "findings": [{"finding": "F", "place": "P", **none, "tried": "T"}]}
    for is_stand_in in (True, False):
        [outcome] = findings.check_all(tried, cells((1, 3, 1)), is_stand_in)
        assert ("T" in findings.line(outcome)) == is_stand_in, outcome
        assert findings.failing_lines([{"findings": [outcome]}]) == [f"- {findings.line(outcome)}"]


def check_missing_query():
    """A table is made from the recordings that are there."""
    class Data:
        content = {"queries": [{"name": "short"}]}
        lacks = experiments_laboratory.DataSet.lacks

    class Laboratory:
        def data(self, name):
            return Data()

        def sweep(self, method, name, query, grids):
            assert query == "short", query
            return {(1, 0.5): {"counts": {"pairs": {"correct": 5, "incorrect": 0, "ignored": 0}, "distinct": 2}}}

    rows = [{"sequence": query, "data": "d", "query": query, "c_w": 1, "t_p": 0.5, "distinct": 3}
            for query in ("short", "long")]
    measured = experiments.run_grid({"kind": "fabmap", "rows": rows}, Laboratory())
    assert [one.ours.get("distinct") for one in measured] == [2, None], measured
    assert measured[1].reason == "the recordings have no query long", measured[1]


def check_new_page():
    """A page that does not exist is made."""
    outcome = {"finding": "F", "place": "P", "subject": "recognition", "holds": False,
               "parts": [{"settings": {}, "values": [1], "fits": False}]}
    findings.write_page(folder / "new.md", [{"title": "Table", "findings": [outcome]}], "Context.")
    text = (folder / "new.md").read_text()
    assert "Context." in text and "| F | P | 1 |" in text and "| Table | 0 | 1 |" in text, text


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
    assert tried.keys() == findings.KINDS.keys(), f"kinds: {findings.KINDS.keys() - tried.keys()}"
    for kind, (right, wrong, more) in tried.items():
        for values, other in right:
            assert holds(kind, values, other, **more) is True, f"{kind}: {values}, {other}"
        for values, other in wrong:
            assert holds(kind, values, other, **more) is False, f"{kind}: {values}, {other}"
    assert holds("zero", [0, 7], rows=1) is True, "one row of two is enough"
    assert holds("zero", [7, 7], rows=1) is False, "no row of two is too few"


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
    assert [outcome["holds"] for outcome in outcomes] == [None, False, None, False, None, False], outcomes
    assert findings.summary(outcomes) == {"hold": 0, "fail": 2, "not_measured": 3}, outcomes
    assert findings.summary(outcomes, "time") == {"hold": 0, "fail": 0, "not_measured": 0}, outcomes
    assert findings.lines(outcomes) == [
        "- F (P): not measured (there are no such numbers)",
        "- F (P): does not hold (ours 1 of 2 rows: c_l 2: 1)",
        "- F (P): not measured (there are no such numbers)",
        "- F (P): not counted, since table 9 has 1; does not hold (ours 1 of 2 rows: c_l 2: 1)",
        "- F (P): not measured (needs a phone)",
        "- F (P): does not hold (ours 1 of 2 rows: c_l 2: 1). It holds without G.",
        "", "0 of 2 findings hold, 3 not measured."], findings.lines(outcomes)


def check_unmeasured():
    """A series with a number that was not measured is not checked on the others."""
    cells = cells_of([1, 2]) + [{"measure": "m", "c_l": 4, "ours": None, "unmeasured": "it is too long"}]
    series = {**ZERO, "kind": "rises with", "over": ["c_l"]}
    pair = {**ZERO, "kind": "more than", "where": {"measure": "m", "c_l": 2}, "than": {"c_l": 4}}
    for finding in (series, pair, ZERO):
        found = findings.check(finding, cells)
        assert found == {"holds": None, "reason": "it is too long", "parts": []}, found
    fine = {**ZERO, "kind": "at least", "where": {"measure": "m", "c_l": [1, 2]}, "low": 1}
    assert findings.check(fine, cells)["holds"], "the measured numbers"


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
    assert failing == [
        "| findings on | hold | do not hold | not measured |", "|---|---:|---:|---:|",
        "| recognition | 1 | 1 | 1 |", "| time | 0 | 1 | 0 |",
        "", "### Findings on recognition that do not hold", "", *head,
        "| F | P | 1 of 2 rows: c_l 2: 1 |",
        "", "### Findings on time that do not hold", "", *head,
        "| F | P | 1 of 2 rows: c_l 2: 1 |"], failing
    holding = findings.holding(found)
    assert holding == [
        "| experiment | hold | of |", "|---|---:|---:|", "| Table 8 | 1 | 2 |", "| Table 9 | 0 | 1 |"], (
        holding)
    page = folder / write("page.md", "A\n<!-- failing: begin -->\nstale\n<!-- failing: end -->\nB\n"
                          "<!-- holding: begin -->\n<!-- holding: end -->\nC\n")
    findings.write_page(page, found, "Today.")
    text = page.read_text()
    assert (text.startswith("A\n<!-- failing: begin -->\nToday.\n\n| findings on") and "stale" not in text
          and text.endswith("| Table 9 | 0 | 1 |\n<!-- holding: end -->\nC\n")), text


check_mistyped_name()
check_times()
check_quick()
check_counts()
check_experiments()
check_files()
for path in sorted((source / "scripts/reproduce/paper").glob("*.json")):
    config = read_json(path)
    check_on_the_paper(path.stem, config)
    check_that_it_can_fail(path.stem, config)
check_kinds()
check_missing()
check_unmeasured()
check_page()
check_absence()
check_missing_query()
check_new_page()
