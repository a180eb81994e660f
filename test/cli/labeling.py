#!/usr/bin/env python3
"""Sets anchors and answers questions in the pages of vpr-eval as a user without ground truth would, and
evaluates results with the saved files. Skipped without Chromium.   labeling.py SOURCE BIN"""
import json

from chromium import Chromium
from support import folder, read_json, run, source, write


def saved(browser, button, name=None):
    """The file that a button saves."""
    name = name or button.removeprefix("save-") + ".csv"
    browser.evaluate(f"document.getElementById('{button}').click()")
    path = folder / name
    browser.wait(lambda: path.exists() and not (folder / f"{name}.crdownload").exists())
    return path.read_text()


def chart_point(browser, chart, x, y):
    """The position of a value on the screen, after scrolling to the chart."""
    browser.evaluate(f"document.querySelector('svg.{chart}').scrollIntoView({{block: 'nearest', behavior: 'instant'}})")
    return browser.evaluate(f"""(() => {{
        const svg = document.querySelector('svg.{chart}'), {{axis, pixel}} = window.page;
        const at = new DOMPoint(pixel(axis(svg, 'x'), {x}), pixel(axis(svg, 'y'), {y})).matrixTransform(svg.getScreenCTM());
        return [at.x, at.y];
    }})()""")


def matrix_point(browser, row, column):
    return chart_point(browser, "matrix", column + 0.5, row + 0.5)


def set_anchors(browser):
    run("vpr-eval", "result.json", "--html", "look.html", "--quiet")
    browser.open(f"{folder}/look.html")
    assert browser.evaluate("document.images.length > 0"), "the images of the run were not found"
    matches = browser.evaluate("window.page.data")["matches"]
    first = next(frame for frame, match in enumerate(matches) if match)
    browser.call("Input.dispatchMouseEvent", type="mouseMoved",
                 **dict(zip("xy", matrix_point(browser, 20, 21))))
    browser.click(*chart_point(browser, "timeline", first + 7.5, 10))
    assert browser.evaluate("window.page.at()") == first + 7
    browser.evaluate(f"window.page.go({first})")
    cell = browser.evaluate("document.getElementById('cell').textContent")
    assert cell.startswith(f"Query frame {first + 20}, "), cell
    browser.press("a")  # without effect while the block is folded
    browser.evaluate("document.getElementById('anchors').open = true")
    assert browser.evaluate("document.getElementById('save-anchors').disabled")
    # Two anchors by the pointer, one of them undone, and one by the keyboard.
    for row, column in ((2, 3), (20, 21), (30, 34)):
        browser.click(*matrix_point(browser, row, column))
    browser.click(*matrix_point(browser, 20, 21))
    browser.evaluate(f"window.page.go({first + 39})")
    browser.press("j")
    browser.press("a")
    counts = browser.evaluate("document.getElementById('anchored').textContent")
    assert counts == "3 anchors.", counts
    lines = saved(browser, "save-anchors").splitlines()
    pixel = 1 + len(matches) // 400  # error in cells of a screen pixel
    assert lines[0] == "query,anchor", lines
    assert len(lines) == 4, lines
    found = [tuple(map(int, line.split(","))) for line in lines[1:]]
    for (query, reference), (row, column) in zip(found, ((2, 3), (30, 34))):
        assert abs(query - first - row) <= pixel and abs(reference - first - column) <= pixel, found
    assert found[2] == (first + 40, matches[first + 40][1]), found
    judged = json.loads(run("vpr-eval", "result.json", "--ground-truth", "anchors.csv",
                            "--tolerance", "5", "--json"))
    begin, end = found[0][0], found[2][0]
    letters = judged["outcomes"]["best"]  # there is a place between the first and the last anchor
    assert letters[begin:end + 1].islower() and set(letters[end + 1:]) == {"W"}, letters
    assert letters[end] == "c", letters


def label_frames(browser):
    """Labels that a person gives judge the result they were made from, and another one, as the
    ground truth does."""
    truth = {}
    for line in (folder / "world/query.ground_truth.csv").read_text().splitlines()[1:]:
        query, sequence, reference, label = line.split(",")
        if sequence == "corridor" and label == "same":
            truth.setdefault(int(query), set()).add(int(reference))

    def judge(result, labels):
        return json.loads(run("vpr-eval", result, "--ground-truth", labels, "--json"))

    run("vpr-eval", "result.json", "--ask-frames", "label.html", "--quiet")
    browser.open(f"{folder}/label.html")
    questions = browser.evaluate("window.data.questions")
    assert browser.evaluate("[...document.images].every((one) => one.naturalWidth > 0)")
    assert len({one["row"] for one in questions}) == len(questions) > 80, len(questions)
    asked = [int(one["row"].split(",")[0]) for one in questions]
    assert asked[:50] == sorted(asked[:50]) and asked[49] - asked[0] > 70, asked
    browser.evaluate("document.getElementById('tolerance').value = 3")
    for one in questions:
        query, reference = map(int, one["row"].split(","))
        browser.press("y" if reference in truth.get(query, ()) else "n")
    lines = saved(browser, "save", "labels.csv").splitlines()
    assert lines[0] == "query,reference,label,tolerance", lines[0]
    expected = []
    for one in questions:
        query, reference = map(int, one["row"].split(","))
        answer = "same,3" if reference in truth.get(query, ()) else "different,0"
        expected.append(f"{query},{reference},{answer}")
    assert lines[1:] == expected, (lines[:4], expected[:4])
    correct = sum("same" in line for line in expected)
    own = judge("result.json", "labels.csv")
    assert own["best_match"]["correct"] == correct, (own["best_match"], correct)
    assert own["best_match"]["frames"] == len(questions), own["best_match"]
    text = run("vpr-eval", "result.json", "--ground-truth", "labels.csv")
    text = " ".join(text.split())
    assert f"over {len(questions)} of 90 frames that are labeled" in text, text
    assert "Caution: the labels were made from this result." in text, text
    # Another result: matches without a label are unknown.
    write("rows.csv", "query,reference\n" + "".join(
        f"{query},{one}\n" for query in sorted(truth) for one in sorted(truth[query]) if query < 90))
    other, known = judge("other.json", "labels.csv"), judge("other.json", "rows.csv")
    same = {int(line.split(",")[0]) for line in expected if "same" in line}
    for frame, (by_label, by_truth) in enumerate(zip(other["outcomes"]["best"], known["outcomes"]["best"])):
        assert by_label != "w" or by_truth in "wW", (frame, by_label, by_truth)
        assert by_label != "c" or frame in same, (frame, by_label)
    assert "Caution" not in run("vpr-eval", "other.json", "--ground-truth", "labels.csv")
    # Only the matches that are not labeled are asked.
    run("vpr-eval", "other.json", "--ground-truth", "labels.csv", "--ask-frames",
        "more.html", "--quiet")
    browser.open(f"{folder}/more.html")
    assert len(browser.evaluate("window.data.questions")) == other["outcomes"]["best"].lower().count("i")


def answer_places(browser):
    """Answers by keys and buttons, with one undone, then evaluates the saved file."""
    run("vpr-eval", "result.json",
        "--ask-places", "places.html", "-o", "totals.json", "--quiet")
    totals = read_json("totals.json")
    places = totals["recognized_places"]
    count = len(places)
    assert count >= 4, count

    def text(name):
        return browser.evaluate(f"document.getElementById('{name}').textContent")

    browser.open(f"{folder}/places.html")
    assert text("where").startswith(f"1 of {count}: "), text("where")
    assert browser.evaluate("[...document.images].every((one) => one.naturalWidth > 0)")
    browser.press("y")
    browser.press("y")
    browser.press("ArrowLeft")
    browser.press("n")
    browser.evaluate("document.getElementById('yes').click()")
    browser.open(f"{folder}/places.html")  # answers remain
    assert browser.questions == 1, "the page may be left without a question"
    assert text("where").endswith(f"2 yes, 1 no, {count - 3} open."), text("where")
    browser.press("u")
    for _ in range(count):  # without effect at the end
        browser.press("n")
    assert text("question") == "Done"
    lines = saved(browser, "save", "places.csv").splitlines()
    answers = ["yes", "no", "yes", None] + ["no"] * (count - 4)
    assert lines[0] == "place,query,sequence,train,same", lines[0]
    assert lines[1:] == [f"{i},{place['query']},{place['sequence']},{place['train']},{answer}"
                         for i, (place, answer) in enumerate(zip(places, answers), 1) if answer], lines
    report = json.loads(run("vpr-eval", "result.json", "--places", "places.csv", "--json"))
    by_place = dict.fromkeys(("correct", "incorrect", "ignored"), 0)
    for place, answer in zip(places, answers):
        key = {"yes": "correct", "no": "incorrect", None: "ignored"}[answer]
        by_place[key] += place["recognitions"]["ignored"]
    assert report["counts"]["places"] == {"correct": 2, "incorrect": count - 3, "ignored": 1}
    assert report["counts"]["pairs_by_place"] == by_place, (report["counts"], by_place)


def relabel_with_truth(browser):
    run("vpr-eval", "result.json", "--ground-truth", "aligned", "--html", "judged.html",
        "-o", "report.json", "--quiet")
    browser.open(f"{folder}/judged.html")
    report = read_json("report.json")
    best = report["outcomes"]["best"]
    wrong = [frame for frame, letter in enumerate(best) if letter in "wW"]
    lines = saved(browser, "save-disagreements").splitlines()
    assert lines[0] == "query,reference,score,recognized,ground_truth", lines[0]
    assert [int(line.split(",")[0]) for line in lines[1:]] == wrong
    browser.evaluate("document.getElementById('anchors').open = true")
    browser.press("n")
    said = browser.evaluate("document.getElementById('said').textContent")
    assert said.startswith(f"Frame {wrong[0]}: "), said
    follow_threshold(browser, report)


def follow_threshold(browser, report):
    """The slider's counts equal those of the curve's loosest threshold, and change with it."""
    def accepted(position):
        browser.evaluate(f"""(() => {{ const slider = document.getElementById('threshold');
            slider.value = {position}; slider.dispatchEvent(new Event('input')); }})()""")
        return browser.evaluate("document.getElementById('accepted').textContent")

    last = report["curves"]["single_best"]["points"][-1]
    assert f": {last['correct']} correct, {last['incorrect']} incorrect" in accepted(10 ** 6)
    assert accepted(0) != accepted(10 ** 6)


run("vpr-synth", source / "configs/worlds/small.json", "-o", "world", "--quiet")
run("vpr-train", "fastable", "--train", "world/corridor", "-o", "w.vprdb", "--quiet")
query = ("vpr-query", "w.vprdb", "--query", "world/query@0:90", "--quiet", "-o")
run(*query, "result.json", "--c-l", 3, "--t-r", 0.4)
run(*query, "other.json")
with Chromium(folder / "profile") as browser:
    browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
    for part in (set_anchors, label_frames, answer_places, relabel_with_truth):
        part(browser)
