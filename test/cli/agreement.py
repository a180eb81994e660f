#!/usr/bin/env python3
"""For one result of each method, all commands that show it print the same numbers, over the same
frames; the counts of the small building are those of test/expected.   agreement.py SOURCE BIN"""
import csv
import io
import json
import re

from support import folder, read_json, refused, run, source, write

NAMES = ("R@1", "AP", "R@100P", "correct", "incorrect")


def cells(values):
    return tuple("-" if value is None else f"{value:.4f}" if isinstance(value, float) else str(value)
                 for value in values)


def of_report(report):
    """R@1, AP, R@100P, correct and incorrect of a report, and its number of frames. Without a threshold of
    the user, no frame is counted as recognized."""
    best, path = report["best_match"], report["localization"]
    curve = report["metrics"]["single_best"]
    assert best["rate"] == report["metrics"]["recall_at"]["1"] == best["correct"] / best["frames"]
    assert best["frames"] == curve["positives"] == path["frames_with_match"]
    assert best["frames"] == sum(best[key] for key in ("correct", "incorrect", "ignored", "no_answer"))
    letters = report["outcomes"]["best"]
    assert letters.count("c") == best["correct"] and sum(map(str.islower, letters)) == best["frames"]
    recognized = report["outcomes"]["recognized"]
    assert (recognized.count("r"), recognized.count("w")) == (path["correct"], path["incorrect"])
    is_oracle = "oracle" in report.get("settings", {}) or report.get("oracle", False)
    counts = (None, None) if is_oracle else (path["correct"], path["incorrect"])
    return cells((best["rate"], curve.get("average_precision"), curve.get("recall_at_100_precision"),
                  *counts)), best["frames"]


def row(text, name):
    """The cells of a method in a table with NAMES among its columns; text or LaTeX."""
    plain = re.sub(r"\\shortstack\[r\]\{([^\\]*)\\\\\{\\scriptsize[^}]*\}\}", r"\1", text)  # without intervals
    table = [re.split(r"\s*&\s*|\s{2,}", re.sub(r"\\textbf\{|[}\\]", "", line).strip())
             for line in plain.splitlines()]
    head = next(line for line in table if "R@1" in line)
    found = next(line for line in table if line[0] == name)
    values = dict(zip(head, (re.sub(r" \[.*|\*$", "", cell) for cell in found)))
    return tuple(values.get(column, "-") for column in NAMES)


def frames_of(text):
    return int(re.search(r"over ([0-9]+) frames", " ".join(text.split()))[1])


def check(name, result, truth):
    """`result`: the words that name it for vpr-eval."""
    text = " ".join(run("vpr-eval", *result, *truth, "--name", name, "-o", f"{name}.report.json", "--outcomes-csv",
                        f"{name}.outcomes.csv").split())
    report = read_json(f"{name}.report.json")
    numbers, frames = of_report(report)
    if result[0] != "matrix":
        stated = re.search(r"correct in ([0-9]+) of ([0-9]+) frames", text)
        assert stated[1] == str(report["best_match"]["correct"]) and stated[2] == str(frames), text
        stated = re.match(r"([0-9]+|None) of ([0-9]+) frames", text)
        path = report["localization"]
        on_map = path["recognized"] - path["off_map"]
        assert stated[1] == (str(on_map) if on_map else "None") and stated[2] == str(frames), text
    stated = re.search(r"R@1 ([0-9.]+)", text)
    assert stated[1] == numbers[0], text
    rows = list(csv.DictReader(io.StringIO(run("vpr-eval", *result, *truth, "--format", "csv"))))
    assert len(rows) == 1 and rows[0]["of frames"] == str(frames), rows
    precise = (rows[0].get(column) for column in NAMES[:3])
    assert cells(float(value) if value else None for value in precise) == numbers[:3], rows
    per_frame = list(csv.DictReader((folder / f"{name}.outcomes.csv").open()))
    assert len(per_frame) == len(report["outcomes"]["best"]), per_frame[:2]
    return numbers, frames


def compare(names, numbers, frames, more=()):
    """The reports next to each other."""
    reports = [f"{name}.report.json" for name in names]
    text = run("vpr-eval", "compare", *reports, *more)
    latex = run("vpr-eval", "compare", *reports, *more, "--format", "latex")
    assert frames_of(text) == frames_of(latex) == frames, (text, latex)
    for name in names:
        assert row(text, name) == numbers[name], (text, numbers[name])
        assert row(latex, name) == numbers[name], (latex, numbers[name])
        pairs = read_json(f"{name}.report.json").get("counts", {}).get("pairs", {"incorrect": 0})
        if name != "filter" and pairs["incorrect"]:
            wrong = f"{pairs['incorrect']} of {sum(pairs.values())}"
            assert wrong in text and wrong in latex, (name, wrong, text, latex)


run("vpr-synth", source / "configs/worlds/small.json", "-o", "world", "--quiet")
truth = ("--dataset", "world/dataset.json")
run("vpr-train", "fastable", *truth, "--c-l", 20, "-o", "s.vprdb", "--quiet")
run("vpr-train", "fabmap", *truth, "--words", 300, "-o", "f.vprdb", "--quiet")
windows = ("--c-l", 20, "--score", "zscore", "--decide", "margin", "--margin", 0.5)
for name, words in {"filter": (), "windows": windows, "fastable": ("--c-l", 20, "--t-r", 0.6),
                    "part": ("--c-l", 20, "--t-r", 0.6, "--only-sequence", "corridor"),
                    "fabmap": ("--c-w", 3, "--t-p", 0.99)}.items():
    database = "f.vprdb" if name == "fabmap" else "s.vprdb"
    run("vpr-query", database, *truth, *words, "-o", f"{name}.json", "--quiet")
# The counts of the small building have not changed, from pixels to report.
for method in ("fastable", "openable"):
    run("vpr-query", "s.vprdb", *truth, "--c-l", 20, "--method", method, "-o", f"auto-{method}.json")
    run("vpr-eval", f"auto-{method}.json", *truth, "--expect", source / "test/expected/small-fastable.json")
run("vpr-eval", "fabmap.json", *truth, "--expect", source / "test/expected/small-fabmap.json", "--html", "f.html")
numbers, frames = {}, {}
for name in ("filter", "windows", "fastable", "part", "fabmap"):
    numbers[name], frames[name] = check(name, (f"{name}.json",), truth)
sequences = ("filter", "windows", "fastable", "part")
assert len({frames[name] for name in sequences}) == 1, frames
together = run("vpr-eval", *(f"{name}.json" for name in sequences), *truth)
assert frames_of(together) == frames["filter"], together
for name in sequences:
    assert row(together, name) == numbers[name], (together, numbers[name])
compare(sequences, numbers, frames["filter"])

# A matrix of one training sequence, and lists made from it.
run("vpr-train", "fastable", "--train", "world/corridor", "-o", "c.vprdb", "--quiet")
run("vpr-query", "c.vprdb", "--query", "world/query", "--c-l", 1, "--t-r", 0.4, "--save-matrix", "S.npy", "-o", "one.json",
    "--quiet")
labeled = csv.DictReader((folder / "world/query.ground_truth.csv").open())
band = ["query,reference,label"] + [f"{one['query']},{one['reference']},{one['label']}" for one in labeled
                                    if one["sequence"] == "corridor"]
pairs = [line for line in band if not line.endswith(",ignore")]
truth = ("--ground-truth", write("pairs.csv", "\n".join(pairs) + "\n"))
names = ("--query", "world/query", "--train", "world/corridor")
numbers["single"], frames["single"] = check("single", ("one.json",), truth)
run("vpr-eval", "matrix", "S.npy", "--distance", *names, "--top-k", 5, "--pairs", "list.txt")
matrix, list_ = ("matrix", "S.npy", "--distance"), ("matrix", "list.txt", *names)
numbers["matrix"], frames["matrix"] = check("matrix", matrix, truth)
numbers["list"], frames["list"] = check("list", list_, truth)
with_ignored = ("--ground-truth", write("band.csv", "\n".join(band) + "\n"))
assert check("alone", ("one.json",), with_ignored) == check("both", ("one.json", "--matrix", "S.npy"), with_ignored)
assert read_json("both.report.json")["best_match"]["ignored"]
assert frames["matrix"] == frames["list"] == frames["single"], frames
assert numbers["matrix"][:3] == numbers["single"][:3], numbers
assert numbers["list"][:3] == (numbers["matrix"][0], "-", "-"), numbers
compare(("single", "matrix"), numbers, frames["matrix"])

# Different ground truths: all numbers are over the frames that have a match in both.
few = write("few.csv", "\n".join(line for line in pairs if not line[0].isdigit() or int(line.split(",")[0]) % 3) + "\n")
run("vpr-eval", "one.json", "--ground-truth", few, "-o", "few.report.json", "--quiet")
both = json.loads(run("vpr-eval", "compare", "single.report.json", "few.report.json", "--allow-different", "--json"))
judged = [one for one in csv.DictReader((folder / "single.outcomes.csv").open()) if int(one["frame"]) % 3 or one["has_match"] == "no"]
for one in both["reports"]:
    matched = sum(one["has_match"] == "yes" for one in judged)
    assert one["frames"] == both["frames"]["with_match"] == matched < frames["single"], (both, matched)
    for key, count in (("correct", round(one["localization"]["share"] * matched)),
                       ("incorrect", one["localization"]["incorrect"])):
        assert count == sum(frame["recognition"] == key for frame in judged), (one, key)

# Answers to places: all frames count, and each place has its verdict.
places = json.loads(run("vpr-eval", "one.json", "--json"))["clusters"]
run("vpr-eval", "one.json", "--ask-places", "places.html", "--quiet")
data = re.search(r'id="data">(.*?)</script>', (folder / "places.html").read_text(), re.S)[1]
rows = [one["row"] for one in json.loads(data)["questions"]]
answers = "".join(f"{row},{'yes' if row.startswith('1,') else 'no'}\n" for row in rows
                  if not row.startswith(f"{len(places)},"))
judge = ("vpr-eval", "one.json", "--places", write("places.csv", "place,query,sequence,train,same\n" + answers))
path, text = json.loads(run(*judge, "--json"))["localization"], " ".join(run(*judge, "-v").split())
assert text.startswith(f"{path['recognized']} of {path['frames']} frames recognized, "), text
assert text.count(": incorrect") == len(places) - 2 > 1 and text.count(": not judged") == 1, text

# Labels of the matches of one result: the other is not worse, but not labeled.
best = csv.DictReader((folder / "single.outcomes.csv").open())
labels = write("labels.csv", "query,reference,label,tolerance\n" + "".join(
    f"{one['frame']},{one['train_frame']},{'same' if one['outcome'] == 'correct' else 'different'},0\n" for one in best))
run("vpr-query", "c.vprdb", "--query", "world/query", "--c-l", 20, "--t-r", 0.4, "-o", "other.json", "--quiet")
for words in ((), ("compare",)):
    text = run("vpr-eval", *words, "one.json", "other.json", "--ground-truth", labels)
    assert "*" not in text and "worse" not in text and "without a label count" in text, text
refused(2, "cannot choose settings", "vpr-tune", "c.vprdb", "--query", "world/query", "--ground-truth", labels)

# Loops within the query: frames of the way back through the corridor have none.
run("vpr-query", "loops", "--query", "world/query", "--gap", 40, "--c-l", 10, "--score", "zscore", "--t-r", -1.5,
    "-o", "loops.json", "--quiet")
loops = write("loops.csv", "query,reference\n" + "".join(f"{150 + i},{20 + i}\n" for i in range(40)))
numbers["loops"], frames["loops"] = check("loops", ("loops.json",), ("--ground-truth", loops))
assert frames["loops"] == 40, frames
print("the commands agree on", ", ".join(f"{name} {frames[name]}" for name in frames))
