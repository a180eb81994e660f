"""Checks the paper's findings on numbers.

A finding is data (scripts/reproduce/paper): a sentence, its place in the paper, one of KINDS, and `where`,
its numbers, selected by the settings and the measure of their cells. Each number, series or pair of
numbers, or `rows` of them, must satisfy the kind.

  low, high     bounds, inclusive
  over          the parameter of a series, then those that change with it
  than          what is different in the numbers to compare with; all other settings, where both
                have them, are the same
  contradicted  how the paper's table contradicts its text; the finding is not counted
  of            the measure that counts what the ground truth has: a finding that asks for more asks for
                all of it
  one           a parameter that has one value in the paper, which the text does not state: all findings
                with it are checked at the same value of ours, that at which most of them hold
  unchecked     why the paper has no number for the finding
  needs         what the finding needs that is not available, such as the paper's phones; it is then
                checked on the paper's numbers only
  tried         what was tried while the finding failed, in one sentence with its numbers
"""
import json
import math
from dataclasses import dataclass, field

# Data set and query by the name of a sequence.
NO_SETTINGS = ("paper", "ours", "low", "high", "data", "query", "unmeasured")
SUBJECTS = ("recognition", "time")
BOUND_WORDS = ("over", "below", "around", "almost")
EXPONENT_TOLERANCE = 0.15  # of growth: time ~ parameter ^ exponent


def never_rises(values):
    return all(after <= before for before, after in zip(values, values[1:]))


def rises(values):
    return all(after > before for before, after in zip(values, values[1:]))


def exponent(parameters, values):
    """The least-squares slope of log value over log parameter: 1 for proportional numbers, 0 for
    constant ones; NaN if a number is not above 0."""
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
    spreads: list = field(default_factory=list)  # quartiles of all compared times, in their order


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


def overlaps(one, other):
    return one[0] <= other[1] and other[0] <= one[1]


def is_separated(part, kind):
    """Whether the quartiles of times that are compared do not overlap, so that their order is measured."""
    if not all(part.spreads) or kind not in ORDERED:
        return True
    if KINDS[kind][0] == "series":
        return not any(overlaps(*pair) for pair in zip(part.spreads, part.spreads[1:]))
    return not any(overlaps(part.spreads[0], other) for other in part.spreads[1:])


# Findings about the order of numbers.
ORDERED = ("more than", "not more than", "rises with")
# A finding about absence is measured only in rows in which something was recognized.
ABSENCE = ("zero", "never rises with", "not more than")


def number(value):
    """A number, or the bound of a text such as "over 50"; None if there is none."""
    if isinstance(value, str):
        word, _, bound = value.partition(" ")
        return float(bound) if word in BOUND_WORDS else None
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


def spread_of(cell, whose):
    """Quartiles of our times."""
    return (cell["low"], cell["high"]) if whose == "ours" and "low" in cell else None


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
                          [cell[finding["over"][0]] for cell in group],
                          [spread_of(cell, whose) for cell in group]))
    return parts if all(len(part.values) > 1 for part in parts) else []


def pairs(finding, cells, all_cells, whose):
    """One part per cell, with all cells to compare it with; none if any cell has no counterpart."""
    others = select(all_cells, finding["than"])
    parts = []
    for cell in cells:
        own = settings_of(cell, finding["than"])
        alike = [other for other in others
                 if all(other.get(key, value) == value for key, value in own.items())]
        if not alike:
            return []
        parts.append(Part(settings_of(cell), [number(cell[whose])], [number(other[whose]) for other in alike],
                          [spread_of(one, whose) for one in (cell, *alike)]))
    return parts


def is_silent(cell, all_cells):
    """Whether our row of a cell has only zeros: nothing was recognized, neither right nor wrong."""
    own = settings_of(cell, ("measure",))
    others = [number(other["ours"]) for other in all_cells
              if other["measure"] != cell["measure"] and settings_of(other, ("measure",)) == own]
    return bool(others) and number(cell["ours"]) == 0 and all(value == 0 for value in others)


def spoken(finding, cells, all_cells):
    """The cells of rows in which something was recognized; of series, those with a row in which something was."""
    loud = [cell for cell in cells if not is_silent(cell, all_cells)]
    if KINDS[finding["kind"]][0] != "series":
        return loud
    series_of = [settings_of(cell, finding["over"]) for cell in loud]
    return [cell for cell in cells if settings_of(cell, finding["over"]) in series_of]


def parts_of(finding, all_cells, whose):
    cells = select(all_cells, finding["where"])
    if finding["kind"] in ABSENCE and whose == "ours":
        cells = spoken(finding, cells, all_cells)
    shape = KINDS[finding["kind"]][0]
    if shape == "series":
        parts = series(finding, cells, whose)
    elif shape == "pair":
        parts = pairs(finding, cells, all_cells, whose)
    else:
        parts = [Part(settings_of(cell), [number(cell[whose])], []) for cell in cells]
    known = all(value is not None for part in parts for value in part.values + part.others)
    return parts if known else []


def reason_of(finding, cells):
    """Why a finding has no numbers."""
    where = finding["where"]
    used = select(cells, where) + select(cells, {**where, **finding.get("than", {})})
    reasons = dict.fromkeys(cell["unmeasured"] for cell in used if cell.get("unmeasured"))
    is_silence = finding["kind"] in ABSENCE and used and not spoken(finding, used, cells)
    return "; ".join(reasons) or ("nothing was recognized" if is_silence
                                  else "there are no such numbers")


def capped(finding, part, cells, whose):
    """The finding with a bound that the ground truth of its part can reach (see `of`)."""
    if "of" not in finding:
        return finding
    rows = {**part.settings, "measure": finding["of"]}
    most = [number(cell[whose]) for cell in select(cells, rows)]
    return {**finding, "low": min([finding["low"], *(value for value in most if value is not None)])}


def check(finding, cells, whose="ours"):
    """Whether a finding holds on our numbers, or on the paper's, with its parts. `holds` is None if a
    number is missing, with the reason."""
    if "needs" in finding and whose == "ours":
        return {"holds": None, "reason": f"needs {finding['needs']}", "parts": []}
    parts = parts_of(finding, cells, whose)
    if not parts:
        return {"holds": None, "reason": reason_of(finding, cells), "parts": []}
    if not all(is_separated(part, finding["kind"]) for part in parts):
        return {"holds": None, "reason": "the quartiles of compared times overlap", "parts": []}
    bounded = [capped(finding, part, cells, whose) for part in parts]
    if "of" in finding and any(one["low"] <= 0 for one in bounded):
        return {"holds": None, "reason": f"the ground truth has no {finding['of']}", "parts": []}
    judge = KINDS[finding["kind"]][1]
    fits = [bool(judge(part, bound)) for part, bound in zip(parts, bounded)]
    is_series = KINDS[finding["kind"]][0] == "series"
    return {"holds": sum(fits) >= min(finding.get("rows", len(fits)), len(fits)),
            "parts": [{"settings": part.settings, "values": part.values,
                       **({"over": part.others} if is_series else
                          {"than": part.others} if part.others else {}), "fits": fit}
                      for part, fit in zip(parts, fits)]}


def at_one_value(listed, cells):
    """The findings, each with the value of its parameter `one` at which most of those with this parameter
    are measured and hold; the smallest of several."""
    chosen = {}
    for parameter in {finding["one"] for finding in listed if "one" in finding}:
        alike = [finding for finding in listed if finding.get("one") == parameter]

        def outcomes(value):
            return [check(narrowed(finding, {parameter: value}), cells)["holds"] for finding in alike]

        values = sorted({cell[parameter] for finding in alike for cell in select(cells, finding["where"])
                         if parameter in cell}, reverse=True)
        if values:
            chosen[parameter] = max(values, key=lambda value: (
                -outcomes(value).count(None), outcomes(value).count(True), -value))
    return [narrowed(finding, {finding["one"]: chosen[finding["one"]]}) if finding.get("one") in chosen
            else finding for finding in listed]


def narrowed(finding, settings):
    return {**finding, "where": {**finding["where"], **settings}}


def check_all(experiment, cells, is_stand_in=True):
    """The findings for the JSON, with the outcome on our numbers. Trials are about stand-ins."""
    words = ("finding", "place", "kind", "contradicted", "unchecked", *(["tried"] if is_stand_in else []))
    subject = SUBJECTS[experiment["kind"] == "bench"]
    return [{**{key: finding[key] for key in words if key in finding}, "subject": subject,
             **check(finding, cells)} for finding in at_one_value(experiment["findings"], cells)]


def counted(outcomes, subject=None):
    """Without those that the paper's own tables contradict."""
    return [outcome for outcome in outcomes if "contradicted" not in outcome
            and subject in (None, outcome["subject"])]


def summary(outcomes, subject=None):
    """How many findings hold, do not, and were not measured."""
    held = [outcome["holds"] for outcome in counted(outcomes, subject)]
    return {"hold": held.count(True), "fail": held.count(False), "not_measured": held.count(None)}


def summary_table(outcomes, subjects=SUBJECTS):
    """The summary of each subject, as Markdown."""
    rows = [(subject, *summary(outcomes, subject).values()) for subject in subjects]
    return ["| findings on | hold | do not hold | not measured |", "|---|---:|---:|---:|",
            *(f"| {' | '.join(map(str, row))} |" for row in rows)]


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
        return f"{start}not measured ({outcome['reason']})"
    end = "holds" if outcome["holds"] else "does not hold"
    if "contradicted" in outcome:
        end = f"not counted, since {outcome['contradicted']}; {end}"
    tried = f". {outcome['tried']}" if outcome["holds"] is False and "tried" in outcome else ""
    return f"{start}{end} ({evidence(outcome)}){tried}"


def lines(outcomes):
    """The last lines of a table."""
    counts = summary(outcomes)
    missing = f", {counts['not_measured']} not measured" if counts["not_measured"] else ""
    return [*(f"- {line(outcome)}" for outcome in outcomes), "",
            f"{counts['hold']} of {counts['hold'] + counts['fail']} findings hold{missing}."]


def failing_lines(results):
    """The findings that do not hold, a line each."""
    return [f"- {line(outcome)}" for result in results for outcome in counted(result["findings"])
            if outcome["holds"] is False]


def times_block(results):
    """The findings on times that do not hold, and the numbers of those that do, as Markdown."""
    outcomes = [outcome for result in results for outcome in counted(result["findings"])]
    lines = [*summary_table(outcomes, ("time",)), "", "| finding that does not hold | in the paper | our numbers that do not fit |",
             "|---|---|---|"]
    lines += [f"| {outcome['finding']} | {outcome['place']} | {evidence(outcome).removeprefix('ours ')} |"
              for outcome in outcomes if outcome["holds"] is False]
    lines += ["", "| experiment | hold | of |", "|---|---:|---:|"]
    for result in results:
        counts = summary(result["findings"])
        lines.append(f"| {result['title']} | {counts['hold']} | {counts['hold'] + counts['fail']} |")
    return lines


PAGE = """# Reproduction of the paper

<!-- recognition: begin -->
<!-- recognition: end -->

<!-- time: begin -->
<!-- time: end -->
"""


def write_page(path, blocks):
    """Replaces blocks of a page by name, each between lines such as "<!-- time: begin -->". A page that does
    not exist has only these blocks."""
    text = path.read_text() if path.exists() else PAGE
    for name, lines in blocks.items():
        begin, end = (f"<!-- {name}: {edge} -->\n" for edge in ("begin", "end"))
        before, rest = text.split(begin)
        text = before + begin + "\n".join(lines) + "\n" + end + rest.split(end)[1]
    path.write_text(text)
