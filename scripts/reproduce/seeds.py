"""Several renderings of the same stand-ins with other seeds: in how many of them each finding holds, and the
spread of our numbers.

A finding holds if it holds in at least three quarters of the seeds, 6 of 8."""
import html
import json
import math
import statistics

import findings

NEEDED = 0.75  # of the seeds


def combine(experiment, results, seeds):
    """One record of an experiment from its results by seed. Each number of ours is a list."""
    cells = [{**{key: value for key, value in one[0].items() if key not in ("ours", "low", "high", "unmeasured")},
              "ours": [cell["ours"] for cell in one]} for one in zip(*(result["cells"] for result in results))]
    listed = [outcome_of(finding, results[0]["cells"], outcomes) for finding, *outcomes in zip(
        experiment["findings"], *(result["findings"] for result in results))]
    return {"schema": "vpr.reproduction-seeds/1", "experiment": results[0]["experiment"],
            "title": results[0]["title"], "quick": results[0]["quick"], "seeds": seeds, "cells": cells,
            "findings": listed, "provenance": [result["provenance"] for result in results],
            "timing": {"elapsed_s": round(sum(result["timing"]["elapsed_s"] for result in results), 1)}}


def outcome_of(finding, cells, outcomes):
    """A finding over all seeds, with the numbers of the part that holds in the fewest."""
    held = [outcome["holds"] for outcome in outcomes]
    count = {"hold": held.count(True), "fail": held.count(False), "not_measured": held.count(None)}
    needed = math.ceil(NEEDED * len(held))
    holds = count["hold"] >= needed or (None if count["hold"] + count["not_measured"] >= needed else False)
    words = {key: outcomes[0][key] for key in ("finding", "place", "subject", "contradicted", "unchecked", "tried")
             if key in outcomes[0]}
    return {**words, "holds": holds, **count, **numbers(finding, cells, outcomes)}


def part_key(finding, part):
    """What parts of different seeds have in common."""
    return json.dumps({key: value for key, value in part["settings"].items() if key != finding.get("one")})


def numbers(finding, cells, outcomes):
    """The paper's numbers and ours as text."""
    ours = {}
    for outcome in outcomes:
        for part in outcome["parts"]:
            ours.setdefault(part_key(finding, part), []).append(part)
    if not ours:
        return {"paper": "", "ours": ""}
    key, parts = min(ours.items(), key=lambda item: sum(part["fits"] for part in item[1]))
    paper = {part_key(finding, part): part for part in reversed(findings.check(finding, cells, "paper")["parts"])}
    settings = [json.loads(other) for other in ours]
    label = findings.name(json.loads(key), settings)
    texts = {"paper": texts_of([paper[key]]) if key in paper else "as a figure", "ours": texts_of(parts)}
    return {name: f"{label}: {text}" if label and name == "ours" else text for name, text in texts.items()}


def texts_of(parts):
    sides = [", ".join(spread(column) for column in zip(*(part[side] for part in parts)))
             for side in ("values", "than") if side in parts[0]]
    return " against ".join(sides)


def spread(values):
    """Median, and range if there is one."""
    median = f"{statistics.median(values):.4g}"
    return median if min(values) == max(values) else f"{median} ({min(values):.4g} to {max(values):.4g})"


def table(record):
    """All counted findings of an experiment, as Markdown."""
    lines = [f"### {record['title']}", "", f"Seeds: {len(record['seeds'])}.", "",
             "| finding | in the paper | the paper's number | ours: median (range) | seeds that hold |",
             "|---|---|---|---|---:|"]
    for outcome in findings.counted(record["findings"]):
        seeds = outcome["hold"] + outcome["fail"] + outcome["not_measured"]
        missing = f", {outcome['not_measured']} not measured" if outcome["not_measured"] else ""
        bold = "" if outcome["holds"] else "**"
        lines.append(f"| {outcome['finding']} | {outcome['place']} | {outcome['paper']} | {outcome['ours']} | "
                     f"{bold}{outcome['hold']} of {seeds}{bold}{missing} |")
    return lines


ROW, PANEL, LEFT, TOP, LABELS = 26, 130, 70, 28, 190  # pixels of a figure


def figure(record):
    """An SVG image with a panel per measure: the paper's numbers as lines, ours as a point per seed."""
    named = [cell for cell in record["cells"] if findings.number(cell["paper"]) is not None]
    measures = list(dict.fromkeys(cell["measure"] for cell in named))
    rows = list(dict.fromkeys(row_name(cell) for cell in named))
    width, height = LEFT + ROW * len(rows) + 20, TOP + (PANEL + TOP) * len(measures) + LABELS
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
             'font-family="sans-serif" font-size="11">', f'<rect width="{width}" height="{height}" fill="white"/>']
    for panel, measure in enumerate(measures):
        cells = [cell for cell in named if cell["measure"] == measure]
        top = TOP + panel * (PANEL + TOP)
        most = max(value for cell in cells for value in (findings.number(cell["paper"]), *cell["ours"], 1)
                   if value is not None)

        def y(value, top=top, most=most):
            return top + PANEL - PANEL * math.sqrt(max(value, 0) / most)

        parts.append(f'<text x="{LEFT}" y="{top - 8}" font-weight="bold">{html.escape(measure)}</text>')
        for tick in sorted({0, round(most / 16), round(most / 4), round(most)}):
            parts.append(f'<path d="M{LEFT} {y(tick):.1f}H{width - 20}" stroke="#ddd"/><text x="{LEFT - 6}" '
                         f'y="{y(tick) + 4:.1f}" text-anchor="end">{tick}</text>')
        for cell in cells:
            x = LEFT + ROW * (rows.index(row_name(cell)) + 0.5)
            parts.append(f'<path d="M{x - 9:.1f} {y(findings.number(cell["paper"])):.1f}h18" stroke="#c33" '
                         'stroke-width="2.5"/>')
            values = [value for value in cell["ours"] if value is not None]
            for index, value in enumerate(values):
                shift = 10 * ((index + 0.5) / len(values) - 0.5)
                parts.append(f'<circle cx="{x + shift:.1f}" cy="{y(value):.1f}" r="2.5" fill="#236" '
                             'fill-opacity="0.6"/>')
    bottom = TOP + (PANEL + TOP) * len(measures) - TOP + 12
    for index, name in enumerate(rows):
        x = LEFT + ROW * (index + 0.5) + 4
        parts.append(f'<text transform="translate({x:.1f} {bottom}) rotate(-90)" text-anchor="end">'
                     f'{html.escape(name)}</text>')
    return "\n".join([*parts, "</svg>"]) + "\n"


def row_name(cell):
    """The sequence and parameters of a row."""
    settings = findings.settings_of(cell, ("measure", "method"))
    return ", ".join(value if isinstance(value, str) and key == "sequence" else f"{key} {value}"
                     for key, value in settings.items())
