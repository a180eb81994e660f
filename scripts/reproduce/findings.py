#!/usr/bin/env python3
"""Checks the paper's findings on numbers.

    findings.py EXPERIMENT... [--into FILE]

Checks the current findings on stored numbers (out/EXPERIMENT.json, of any version) and prints two
tables: "failing" with our numbers, and "holding". --into writes each between the lines
"<!-- NAME: begin -->" and "<!-- NAME: end -->" of FILE (docs/benchmarks/reproduction.md).

A finding is data (configs/paper): a sentence, its place in the paper, one of KINDS, and `where`,
its numbers, selected by the settings and the measure of their cells. Each number, series or pair of
numbers, or `rows` of them, must satisfy the kind.

  low, high     bounds, inclusive
  over          the parameter of a series, then those that change with it
  than          what is different in the numbers to compare with; all other settings, where both
                have them, are the same
  contradicted  how the paper's table contradicts its text; the finding is not counted
  unchecked     why the paper has no number for the finding
"""
import argparse
import json
import math
import pathlib
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Data set and query by the name of a sequence.
NO_SETTINGS = ("paper", "ours", "low", "high", "data", "query")
EXPONENT_TOLERANCE = 0.15  # of growth: time ~ parameter ^ exponent


def never_rises(values):
    return all(after <= before for before, after in zip(values, values[1:]))


def rises(values):
    return all(after > before for before, after in zip(values, values[1:]))


def exponent(parameters, values):
    """The least-squares slope of log value over log parameter: 1 for proportional numbers, 0 for
    constant ones; None if a number is not above 0."""
    if min(values) <= 0:
        return math.nan
    x, y = [math.log(p) for p in parameters], [math.log(v) for v in values]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return (sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y))
            / sum((a - mean_x) ** 2 for a in x))


def is_near(value, expected):
    return abs(value - expected) <= EXPONENT_TOLERANCE


def is_within(value, finding):
    return finding.get("low", -math.inf) <= value <= finding.get("high", math.inf)


@dataclass
class Part:
    """The unit of a check: a number, a series over a parameter, or a number with those to compare
    with."""
    settings: dict  # of its first cell
    values: list
    others: list  # the parameter's values of a series, or the numbers to compare with


# For each kind: the parts that it checks, and its condition.
KINDS = {
    "zero": ("number", lambda part, _: part.values[0] == 0),
    "at least": ("number", lambda part, finding: is_within(part.values[0], finding)),
    "falls with": ("series", lambda part, _:
                   never_rises(part.values) and part.values[-1] < part.values[0]),
    "never rises with": ("series", lambda part, _: never_rises(part.values)),
    "rises with": ("series", lambda part, _: rises(part.values)),
    "grows linearly with": ("series", lambda part, _:
                            is_near(exponent(part.others, part.values), 1)),
    "independent of": ("series", lambda part, _: is_near(exponent(part.others, part.values), 0)),
    "more than": ("pair", lambda part, _: part.values[0] > max(part.others)),
    "not more than": ("pair", lambda part, _: part.values[0] <= min(part.others)),
    "ratio": ("pair", lambda part, finding: all(
        other > 0 and is_within(part.values[0] / other, finding) for other in part.others)),
    "share of": ("pair", lambda part, finding: all(
        part.values[0] + other > 0 and is_within(part.values[0] / (part.values[0] + other), finding)
        for other in part.others)),
}


def number(value):
    """A number, or the bound of a text such as "over 50"; None if there is none."""
    if isinstance(value, str):
        return float(value.removeprefix("over ")) if value.startswith("over ") else None
    return value


def as_list(value):
    return value if isinstance(value, list) else [value]


def select(cells, where):
    """The cells with these settings; none if any of the values has no cell."""
    found = [cell for cell in cells
             if all(cell.get(key) in as_list(value) for key, value in where.items())]
    complete = all(any(cell[key] == value for cell in found)
                   for key, values in where.items() for value in as_list(values))
    return found if complete else []


def settings_of(cell, but=()):
    return {key: value for key, value in cell.items() if key not in (*NO_SETTINGS, *but)}


def series(finding, cells, whose):
    """One part for all cells that differ only in the parameter; a parameter with a single value is not
    a series."""
    groups = {}
    for cell in cells:
        key = json.dumps(settings_of(cell, finding["over"]))
        groups.setdefault(key, []).append(cell)
    parts = []
    for group in groups.values():
        group.sort(key=lambda cell: cell[finding["over"][0]])
        parts.append(Part(settings_of(group[0], finding["over"]),
                          [number(cell[whose]) for cell in group],
                          [cell[finding["over"][0]] for cell in group]))
    return parts if all(len(part.values) > 1 for part in parts) else []


def pairs(finding, cells, all_cells, whose):
    """One part per cell, with all cells to compare it with; none if any cell has no counterpart."""
    others = select(all_cells, finding["than"])
    parts = []
    for cell in cells:
        own = settings_of(cell, finding["than"])
        alike = [number(other[whose]) for other in others
                 if all(other.get(key, value) == value for key, value in own.items())]
        if not alike:
            return []
        parts.append(Part(settings_of(cell), [number(cell[whose])], alike))
    return parts


def parts_of(finding, all_cells, whose):
    cells = select(all_cells, finding["where"])
    shape = KINDS[finding["kind"]][0]
    if shape == "series":
        parts = series(finding, cells, whose)
    elif shape == "pair":
        parts = pairs(finding, cells, all_cells, whose)
    else:
        parts = [Part(settings_of(cell), [number(cell[whose])], []) for cell in cells]
    known = all(value is not None for part in parts for value in part.values + part.others)
    return parts if known else []


def check(finding, cells, whose="ours"):
    """Whether a finding holds on our numbers, or on the paper's, with its parts. `holds` is None if a
    number is missing."""
    parts = parts_of(finding, cells, whose)
    judge = KINDS[finding["kind"]][1]
    fits = [bool(judge(part, finding)) for part in parts]
    is_series = KINDS[finding["kind"]][0] == "series"
    return {"holds": sum(fits) >= finding.get("rows", len(fits)) if fits else None,
            "parts": [{"settings": part.settings, "values": part.values,
                       **({"over": part.others} if is_series else
                          {"than": part.others} if part.others else {}), "fits": fit}
                      for part, fit in zip(parts, fits)]}


def check_all(findings, cells):
    """The findings for the JSON, with the outcome on our numbers."""
    words = ("finding", "place", "kind", "contradicted", "unchecked")
    return [{**{key: finding[key] for key in words if key in finding}, **check(finding, cells)}
            for finding in findings]


def summary(outcomes):
    """How many findings hold, among those that were measured and that the paper's tables do not contradict."""
    counted = [outcome["holds"] for outcome in outcomes
               if outcome["holds"] is not None and "contradicted" not in outcome]
    return {"hold": sum(counted), "of": len(counted)}


def name(settings, all_settings):
    """The settings in which parts differ, as text."""
    differing = {key: value for key, value in settings.items() if key not in ("what", "our_work")
                 and any(other.get(key) != value for other in all_settings)}
    return ", ".join(value if isinstance(value, str) else f"{key} {value}"
                     for key, value in differing.items())


def numbers(part):
    text = ", ".join(f"{value:g}" for value in part["values"])
    if "than" in part:
        text += " against " + ", ".join(f"{value:g}" for value in part["than"])
    return text


def evidence(outcome):
    """Our numbers as text: if a finding fails, those that do not fit, otherwise all."""
    every = [part["settings"] for part in outcome["parts"]]
    fits = {}  # one entry if the same number of ours corresponds to several in the paper
    for part in outcome["parts"]:
        label = name(part["settings"], every)
        fits[f"{label}: {numbers(part)}" if label else numbers(part)] = part["fits"]
    shown = [words for words, fit in fits.items() if fit == outcome["holds"]]
    rows = f"{len(shown)} of {len(fits)} rows: " if len(shown) < len(fits) else ""
    return "ours " + rows + "; ".join(shown)


def line(outcome):
    start = f"{outcome['finding']} ({outcome['place']}): "
    if outcome["holds"] is None:
        return start + "not measured"
    end = "holds" if outcome["holds"] else "does not hold"
    if "contradicted" in outcome:
        end = f"not counted, since {outcome['contradicted']}; {end}"
    return f"{start}{end} ({evidence(outcome)})"


def lines(outcomes):
    """The last lines of a table."""
    counts = summary(outcomes)
    return [*(f"- {line(outcome)}" for outcome in outcomes), "",
            f"{counts['hold']} of {counts['of']} findings hold."]


def sections(experiments):
    """Title and findings of each experiment, checked again on its stored numbers."""
    for experiment in experiments:
        written = json.loads((ROOT / f"out/{experiment}.json").read_text())
        config = json.loads((ROOT / f"configs/paper/{experiment}.json").read_text())
        yield config["title"], check_all(config["findings"], written["cells"])


def overview(checked):
    """The blocks of the page by name, from pairs of title and findings."""
    counts = summary([outcome for _, outcomes in checked for outcome in outcomes])
    failing = [f"{counts['hold']} of {counts['of']} findings hold on rendered stand-ins and generated codes.", "",
               "| finding | in the paper | our numbers that do not fit |", "|---|---|---|"]
    holding = []
    for title, outcomes in checked:
        counted = [outcome for outcome in outcomes if "contradicted" not in outcome]
        own = summary(outcomes)
        failing += [f"| {outcome['finding']} | {outcome['place']} | {evidence(outcome).removeprefix('ours ')} |"
                    for outcome in counted if outcome["holds"] is False]
        holding += [*([""] if holding else []), f"### {title}", "", f"{own['hold']} of {own['of']}:", "",
                    *(f"- {outcome['finding']} ({outcome['place']})" for outcome in counted if outcome["holds"])]
        holding += [f"- not measured: {outcome['finding']} ({outcome['place']})"
                    for outcome in counted if outcome["holds"] is None]
        holding += [f"- not counted, since {outcome['contradicted']}: {outcome['finding']} ({outcome['place']})"
                    for outcome in outcomes if "contradicted" in outcome]
    return {"failing": failing, "holding": holding}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiments", nargs="+")
    parser.add_argument("--into", type=pathlib.Path)
    options = parser.parse_args()
    for name, block in overview(list(sections(options.experiments))).items():
        text = "\n".join(block) + "\n"
        print(text)
        if options.into:
            begin, end = (f"<!-- {name}: {edge} -->\n" for edge in ("begin", "end"))
            before, rest = options.into.read_text().split(begin)
            options.into.write_text(before + begin + text + end + rest.split(end)[1])


if __name__ == "__main__":
    main()
