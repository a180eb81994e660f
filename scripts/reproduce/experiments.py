"""The kinds of experiments: from files of the programs to a number of ours for each of the paper's."""
import re
from dataclasses import dataclass, field

import along_path
from laboratory import Failure, run, say

# Settings of a row in scripts/reproduce/paper; its other keys are measures with the paper's numbers.
SETTINGS = ("sequence", "data", "query", "c_w", "t_p", "c_l", "t_r", "method", "what", "our_work",
            "frames", "query_frames", "places", "unmeasured")
PARAMETERS = ("frames", "c_l", "query_frames", "places")  # of measurements by vpr-bench
QUICK_SECONDS = "0.02"  # per measurement
QUICK_MOST_FRAMES = 10_000  # of a database


@dataclass
class Measured:
    """A row of the paper with our numbers by measure; the others are not measured, for a reason."""
    row: dict
    ours: dict = field(default_factory=dict)
    spread: dict = field(default_factory=dict)  # quartiles of a time
    reason: str = ""


def cells_of(rows):
    """One entry per number: settings, name, the paper's and ours, or the reason why there is none."""
    cells = []
    for measured in rows:
        settings = {key: value for key, value in measured.row.items()
                    if key in SETTINGS and key != "unmeasured"}
        for measure in (key for key in measured.row if key not in SETTINGS):
            cell = {**settings, "measure": measure, "paper": measured.row[measure],
                    "ours": measured.ours.get(measure)}
            cell |= measured.spread if cell["ours"] is not None else {"unmeasured": measured.reason}
            cells.append(cell)
    return cells


def measures(counts):
    """Counts of a cell or report, with the names of the paper's columns. The paper judges the
    recognitions of a sequence method by their place (section 3.2). Without labels there are totals."""
    one_by_one = counts["pairs"]
    found = {"recognitions": sum(one_by_one[key] for key in ("correct", "incorrect", "ignored"))}
    if "clusters" not in counts:  # FAB-MAP
        return {**found, "correct": one_by_one["correct"], "incorrect": one_by_one["incorrect"],
                "distinct": counts["distinct"]}
    found["places in total"] = sum(counts["clusters"].values())
    if by_place := counts.get("pairs_by_cluster"):
        for verdict in ("correct", "incorrect"):
            found[f"{verdict} recognitions"] = by_place[verdict]
            found[f"{verdict} places"] = counts["clusters"][verdict]
    return found


def run_grid(experiment, laboratory):
    """FAB-MAP over c_w and t_p, or OpenABLE over c_l and t_r (computed by FastABLE; the last
    cell of each query also without reuse, which must be equal)."""
    is_fabmap = experiment["kind"] == "fabmap"
    method, keys = ("fabmap", ("c_w", "t_p")) if is_fabmap else ("fastable", ("c_l", "t_r"))
    ours = [Measured(row) for row in experiment["rows"]]
    groups = {}
    for measured in ours:
        groups.setdefault((measured.row["data"], measured.row["query"]), []).append(measured)
    for (name, query), group in groups.items():
        if reason := laboratory.data(name).lacks(query):
            for measured in group:
                measured.reason = reason
            continue
        grids = {"--" + key.replace("_", "-"): [measured.row[key] for measured in group] for key in keys}
        cells = laboratory.sweep(method, name, query, grids)
        for measured in group:
            counts = cells[tuple(measured.row[key] for key in keys)]["counts"]
            measured.ours = measures(counts)
        if not is_fabmap:
            check_openable(laboratory, name, query, measured.row, counts)
    return ours


def check_openable(laboratory, name, query, row, counts):
    """Checks that OpenABLE without reuse has the same counts."""
    report = laboratory.report("openable", name, query, "--c-l", row["c_l"], "--t-r", row["t_r"])
    if report["counts"] != counts:
        raise Failure(f"OpenABLE and FastABLE differ on {query}: {report['counts']}, {counts}")
    say(f"{query}: OpenABLE has the same counts at c_l {row['c_l']}, t_r {row['t_r']}")


def run_floor(experiment, laboratory):
    """A separate query per row, with a map. Without ground truth, places of FastABLE are judged by answers to a
    page, and those of FAB-MAP are the frames that a person marked on another one."""
    ours = []
    for row in experiment["rows"]:
        data = laboratory.data(row["data"])
        if reason := data.lacks(row["query"]):
            ours.append(Measured(row, reason=reason))
            continue
        query = data.query(row["query"])
        if row["method"] != "FastABLE":
            ours.append(run_places(laboratory, data, row, query))
            continue
        is_asked = needs_marks(data, query) and not ours  # once
        ours.append(run_windows(laboratory, data, row, query,
                                ["--ask-fabmap", marking_page(laboratory, data)] if is_asked else []))
    return ours


def map_options(laboratory, data, query, stem):
    """The flags that draw a map, if the positions of the query's frames are known."""
    if along_path.positions(data, query):
        return ["--map", laboratory.figures / f"{stem}-map"]
    laboratory.note(f"Map: not measured. The query {query['name']} in dataset.json has no \"poses\", a file "
                    "frame,x,y,heading.")
    return []


def run_windows(laboratory, data, row, query, pages):
    """A row of FastABLE; out/figures shows its recognitions along the query."""
    has_truth = "ground_truth" in query
    stem = f"{data.name}-c_l-{row['c_l']}"
    quick = "-quick" if laboratory.is_quick else ""  # which has other places
    answers = data.description.parent / f"places{quick}-c_l-{row['c_l']}.csv"
    page = laboratory.figures / f"{stem}.html"
    evaluation = ["--plot", laboratory.figures / stem, *map_options(laboratory, data, query, stem), *pages]
    if not has_truth:
        evaluation += ["--places", answers] if answers.exists() else ["--ask-places", page]
    report = laboratory.report("fastable", data.name, row["query"], "--c-l", row["c_l"], "--t-r",
                               row["t_r"], evaluation=evaluation)
    if has_truth or answers.exists():
        return Measured(row, {**measures(report["counts"]), **shares(report)})
    say(f"Open {page}, answer the question on each place (y or n), save its file as {answers}, then "
        "run this again to count as the paper did")
    laboratory.notes.append(
        f"c_l {row['c_l']}: places are not labeled. Open figures/{page.name}, answer the question on each "
        f"place (y or n), save its file as {answers.name} next to dataset.json, then run this again.")
    return Measured(row, {**measures(report["counts"]), **shares(report)}, reason="places are not labeled")


def needs_marks(data, query):
    """Whether FAB-MAP's places are neither in the recordings nor marked."""
    return not data.marked and not ("place_ground_truth" in query and data.content.get("places"))


def marking_page(laboratory, data):
    return laboratory.figures / f"{data.name}-fabmap.html"


def run_places(laboratory, data, row, query):
    """A row of FAB-MAP."""
    if needs_marks(data, query):
        laboratory.note(f"FAB-MAP: not measured. Open figures/{marking_page(laboratory, data).name}, mark the training "
                        "frames that are its places, save fabmap-places.csv next to dataset.json, then run this again.")
        return Measured(row, reason="the places of FAB-MAP are not marked")
    evaluation = map_options(laboratory, data, query, f"{data.name}-c_w-{row['c_w']}")
    if data.marked:
        evaluation += ["--ground-truth", data.marked]
        there = along_path.marked_places(data.marked)
    else:
        there = along_path.frames_of_places(data, query)
    if data.vocabulary:
        laboratory.note("FAB-MAP: dataset.json has no \"pretrain\", so the vocabulary is of frames of "
                        f"{', '.join(data.vocabulary)}.")
    report = laboratory.report("fabmap", data.name, row["query"], "--c-w", row["c_w"], "--t-p", row["t_p"],
                               evaluation=evaluation)
    return Measured(row, {**measures(report["counts"]), **shares(report), "places on the path": len(there)})


def shares(report):
    """Shares of the query's frames with a recognition, and with a correct one if they are judged."""
    found = report["localization"]
    per_cent = {"recognized percent": found["recognized_share"]}
    if "share" in found:
        per_cent["localized percent"] = found["share"]
    return {name: round(100 * share, 1) for name, share in per_cent.items()}


def run_maps(experiment, laboratory):
    """Draws FAB-MAP and OpenABLE on the plan, as SVG and PNG in out/figures, and compares the parts of the
    path that they recognize."""
    ours = []
    for row in experiment["rows"]:
        name, query = row["data"], row["query"]
        found, maps, recognized = {}, {}, {}
        for title, method, settings, wrong in (
                ("FAB-MAP", "fabmap", ["--c-w", row["c_w"], "--t-p", row["t_p"]], "incorrect"),
                ("OpenABLE", "openable", ["--c-l", row["c_l"], "--t-r", row["t_r"]],
                 "incorrect places")):
            report = laboratory.report(method, name, query, *settings)
            counts = measures(report["counts"])
            found[f"{title} places"] = counts["distinct" if method == "fabmap" else "correct places"]
            found[f"{title} {wrong}"] = counts[wrong]
            found[f"{title} percent of path"] = shares(report)["localized percent"]
            recognized[title] = [letter == "r" for letter in report["outcomes"]["recognized"]]
            maps[method] = laboratory.keep_result(f"map-{method}")
        data = laboratory.data(name)
        found |= along_path.compare(data, data.query(query), recognized)
        target = laboratory.figures / f"{name}-{query}"
        run(f"draw {target.name}", "vpr-eval", maps["fabmap"], "--dataset",
            data.description, "--map", target, "--map-with", maps["openable"], "--force")
        ours.append(Measured(row, found))
    return ours


def run_bench(experiment, laboratory):
    """Timings by vpr-bench: the time of one work, the sum of two, or their ratio."""
    measured, left_out = [], []
    for index, command in enumerate(experiment["commands"]):
        stem = f"{experiment['name']}-{index + 1}"
        out = laboratory.work / f"bench-{stem}.json"
        command = [filled_in(word, measured) for word in command]
        data = nordland_data(laboratory.folder) if is_nordland(command) else []
        if laboratory.is_quick:
            command = quick_command(command, left_out)
        run(f"measure {' '.join(command)}", "vpr-bench", *command, *data, "--plot",
            laboratory.figures / stem, "-o", out, "--force")
        bench = laboratory.written(out)
        laboratory.machine = {key: bench["machine"][key] for key in ("host", "threads", "simd")}
        measured += bench["rows"]
        left_out += bench["left_out"]
    laboratory.notes += [f"Not measured: {sentence}." for sentence in left_out]
    return [times_of(row, measured, left_out) for row in experiment["rows"]]


def filled_in(word, measured):
    """The measured time of a work in place of its name in braces."""
    if not word.startswith("{"):
        return word
    return next(f"{bench['median_ms']:.4g}" for bench in measured if bench["work"] == word.strip("{}"))


def quick_command(command, left_out):
    """The command with short measurements and without large databases."""
    short = list(command)
    if "--databases" in short:
        at = short.index("--databases") + 1
        sizes = short[at].split(",")
        kept = [size for size in sizes if int(size) <= QUICK_MOST_FRAMES]
        short[at] = ",".join(kept)
        left_out += [f"{size} database frames, because of --quick" for size in sizes if size not in kept]
    if "--seconds" in short:
        at = short.index("--seconds")
        del short[at:at + 2]
    return [*short, "--seconds", QUICK_SECONDS]


def is_nordland(command):
    """Whether a command measures the paper's Nordland tables, which have c_l 300."""
    return "--c-l" in command and command[command.index("--c-l") + 1] == "300"


def nordland_data(folder):
    """Real frames instead of generated codes, if the user has them."""
    if not folder:
        return []
    sides = folder / "nordland/summer", folder / "nordland/winter"
    for side in sides:
        if not side.exists():
            raise Failure(f"{side} is missing; scripts/reproduce/README.md describes its contents", 2)
    return ["--train", sides[0], "--query", sides[1]]


def times_of(row, measured, left_out):
    """Our time, rate or ratio for a number of the paper, with its quartiles; for a ratio the smallest and
    the largest of both."""
    if "unmeasured" in row:
        return Measured(row, reason=row["unmeasured"])
    works = re.split(" [+/] ", row["our_work"])  # "slow / fast" for a ratio, "one + other" for a sum
    found = [bench for work in works for bench in measured if bench["work"] == work
             and all(bench["parameters"].get(key, row[key]) == row[key]
                     for key in PARAMETERS if key in row)]
    if len(found) < len(works):
        size = str(row.get("frames", row.get("places")))
        reasons = [sentence for sentence in left_out if size in sentence.split()] or left_out
        return Measured(row, reason="; ".join(reasons) or "vpr-bench did not measure it")
    if "times" in row:
        slow, fast = found
        numbers = (slow["median_ms"] / fast["median_ms"],
                   slow["lower_quartile_ms"] / fast["upper_quartile_ms"],
                   slow["upper_quartile_ms"] / fast["lower_quartile_ms"])
    else:
        numbers = [sum(bench[key] for bench in found)
                   for key in ("median_ms", "lower_quartile_ms", "upper_quartile_ms")]
    if "fps" in row:
        median, low, high = numbers
        numbers = 1000 / median, 1000 / high, 1000 / low
    measure = next(key for key in row if key not in SETTINGS)
    median, low, high = (float(f"{value:.4g}") for value in numbers)
    return Measured(row, {measure: median}, {"low": low, "high": high})


KINDS = {"fabmap": run_grid, "sequence": run_grid, "floor": run_floor, "maps": run_maps,
         "bench": run_bench}
