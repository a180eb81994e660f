#!/usr/bin/env python3
"""Output and messages of scripts/reproduce, without running an experiment; and the paper's findings
(scripts/reproduce/paper): they hold on the paper's own numbers, each of them can fail, and every kind has its
documented condition.   reproduce.py SOURCE"""
import math
import random
import sys

from support import call, folder, read_json, source, stub, with_path, write

sys.path.insert(0, str(source / "scripts/reproduce"))
import along_path  # noqa: E402
import experiments  # noqa: E402
import findings  # noqa: E402
import laboratory as experiments_laboratory  # noqa: E402
import reproduce  # noqa: E402
import seeds  # noqa: E402
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
    return experiments.cells_of([experiments.Measured(row, row) for row in experiment["rows"]])


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
        draws = (lambda: 1e6, *[lambda: engine.randrange(1, 9)] * 20, *[lambda: engine.randrange(1000)] * 20)
        found = {findings.check(finding, [{**cell, "ours": draw()} for cell in cells])["holds"] for draw in draws}
        found |= {findings.check(finding, [{**cell, "ours": 0} for cell in cells])["holds"]} - {None}
        assert False in found, f"{name}: nothing refutes \"{finding['finding']}\": {found}"
        assert None not in found, f"{name}: \"{finding['finding']}\" finds no numbers"


def check_that_silence_proves_nothing(name, experiment):
    """No finding on recognition holds where nothing was recognized."""
    silent = [{**cell, "ours": 0} for cell in paper_cells(experiment)]
    for outcome in findings.check_all(experiment, silent):
        assert outcome["subject"] == "time" or outcome["holds"] is not True, f"{name}: {outcome['finding']}"


def places_on_path(world, query):
    """The number of places of a rendered world that the path of a query passes in one of their headings."""
    walk = next(walk for walk in world["walks"] if walk["name"] == query)
    found = set()
    for (x, y), (to_x, to_y) in zip(walk["path"], walk["path"][1:]):
        heading = math.degrees(math.atan2(to_y - y, to_x - x))
        for place in world["places"]:
            if place["floor"] == walk["floor"] and any(
                    abs(math.remainder(heading - view, 360)) <= 40 for view in place["headings"]):
                if any(math.dist((place["x"], place["y"]),
                                 (x + step / 100 * (to_x - x), y + step / 100 * (to_y - y))) <= 2.5
                       for step in range(101)):
                    found.add(place["name"])
    return len(found)


def check_that_it_can_hold(name, experiment):
    """No finding asks for more places of FAB-MAP than the path of the stand-in passes."""
    for finding in experiment["findings"]:
        measured = finding.get("where", {}).get("measure")
        if finding["kind"] != "at least" or "of" in finding or measured not in ("distinct", "FAB-MAP places"):
            continue
        for cell in findings.select(paper_cells(experiment), finding["where"]):
            world = read_json(source / f"configs/worlds/{cell['data']}.json")
            there = places_on_path(world, cell["query"])
            assert finding["low"] <= there, f"{name}: \"{finding['finding']}\": the path passes {there} places"


def check_one_value():
    """Findings with one value of a parameter are checked at the same value of ours, the best for all of them."""
    rows = ((20, 9, 3), (40, 5, 0), (60, 5, 0), (80, 9, None))  # c_l, right, wrong
    cells = [{"c_l": c_l, "measure": measure, "ours": value, **({} if value is not None else {"unmeasured": "R"})}
             for c_l, right, wrong in rows for measure, value in (("right", right), ("wrong", wrong))]
    listed = [{"finding": "F", "place": "P", "kind": "at least", "where": {"measure": "right"}, "low": 5, "one": "c_l"},
              {"finding": "G", "place": "P", "kind": "zero", "where": {"measure": "wrong"}, "one": "c_l"}]
    outcomes = findings.check_all({"kind": "sequence", "findings": listed}, cells)
    assert [outcome["holds"] for outcome in outcomes] == [True, True], outcomes
    assert [outcome["parts"][0]["settings"]["c_l"] for outcome in outcomes] == [40, 40], outcomes
    only = [cell for cell in cells if cell["c_l"] != 40 and cell["c_l"] != 60]  # one of two c_l is labeled
    outcomes = findings.check_all({"kind": "sequence", "findings": listed}, only)
    assert [outcome["holds"] for outcome in outcomes] == [True, False], outcomes


def check_bound_of_ground_truth():
    """A finding asks for at most what the ground truth has."""
    def found(ours, there):
        cells = [{"measure": "found", "ours": ours}, {"measure": "there", "ours": there}]
        return findings.check({"kind": "at least", "where": {"measure": "found"}, "low": 6, "of": "there"}, cells)["holds"]

    assert found(4, 4) is True and found(3, 4) is False and found(6, 9) is True and found(5, 9) is False
    assert found(4, None) is False, "unknown ground truth"
    assert found(0, 0) is None, "no place on the path"


def check_overlapping_times():
    """The order of times whose quartiles overlap was not measured."""
    def found(kind, *times):
        cells = [{"measure": "ms", "c_l": i, "ours": (low + high) / 2, "low": low, "high": high}
                 for i, (low, high) in enumerate(times)]
        more = {"over": ["c_l"], "where": {"measure": "ms"}} if kind == "rises with" else {
            "where": {"measure": "ms", "c_l": 0}, "than": {"c_l": 1}}
        return findings.check({"kind": kind, **more}, cells)["holds"]

    assert found("more than", (5, 7), (1, 4)) is True and found("more than", (5, 7), (1, 5)) is None
    assert found("more than", (1, 4), (5, 7)) is False
    assert found("rises with", (1, 2), (3, 4)) is True and found("rises with", (1, 2), (3, 5), (4, 6)) is None


def check_along_path():
    """Near a turn is within 3 m of it, and parts are runs of frames."""
    corner = [(float(min(i, 10)), float(max(0, i - 10)), 0.0 if i <= 10 else 90.0) for i in range(21)]  # 1 m apart
    assert [i for i, near in enumerate(along_path.near_turns(corner)) if near] == [8, 9, 10, 11, 12, 13]
    assert along_path.near_turns([]) == []
    assert along_path.parts([True, True, False, True]) == [2, 1] and along_path.parts([False]) == []

    class Data:
        description = folder / "dataset.json"
        content = {"fps": 2}

    write("poses.csv", "frame,time,x,y,heading,floor\n" + "".join(
        f"{i},{i},{x},{y},{heading},f\n" for i, (x, y, heading) in enumerate(corner)))
    write("truth.csv", "query,reference,label\n1,0,same\n2,0,same\n9,1,same\n15,2,same\n5,3,ignore\n")
    query = {"poses": "poses.csv", "place_ground_truth": {"format": "pairs", "path": "truth.csv"}}
    compared = along_path.compare(Data(), query, {
        "A": [i < 3 for i in range(21)], "B": [i in (2, 9, 10) for i in range(21)]})
    expected = {"A percent near turns": 0.0, "A percent on straight stretches": 20.0, "B percent near turns": 33.3,
                "B percent on straight stretches": 6.7, "A longest part in seconds": 1.5, "B mean part in seconds": 0.8,
                "A percent of the first third": 42.9, "B percent of the middle third": 28.6, "places on the path": 3,
                "places by both": 1, "places by A only": 0, "places by B only": 1}
    assert {key: compared[key] for key in expected} == expected, compared


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
    outcome = {"finding": "F", "place": "P", "subject": "time", "holds": False,
               "parts": [{"settings": {}, "values": [1], "fits": False}]}
    made = {"title": "Table", "findings": [outcome], "quick": False, "timing": {"elapsed_s": 3},
            "provenance": {"commit": "c", "data": []}}
    reproduce.write_page(folder / "new.md", [], [made])
    text = (folder / "new.md").read_text()
    assert "commit c." in text and "| F | P | 1 |" in text and "| Table | 0 | 1 |" in text, text


def check_seeds():
    """A finding holds over seeds if it holds in three quarters of them; its numbers are those of the part that
    holds in the fewest."""
    experiment = {"kind": "sequence", "title": "Table 8", "findings": [
        {**ZERO, "finding": "F", "kind": "falls with", "over": ["c_l"], "where": {"measure": "m"}},
        {**ZERO, "finding": "G", "kind": "at least", "low": 2, "where": {"measure": "m", "c_l": 2}},
        {**ZERO, "finding": "H", "kind": "at least", "low": 2, "where": {"measure": "n"}, "unchecked": "U"}]}
    made = []
    for ours in ((3, 2), (3, 2), (9, 1), (1, 2)):
        cells = [{"sequence": "S", "measure": "m", "c_l": c_l, "paper": paper, "ours": value}
                 for c_l, paper, value in zip((1, 2), (5, 4), ours)]
        cells.append({"sequence": "S", "measure": "n", "c_l": 1, "paper": "not stated", "ours": 7})
        made.append({"experiment": "tab8", "title": "Table 8", "quick": False, "cells": cells,
                     "findings": findings.check_all(experiment, cells), "timing": {"elapsed_s": 1.5},
                     "provenance": {"commit": "c", "data": []}})
    record = seeds.combine(experiment, made, [0, 1, 2, 3])
    assert [(one["holds"], one["hold"], one["fail"]) for one in record["findings"]] == [
        (True, 3, 1), (True, 3, 1), (True, 4, 0)], record["findings"]
    assert record["cells"][0]["ours"] == [3, 3, 9, 1] and record["timing"]["elapsed_s"] == 6
    lines = seeds.table(record)
    assert "| F | P | 5, 4 | 3 (1 to 9), 2 (1 to 2) | 3 of 4 |" in lines, lines
    assert "| H | P | as a figure | 7 | 4 of 4 |" in lines, lines
    assert seeds.combine(experiment, made[2:], [2, 3])["findings"][1]["holds"] is False, "1 of 2"
    image = seeds.figure(record)
    assert image.count("<circle") == 8 and image.count('stroke="#c33"') == 2 and "S, c_l 2" in image, image
    reproduce.write_page(folder / "page-of-seeds.md", [record], [])
    text = (folder / "page-of-seeds.md").read_text()
    assert "| recognition | 3 | 0 | 0 |" in text and "Seeds: 4." in text, text
    assert (folder / "page-of-seeds-tab8.svg").read_text() == image
    tables.write_json(folder / "tab8-seeds.json", {**record, "provenance": []})
    checked = call(sys.executable, source / "scripts/dev/check_schemas.py", "tab8-seeds.json")
    assert checked.returncode in (0, 77), (checked.stdout, checked.stderr)


def check_arguments():
    """A page has the seeds of a record, recordings have none."""
    def number(*words):
        return reproduce.arguments_of(words).seeds

    assert (number("tab4"), number("tab4", "--seeds", "3")) == (1, 3)
    assert (number("all", "--page", "p"), number("all", "--page", "p", "--quick")) == (8, 2)
    assert number("all", "--page", "p", "--data", "d") == 1
    for words in (("tab4", "--seeds", "0"), ("tab4", "--seeds", "2", "--data", "d")):
        done = call(sys.executable, source / "scripts/reproduce/reproduce.py", *words)
        assert done.returncode == 2 and "--seeds" in done.stderr, done.stderr


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
    """A page keeps the blocks without new results, and lists findings on times that do not hold."""
    every = [ZERO, {**ZERO, "finding": "G", "kind": "at least", "low": 0},
             {**ZERO, "finding": "H", "contradicted": "table 9 has 1"},
             {**ZERO, "finding": "I", "where": {"measure": "n"}}]
    found = [{"title": title, "findings": findings.check_all({"kind": "bench", "findings": listed}, cells_of([0, 1]))}
             for title, listed in (("Table 8", every), ("Table 9", [{**ZERO, "tried": "It holds idle."}]))]
    block = findings.times_block(found)
    assert block == [
        "| findings on | hold | do not hold | not measured |", "|---|---:|---:|---:|", "| time | 1 | 2 | 1 |", "",
        "| finding that does not hold | in the paper | our numbers that do not fit |", "|---|---|---|",
        "| F | P | 1 of 2 rows: c_l 2: 1 |", "| F | P | 1 of 2 rows: c_l 2: 1 |", "",
        "| experiment | hold | of |", "|---|---:|---:|", "| Table 8 | 1 | 2 |", "| Table 9 | 0 | 1 |"], block
    page = folder / write("page.md", "A\n<!-- recognition: begin -->\nkept\n<!-- recognition: end -->\nB\n"
                          "<!-- time: begin -->\nstale\n<!-- time: end -->\nC\n")
    findings.write_page(page, {"time": block})
    text = page.read_text()
    assert "\nkept\n" in text and "stale" not in text and text.endswith("| Table 9 | 0 | 1 |\n<!-- time: end -->\nC\n"), text


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
    check_that_silence_proves_nothing(path.stem, config)
    check_that_it_can_hold(path.stem, config)
check_kinds()
check_missing()
check_unmeasured()
check_page()
check_absence()
check_one_value()
check_bound_of_ground_truth()
check_overlapping_times()
check_along_path()
check_missing_query()
check_new_page()
check_seeds()
check_arguments()
