#!/usr/bin/env python3
"""One page of all reports, sweeps and comparisons of a tree.   page.py TREE.json PAGE.html"""
import html
import json
import os
import pathlib
import sys

STYLE = """body{font:15px/1.5 sans-serif;margin:2em auto;max-width:70em;padding:0 1em}
table{border-collapse:collapse;margin:1em 0}td,th{padding:.2em .8em;text-align:right}
td:first-child,th:first-child{text-align:left}thead{border-bottom:1px solid}
tbody tr:nth-child(even){background:#8882}summary{cursor:pointer}"""


def read(path):
    return json.loads(pathlib.Path(path).read_text())


def number(value):
    """A number as text for tables; empty if it was not measured."""
    if value is None:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def table(head, rows):
    """Cells are text, or pairs of a text and a link."""
    def cell(content):
        if isinstance(content, tuple):
            return f'<td><a href="{html.escape(content[1])}">{html.escape(content[0])}</a></td>'
        return f"<td>{html.escape(number(content))}</td>"

    lines = ["<table><thead><tr>" + "".join(f"<th>{html.escape(name)}</th>" for name in head)
             + "</tr></thead><tbody>"]
    lines += ["<tr>" + "".join(map(cell, row)) + "</tr>" for row in rows]
    return "\n".join([*lines, "</tbody></table>"])


def counts_of(counts):
    """Accepted pairs and places; for FAB-MAP, distinct places."""
    places = counts.get("clusters", {})
    return [counts["pairs"]["correct"], counts["pairs"]["incorrect"], places.get("correct"),
            places.get("incorrect"), counts["distinct"]]


COUNTS = ["pairs correct", "incorrect", "places correct", "incorrect", "distinct"]


def runs_of(runs, folder):
    rows = []
    for name, path in runs:
        report = read(path)
        best = report.get("metrics", {}).get("single_best", {})
        rows.append([(name, os.path.relpath(path, folder)), *counts_of(report["counts"]),
                     report["best_match"]["rate"], best.get("average_precision"),
                     best.get("recall_at_100_precision"), report["localization"]["share"]])
    return table(["run", *COUNTS, "best match correct", "average precision", "recall at 100 %",
                  "localized"], rows)


def comparison_of(name, path):
    comparison = read(path)
    frames = comparison["frames"]
    rows = [[row["metric"], row["report"], row["value"], row["difference"], row["low"],
             row["high"]] for row in comparison["metrics"]]
    first = comparison["reports"][0]["name"]
    share = 100 * comparison["bootstrap"]["confidence"]
    return (f"<details open><summary>{html.escape(name)}: differences to {html.escape(first)} over "
            f"{frames['with_match']} frames with a match, {share:g} % intervals, ground truths: "
            f"{html.escape(comparison['ground_truths'])}</summary>"
            + table(["metric", "of", "value", "difference", "from", "to"], rows) + "</details>")


def sweep_of(name, path):
    sweep = read(path)
    window, threshold = (("c_w", "t_p") if sweep["method"] == "fabmap" else
                         ("c_l", "margin" if "margin" in sweep["cells"][0] else "t_r"))
    rows = [[str(cell[window]), cell.get(threshold), *counts_of(cell["counts"])]
            for cell in sweep["cells"]]
    recommended = sweep["queries"][0]["recommended"]
    said = "nothing to recommend"
    if recommended is not None:
        best = sweep["cells"][recommended]
        said = "recommended: " + ", ".join(f"{key} {number(best[key])}"
                                           for key in (window, threshold))
    return (f"<details><summary>{html.escape(name)}: {len(rows)} cells, {html.escape(said)}"
            f"</summary>{table([window, threshold, *COUNTS], rows)}</details>")


def makers(paths):
    """The programs that computed the numbers, without duplicates."""
    found = {(by["program"], by["version"], by["commit"])
             for by in (read(path)["provenance"] for path in paths)}
    return ", ".join(f"{program} {version} ({commit})" for program, version, commit in
                     sorted(found))


def main():
    tree, page = read(sys.argv[1]), pathlib.Path(sys.argv[2])
    title = html.escape(tree["title"])
    parts = [f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title>'
             f"<style>{STYLE}</style><h1>{title}</h1>"]
    paths = []
    for section in tree["sections"]:
        parts.append(f"<h2>{html.escape(section['data'])}: {html.escape(section['query'])}</h2>")
        parts.append(runs_of(section["runs"], page.parent))
        parts += [comparison_of(*row) for row in section["comparisons"]]
        parts += ["<h3>Sweeps</h3>"] if section["sweeps"] else []
        parts += [sweep_of(*row) for row in section["sweeps"]]
        paths += [path for key in ("runs", "sweeps", "comparisons") for _, path in section[key]]
    if tree["left_out"]:
        parts.append(f"<p>Left out, since --config data=DIR was not given: "
                     f"{html.escape(', '.join(tree['left_out']))}.</p>")
    parts.append(f"<p>Made by {html.escape(makers(paths))}.</p></html>")
    page.write_text("\n".join(parts) + "\n")


if __name__ == "__main__":
    main()
