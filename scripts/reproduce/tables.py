"""Output of an experiment: one entry per number as JSON and CSV, a readable table, and findings."""
import csv
import json

import findings


def markdown_table(head, numbers_from, rows):
    """Columns from `numbers_from` on are aligned to the right."""
    line = "|" + "---|" * numbers_from + "---:|" * (len(head) - numbers_from)
    return ["| " + " | ".join(head) + " |", line,
            *("| " + " | ".join(row) + " |" for row in rows)]


def count_table(cells):
    """A row for each setting, a column for each measure: ours (the paper's)."""
    keys = [key for key in dict.fromkeys(key for cell in cells for key in cell)
            if key not in ("measure", "paper", "ours", "data", "query", "unmeasured")]
    names = list(dict.fromkeys(cell["measure"] for cell in cells))
    table = {}
    for cell in cells:
        settings = tuple(str(cell.get(key, "")) for key in keys)
        table.setdefault(settings, {})[cell["measure"]] = f"{shown(cell['ours'])} ({cell['paper']})"
    return ["Ours (the paper's).", "",
            *markdown_table(keys + names, len(keys),
                            ([*settings, *(values.get(n, "") for n in names)]
                             for settings, values in table.items()))]


WORLD_WORDS = ("In the findings, hands is how differently the phone is held from day to day, bare walls are "
               "walls with only doors, windows and fittings (bareness), and jolts are those of the steps "
               "(jolt_deg, in degrees): settings of the rendered world (configs/worlds).")
PER = {"ms": "milliseconds per frame", "fps": "frames per second", "times": "times as fast"}


def time_table(cells):
    """The times, rates and speed-ups, in the paper's grid if it has one, otherwise as a list."""
    lines = []
    for measure in dict.fromkeys(cell["measure"] for cell in cells):
        alike = [cell for cell in cells if cell["measure"] == measure]
        has_grid = all("frames" in cell and "query_frames" not in cell for cell in alike)
        lines += [f"Ours: {PER[measure]}, median (from quartile to quartile).", "",
                  *(time_grid(alike) if has_grid else time_list(alike)), ""]
    return lines[:-1]


def shown(value):
    return "not measured" if value is None else str(value)


def ours_of(cell):
    if cell["ours"] is None:
        return shown(None)
    return f"{cell['ours']:g} ({cell['low']:g} to {cell['high']:g})"


def paper_of(cell):
    return cell["paper"] if isinstance(cell["paper"], str) else f"{cell['paper']:g}"


def time_grid(cells):
    """A column per number of database frames: our measurement with its quartiles, and the paper's below
    it."""
    frames = sorted({cell["frames"] for cell in cells})
    blocks = {}
    for cell in cells:
        block = blocks.setdefault((cell["c_l"], cell["our_work"]), {})
        block.setdefault(f"ours: {cell['our_work']}", {})[cell["frames"]] = ours_of(cell)
        if not isinstance(cell["paper"], str):
            block.setdefault(f"paper: {cell['what']}", {})[cell["frames"]] = paper_of(cell)
    rows = [[str(c_l), who, *(values.get(n, "") for n in frames)]
            for (c_l, _), block in blocks.items() for who, values in block.items()]
    return markdown_table(["c_l", "whose", *map(str, frames)], 2, rows)


def time_list(cells):
    """A row per number, with a column for each setting."""
    keys = [key for key in ("frames", "c_l", "query_frames", "places")
            if any(key in cell for cell in cells)]
    rows = [[cell["what"], cell["our_work"], *(str(cell.get(key, "")) for key in keys),
             paper_of(cell), ours_of(cell)] for cell in cells]
    return markdown_table(["the paper's work", "our work", *keys, "the paper's", "ours"], 2, rows)


def write_markdown(path, result, kind):
    cells, outcomes = result["cells"], result["findings"]
    table = time_table(cells) if kind == "bench" else count_table(cells)
    if any(outcome["holds"] is False and "tried" in outcome for outcome in outcomes):
        result = {**result, "notes": [*result["notes"], WORLD_WORDS]}
    path.write_text("\n".join([f"# {result['title']}", "", *table, *(f"\n{note}" for note in result["notes"]),
                               "", "The paper's findings:", "", *findings.lines(outcomes)]) + "\n")


def write_json(path, result):
    path.write_text(json.dumps(result, indent=1) + "\n")


def write_csv(path, cells):
    keys = list(dict.fromkeys(key for cell in cells for key in cell))
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, keys, lineterminator="\n")
        writer.writeheader()
        writer.writerows(cells)
