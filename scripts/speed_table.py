#!/usr/bin/env python3
"""Recognition at speeds other than the training speed, as Markdown: percent of correct best matches
/ recall at 100 percent precision.

  scripts/speed_table.py --data DATA                     corridor and Nordland of a folder (data/README.md)
  scripts/speed_table.py --world configs/worlds/speeds.json    a rendered building and its walks
  scripts/speed_table.py --train TRAIN --query QUERY --ground-truth GT [--tolerance N] [--name NAME]

Columns are simulated speeds of the query (--speed; the mean over seeds 1 to 3 if it is random), or
the query walks of a world. Rows are the methods that the programs support: raw and z-score windows,
by margin if vpr-query has --decide, with the rates 1/2, 2/3, 1, 3/2 and 2 if it has --rates, and the
method filter. --into FILE writes the tables between the lines "<!-- speed table: begin -->" and
"... end -->" of FILE, such as docs/experiments/speeds.md."""
import argparse
import functools
import json
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent.parent
WARPS = ["same", "0.5", "0.67", "1.5", "2", "varying", "stops", "kidnap"]
DRAWN = {"varying", "stops", "kidnap"}
RATES = "1/2,2/3,1,3/2,2"


def run(program, *words):
    words = [str(word) for word in words]
    done = subprocess.run([program, *words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{pathlib.Path(program).name} {' '.join(words)}: {done.stderr}")
    return done.stdout


def methods(help_text):
    """Rows: a name, flags, and whether recall is by margin."""
    rows = []
    has_margin = "--decide" in help_text
    for length in [10, 20, 40]:
        for score, name in [("raw", "raw"), ("zscore", "z-scores")]:
            flags = ("--c-l", length, "--score", score)
            rows.append((f"windows, {name}, c_l {length}", flags, False))
            if has_margin:
                rows.append(("the same, by margin", flags, True))
    if "--rates" in help_text:
        for score, name in [("raw", "raw"), ("zscore", "z-scores")]:
            flags = ("--c-l", 20, "--score", score, "--rates", RATES)
            rows.append((f"windows of five rates, {name}, c_l 20", flags, False))
            if has_margin and score == "zscore":
                rows.append(("the same, by margin", flags, True))
    if "\n  filter " in help_text:
        rows.append(("filter, by margin", ("--method", "filter"), True))
    return rows


class Judge:
    """One data set: its database, and a cell per method and simulated speed or walk."""

    def __init__(self, bin_folder, folder, train, truth):
        self.bin, self.folder, self.truth = pathlib.Path(bin_folder), pathlib.Path(folder), truth
        self.database = self.folder / "train.vprdb"
        run(self.bin / "vpr-train", "fastable", *train, "-o", self.database, "--quiet")

    @functools.cache  # rows that read different values of a report share it
    def measure(self, flags, query, warp, seed):
        with tempfile.TemporaryDirectory(dir=self.folder) as work:
            result = pathlib.Path(work) / "r.json"
            replay = [] if warp == "same" else ["--speed", warp]
            threshold = [] if "--method" in flags else ["--t-r", 0]  # has no effect on the table
            run(self.bin / "vpr-query", self.database, *query, *flags, *threshold, *replay,
                "--seed", seed, "--threads", 1, "--quiet", "-o", result)
            return json.loads(run(self.bin / "vpr-eval", result, *self.truth, "--json"))

    def cell(self, flags, by_margin, query, warp):
        """Means over the seeds."""
        found = []
        for seed in [1, 2, 3] if warp in DRAWN else [1]:
            report = self.measure(flags, query, warp, seed)
            metrics = report["metrics"]
            has_curve = by_margin and "by_margin" in metrics
            curve = metrics["by_margin" if has_curve else "single_best"]
            found.append((100 * (report["best_match"]["rate"] or 0),
                          100 * (curve["recall_at_100_precision"] or 0)))
        return " / ".join(f"{sum(values) / len(found):.0f}" for values in zip(*found))


def table(name, judge, columns, rows):
    lines = [f"| {name} | " + " | ".join(title for title, _, _ in columns) + " |",
             "|---|" + "---:|" * len(columns)]
    for title, flags, by_margin in rows:
        cells = [judge.cell(flags, by_margin, query, warp) for _, query, warp in columns]
        lines.append(f"| {title} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def of_images(options, name, train, query, truth):
    columns = [("same pace" if warp == "same" else warp + "x" if warp[0].isdigit() else warp,
                ("--query", query), warp) for warp in WARPS]
    with tempfile.TemporaryDirectory() as folder:
        judge = Judge(options.bin, folder, ["--train", train], truth)
        return table(name, judge, columns, options.rows)


def of_world(options):
    with tempfile.TemporaryDirectory() as folder:
        building = pathlib.Path(folder) / "building"
        run(options.bin / "vpr-synth", options.world, "-o", building, "--quiet")
        dataset = building / "dataset.json"
        walks = [query["name"] for query in json.loads(dataset.read_text())["queries"]]
        walks.remove("back")  # nothing can be correct: no walk was trained in this direction
        columns = [(walk, ("--dataset", dataset, "--query", walk), "same") for walk in walks]
        judge = Judge(options.bin, folder, ["--dataset", dataset], ["--dataset", dataset])
        return table(options.world.stem, judge, columns, options.rows)


def write_into(path, tables):
    begin, end = (f"<!-- speed table: {edge} -->\n" for edge in ("begin", "end"))
    before, rest = path.read_text().split(begin)
    after = rest.split(end)[1]
    path.write_text(before + begin + "\n".join(tables) + end + after)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path)
    parser.add_argument("--world", type=pathlib.Path)
    parser.add_argument("--train")
    parser.add_argument("--query")
    parser.add_argument("--ground-truth")
    parser.add_argument("--tolerance", type=int, default=0)
    parser.add_argument("--name", default="query")
    parser.add_argument("--into", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path, default=HERE / "build/release/bin")
    options = parser.parse_args()
    options.bin = options.bin.resolve()
    options.rows = methods(run(options.bin / "vpr-query", "--help"))
    if not options.data and not options.world and not (options.train and options.query):
        parser.error("use --data, --world, or --train and --query with --ground-truth")
    tables = []

    def add(table):
        tables.append(table)
        print(table, flush=True)

    if options.data:
        for name, train, query, tolerance in [("corridor", "ref", "query", 3),
                                              ("nordland", "summer", "winter", 2)]:
            images = options.data / name
            add(of_images(options, name, images / train, images / query,
                          ["--ground-truth", "aligned", "--tolerance", tolerance]))
    if options.world:
        add(of_world(options))
    if options.train:
        add(of_images(options, options.name, options.train, options.query,
                      ["--ground-truth", options.ground_truth, "--tolerance", options.tolerance]))
    if options.into:
        write_into(options.into, tables)


main()
