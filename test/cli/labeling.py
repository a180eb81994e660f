#!/usr/bin/env python3
"""Labels a result in the page of vpr-eval as a user without ground truth would, and evaluates it with
the saved file. Skipped without Chromium.   labeling.py SOURCE BIN"""
import json
import os
import subprocess
import sys
import tempfile

from chromium import PROGRAM, Chromium

if PROGRAM is None:
    print("chromium is missing")
    sys.exit(77)


def run(bin, folder, *words):
    done = subprocess.run([f"{bin}/{words[0]}", *words[1:]], cwd=folder, text=True,
                          capture_output=True)
    assert done.returncode == 0, (words, done.stderr)
    return done.stdout


def saved(browser, folder, button, name=None):
    """The file that a button saves."""
    name = name or button.removeprefix("save-") + ".csv"
    browser.evaluate(f"document.getElementById('{button}').click()")
    path = f"{folder}/{name}"
    browser.wait(lambda: os.path.exists(path) and not os.path.exists(path + ".crdownload"))
    return open(path).read()


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


def label_without_truth(browser, folder, bin):
    run(bin, folder, "vpr-eval", "result.json", "--html", "look.html", "--quiet")
    browser.open(f"{folder}/look.html")
    data = browser.evaluate("window.page.data")
    matches = data["matches"]
    first = next(frame for frame, match in enumerate(matches) if match)
    browser.call("Input.dispatchMouseEvent", type="mouseMoved",
                 **dict(zip("xy", matrix_point(browser, 20, 21))))
    browser.click(*chart_point(browser, "timeline", first + 7.5, 10))
    assert browser.evaluate("window.page.at()") == first + 7
    browser.evaluate(f"window.page.go({first})")
    cell = browser.evaluate("document.getElementById('cell').textContent")
    assert cell.startswith(f"Query frame {first + 20}, "), cell
    browser.press("s")  # without effect while the block is folded
    browser.evaluate("document.getElementById('labels').open = true")
    for key in "sjdjij":  # frames first, first + 1 and first + 2
        browser.press(key)
    browser.press("s")
    browser.press("u")
    lines = saved(browser, folder, "save-pairs").splitlines()
    assert lines[0] == "query,reference,label", lines[0]
    expected = [f"{frame},{match[1]},{'same' if frame == first else 'ignore'}"
                for frame, match in enumerate(matches) if match and frame != first + 1]
    assert lines[1:] == expected, (lines[:5], expected[:4])
    report = json.loads(run(bin, folder, "vpr-eval", "result.json", "--ground-truth", "pairs.csv",
                            "--json"))
    best = report["outcomes"]["best"]
    assert best[:first + 2] == "U" * first + "cW", best[:9]
    assert set(best[first + 2:]) == {"I"}, best
    # Two anchors by the pointer, one of them undone, and one by the keyboard.
    for row, column in ((2, 3), (20, 21), (30, 34)):
        browser.click(*matrix_point(browser, row, column))
    browser.click(*matrix_point(browser, 20, 21))
    browser.evaluate(f"window.page.go({first + 40})")
    browser.press("a")
    lines = saved(browser, folder, "save-anchors").splitlines()
    pixel = 1 + len(matches) // 400  # error in cells of a screen pixel
    assert lines[0] == "query,reference", lines
    assert len(lines) == 4, lines
    found = [tuple(map(int, line.split(","))) for line in lines[1:]]
    for (query, reference), (row, column) in zip(found, ((2, 3), (30, 34))):
        assert abs(query - first - row) <= pixel and abs(reference - first - column) <= pixel, found
    assert found[2] == (first + 40, matches[first + 40][1]), found
    judged = json.loads(run(bin, folder, "vpr-eval", "result.json", "--ground-truth", "anchors.csv",
                            "--tolerance", "5", "--json"))
    begin, end = found[0][0], found[2][0]
    letters = judged["outcomes"]["best"]  # there is a place between the first and the last anchor
    assert letters[begin:end + 1].islower() and set(letters[end + 1:]) == {"W"}, letters
    assert letters[end] == "c", letters
    counts = browser.evaluate("document.getElementById('labeled').textContent")
    assert counts.endswith("1 same, 1 different, 1 ignored, 3 anchors."), counts


def answer_places(browser, folder, bin):
    """Answers by keys and buttons, with one undone, then evaluates the saved file."""
    run(bin, folder, "vpr-eval", "result.json", "--query", "world/query@0:90", "--train", "world/corridor",
        "--ask-places", "places.html", "-o", "totals.json", "--quiet")
    totals = json.load(open(f"{folder}/totals.json"))
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
    assert text("where").endswith(f"2 yes, 1 no, {count - 3} open."), text("where")
    browser.press("u")
    for _ in range(count):  # without effect at the end
        browser.press("n")
    assert text("question") == "Done"
    lines = saved(browser, folder, "save", "places.csv").splitlines()
    answers = ["yes", "no", "yes", None] + ["no"] * (count - 4)
    assert lines[0] == "place,query,sequence,train,same", lines[0]
    assert lines[1:] == [f"{i},{place['query']},{place['sequence']},{place['train']},{answer}"
                         for i, (place, answer) in enumerate(zip(places, answers), 1) if answer], lines
    report = json.loads(run(bin, folder, "vpr-eval", "result.json", "--places", "places.csv", "--json"))
    by_place = dict.fromkeys(("correct", "incorrect", "ignored"), 0)
    for place, answer in zip(places, answers):
        key = {"yes": "correct", "no": "incorrect", None: "ignored"}[answer]
        by_place[key] += place["recognitions"]["ignored"]
    assert report["counts"]["places"] == {"correct": 2, "incorrect": count - 3, "ignored": 1}
    assert report["counts"]["pairs_by_place"] == by_place, (report["counts"], by_place)


def relabel_with_truth(browser, folder, bin):
    run(bin, folder, "vpr-eval", "result.json", "--ground-truth", "aligned", "--html", "judged.html",
        "-o", "report.json", "--quiet")
    browser.open(f"{folder}/judged.html")
    report = json.load(open(f"{folder}/report.json"))
    best = report["outcomes"]["best"]
    wrong = [frame for frame, letter in enumerate(best) if letter in "wW"]
    lines = saved(browser, folder, "save-disagreements").splitlines()
    assert lines[0] == "query,reference,score,recognized,ground_truth", lines[0]
    assert [int(line.split(",")[0]) for line in lines[1:]] == wrong
    browser.evaluate("document.getElementById('labels').open = true")
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


def main(source, bin):
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        run(bin, folder, "vpr-synth", f"{source}/configs/worlds/small.json", "-o", "world", "--quiet")
        run(bin, folder, "vpr-train", "fastable", "--train", "world/corridor", "-o", "w.vprdb", "--quiet")
        run(bin, folder, "vpr-query", "w.vprdb", "--query", "world/query@0:90", "--c-l", "3",
            "--t-r", "0.4", "-o", "result.json", "--quiet")
        with Chromium(f"{folder}/profile") as browser:
            browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=folder)
            label_without_truth(browser, folder, bin)
            answer_places(browser, folder, bin)
            relabel_with_truth(browser, folder, bin)


main(*sys.argv[1:])
