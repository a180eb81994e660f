#!/usr/bin/env python3
"""Sets anchors and answers questions in the pages of vpr-eval as a user without ground truth would, and
evaluates results with the saved files. Skipped without Chromium.   labeling.py SOURCE BIN"""
import json

from chromium import Chromium
from support import folder, read_json, run, source, write


def saved(browser, button, name=None):
    """The file that a button saves."""
    name = name or button.removeprefix("save-") + ".csv"
    path = folder / name
    path.unlink(missing_ok=True)
    browser.evaluate(f"document.getElementById('{button}').click()")
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


def match_point(browser, query, reference):
    return chart_point(browser, "timeline", query + 0.5, reference + 0.5)


def set_anchors(browser):
    run("vpr-eval", "result.json", "--html", "look.html", "--quiet")
    browser.open(f"{folder}/look.html")
    assert browser.evaluate("document.images.length > 0"), "the images of the run were not found"
    matches = browser.evaluate("window.page.data")["matches"]
    first = next(frame for frame, match in enumerate(matches) if match)
    browser.click(*chart_point(browser, "timeline", first + 7.5, 10))
    assert browser.evaluate("window.page.at()") == first + 7
    browser.evaluate(f"window.page.go({first})")
    # The slider shows the images of its frame and of the best match.
    captions = browser.evaluate("[...document.querySelectorAll('#pair figcaption')].map((one) => one.textContent)")
    name, match = browser.evaluate("[window.page.data.sequences[0], window.page.data.matches[%d]]" % first)
    assert captions[0].startswith(f"query {first}: "), captions
    assert captions[1].startswith(f"best match {name} {match[1]}: "), captions
    assert browser.evaluate("[...document.querySelectorAll('#pair img')].every((one) => one.naturalWidth > 0)")
    browser.press("a")  # without effect while the block is folded
    browser.evaluate("document.getElementById('anchors').open = true")
    assert browser.evaluate("document.getElementById('save-anchors').disabled")
    # Two anchors by the pointer, one of them undone, and one by the keyboard.
    for row, column in ((2, 3), (20, 21), (30, 34)):
        browser.click(*match_point(browser, first + row, first + column))
    browser.click(*match_point(browser, first + 20, first + 21))
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


def set_tolerance(browser, frames):
    browser.evaluate(f"""(() => {{ const input = document.getElementById('tolerance');
        input.value = {frames}; input.dispatchEvent(new Event('input')); }})()""")


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
    asked = [int(one["row"].split(",")[0]) for one in questions if one["end"] == "spread"]
    for count in (10, len(asked)):  # any prefix is spread along the query
        first = sorted(asked[:count])
        assert first[0] < 15 and first[-1] > 75, first
        assert max(b - a for a, b in zip(first, first[1:])) <= 180 // count, first
    set_tolerance(browser, 0)
    for one in questions:
        query, reference = map(int, one["row"].split(","))
        browser.press("y" if reference in truth.get(query, ()) else "n")
    browser.open(f"{folder}/label.html")  # answers and their tolerance remain
    lines = saved(browser, "save", "labels.csv").splitlines()
    assert lines[0] == "query,reference,label,tolerance,asked", lines[0]
    expected = []
    for one in questions:
        query, reference = map(int, one["row"].split(","))
        answer = "same,0" if reference in truth.get(query, ()) else "different,0"
        expected += [*one["also"], f"{query},{reference},{answer},{one['end']}"]
    assert lines[1:] == expected, (lines[:4], expected[:4])
    sample = [line for line in expected if line.endswith("spread")]
    # Frames before the first window are in the sample without a question.
    early = [int(line.split(",")[0]) for line in sample if ",,," in line]
    assert early and max(early) < min(asked), (early, min(asked))
    assert f"also has {len(early)} frame" in browser.evaluate("document.body.textContent"), len(early)
    correct = sum("same" in line for line in sample)
    own = judge("result.json", "labels.csv")
    assert own["best_match"]["correct"] == correct, (own["best_match"], correct)
    assert own["best_match"]["frames"] == own["estimate"]["frames"] == 50, own["best_match"]
    text = " ".join(run("vpr-eval", "result.json", "--ground-truth", "labels.csv").split())
    assert f"estimated from 50 frames spread along the query: {2 * correct} % (" in text, text
    # Labels without the column: not a sample.
    write("plain.csv", "".join(line.rsplit(",", 1)[0] + "\n" for line in lines if ",,," not in line))
    text = " ".join(run("vpr-eval", "result.json", "--ground-truth", "plain.csv").split())
    assert f"over {len(questions)} of 90 frames that are labeled" in text, text
    assert "not a sample of the query. Caution: the labels were made from this result." in text, text
    # Another result: matches without a label are unknown.
    write("rows.csv", "query,reference\n" + "".join(
        f"{query},{one}\n" for query in sorted(truth) for one in sorted(truth[query]) if query < 90))
    other, known = judge("other.json", "labels.csv"), judge("other.json", "rows.csv")
    same = {int(line.split(",")[0]) for line in expected if "same" in line}
    for frame, (by_label, by_truth) in enumerate(zip(other["outcomes"]["best"], known["outcomes"]["best"])):
        assert by_label != "w" or by_truth in "wW", (frame, by_label, by_truth)
        assert by_label != "c" or frame in same, (frame, by_label)
    text = " ".join(run("vpr-eval", "other.json", "--ground-truth", "labels.csv").split())
    open_matches = other["best_match"]["ignored"]
    assert "Caution" not in text and ("estimated from" in text) == (open_matches == 0), text
    # Only the matches that are not labeled are asked, those of the sample first. All rows are saved.
    run("vpr-eval", "other.json", "--ground-truth", "labels.csv", "--ask-frames",
        "more.html", "--quiet")
    browser.open(f"{folder}/more.html")
    more = browser.evaluate("window.data.questions")
    known = {line.split(",")[0] for line in sample}
    assert sum(one["end"] == "spread" for one in more) == open_matches > 0, len(more)
    assert all((one["row"].split(",")[0] in known) == (one["end"] == "spread") for one in more)
    for one in more:
        browser.press("y")
    both = saved(browser, "save", "labels.csv").splitlines()
    assert both[1:len(lines)] == lines[1:] and len(both) == len(lines) + len(more), len(both)
    assert judge("other.json", "labels.csv")["estimate"]["frames"] == 50


def estimate_from_a_sample(browser):
    """A person who knows the truth, by which 3 % of the matches are wrong, answers in three orders,
    continues with a second page and reloads it: the interval covers the truth, whatever share of the
    questions is answered."""
    best = json.loads(run("vpr-eval", "result.json", "--ground-truth", "aligned", "--json"))["outcomes"]["best"]
    frames = [frame for frame, letter in enumerate(best) if letter.lower() != "u"]
    wrong = set(frames[11::33][:round(0.03 * len(frames))])
    rate = (len(frames) - len(wrong)) / len(best)  # the first window ends later than the first frame

    def ask(page, order, most, *labels):
        run("vpr-eval", "result.json", *labels, "--ask-frames", page, "--quiet", "--force")
        browser.open(f"{folder}/{page}")
        rows = [one["row"] for one in browser.evaluate("window.data.questions")]
        where = browser.evaluate("document.getElementById('where').textContent")
        assert f"0 yes, 0 no, {len(rows)} open" in where, where  # nothing is answered that was not asked
        numbers = list(range(len(rows)))[:most]
        if order != "asked":
            numbers = numbers[::-1] if order == "reversed" else numbers[1::2] + numbers[::2]
        at = 0
        for number in numbers:
            for _ in range(abs(number - at)):
                browser.press("ArrowRight" if number > at else "ArrowLeft")
            browser.press("n" if int(rows[number].split(",")[0]) in wrong else "y")
            at = number + 1
        lines = saved(browser, "save", "labels.csv").splitlines()
        assert len(lines) == len(set(lines)), lines
        return lines

    for order in ("asked", "reversed", "mixed"):
        browser.evaluate("localStorage.clear()")
        first = ask("first.html", order, 30)
        second = ask("second.html", order, 1000, "--ground-truth", "labels.csv")
        assert second[1:len(first)] == [line.replace("decision", "spread") if line.split(",")[0] in
                                {one.split(",")[0] for one in second if one.endswith("spread")} else line
                                for line in first[1:]], (first, second)
        for lines in (first, second):
            write("labels.csv", "".join(line + "\n" for line in lines))
            report = json.loads(run("vpr-eval", "result.json", "--ground-truth", "labels.csv", "--json"))
            found = report["estimate"]
            assert found["low"] <= rate <= found["high"], (order, found, rate)
            assert found["frames"] == sum(line.endswith("spread") for line in lines), found


def answer_places(browser):
    """Answers by keys and buttons, with one undone, then evaluates the saved file."""
    run("vpr-eval", "result.json",
        "--ask-places", "places.html", "-o", "totals.json", "--quiet")
    totals = read_json("totals.json")
    places = totals["clusters"]
    count = len(places)
    assert count >= 4, count

    def text(name):
        return browser.evaluate(f"document.getElementById('{name}').textContent")

    browser.open(f"{folder}/places.html")
    questions = browser.evaluate("window.data.questions")
    asked = len(questions)
    place_of = [int(one["row"].split(",")[0]) for one in questions]
    assert place_of == sorted(place_of) and set(place_of) == set(range(1, count + 1)), place_of
    for i, place in enumerate(places, 1):
        if place_of.count(i) == 1:  # one part: the place itself
            assert f"{i},{place['query']},{place['sequence']},{place['train']}" in [one["row"] for one in questions]
    assert text("where").startswith(f"1 of {asked}: "), text("where")
    assert browser.evaluate("[...document.images].every((one) => one.naturalWidth > 0)")
    browser.press("y")
    browser.press("y")
    browser.press("ArrowLeft")
    browser.press("n")
    browser.evaluate("document.getElementById('yes').click()")
    before = browser.questions
    browser.open(f"{folder}/places.html")  # answers remain
    assert browser.questions == before + 1, "the page may be left without a question"
    assert text("where").endswith(f"2 yes, 1 no, {asked - 3} open."), text("where")
    browser.press("u")
    for _ in range(asked):  # without effect at the end
        browser.press("n")
    assert text("question") == "Done"
    lines = saved(browser, "save", "places.csv").splitlines()
    answers = ["yes", "no", "yes", None] + ["no"] * (asked - 4)
    assert lines[0] == "place,query,sequence,train,same", lines[0]
    assert lines[1:] == [f"{one['row']},{answer}" for one, answer in zip(questions, answers) if answer], lines
    report = json.loads(run("vpr-eval", "result.json", "--places", "places.csv", "--json"))
    by_place = report["counts"]["pairs_by_cluster"]
    assert sum(report["counts"]["clusters"].values()) == count, report["counts"]
    assert sum(by_place.values()) == sum(place["recognitions"]["ignored"] for place in places), by_place
    assert min(by_place.values()) > 0, by_place
    assert report["localization"]["correct"] > 0 < report["localization"]["incorrect"], report["localization"]
    said = " ".join(run("vpr-eval", "result.json", "--places", "places.csv").split())
    most = max(int(one["about"].split()[0]) for one, answer in zip(questions, answers) if answer)
    assert f", by {asked - 1} answers, each for at most {most} frames" in said and most <= 50, said


def mark_places(browser):
    """Marks training frames as places of FAB-MAP, which train a database and judge its result."""
    run("vpr-eval", "result.json", "--ask-fabmap", "mark.html", "--quiet")
    browser.open(f"{folder}/mark.html")
    questions = browser.evaluate("window.data.questions")
    frames = [int(one["row"].removeprefix("corridor,")) for one in questions]
    assert len(frames) == 60 and frames == sorted(set(frames)), frames
    assert browser.evaluate("document.querySelectorAll('#pairs img').length") == 2
    assert browser.evaluate("[...document.images].every((one) => one.naturalWidth > 0)")
    set_tolerance(browser, 4)
    browser.evaluate("""(() => { const slider = document.getElementById('frame');
        slider.value = 33; slider.dispatchEvent(new Event('input')); })()""")
    assert "query 33, " in browser.evaluate("document.getElementById('pairs').textContent")
    for key in "yunu":
        browser.press(key)
    suggested = questions[4]["pairs"][0][0]
    browser.press("y")
    browser.open(f"{folder}/mark.html")  # answers and the chosen frame remain
    lines = saved(browser, "save", "fabmap-places.csv").splitlines()
    assert lines == ["sequence,train,query,tolerance", f"corridor,{frames[0]},33,4", f"corridor,{frames[2]},,",
                     f"corridor,{frames[4]},{suggested},4"], lines
    run("vpr-train", "fabmap", "--pretrain", "world/upstairs", "--train", "world/corridor", "--marked-places", "fabmap-places.csv",
        "--features", "orb", "--words", 50, "-o", "f.vprdb", "--quiet")
    run("vpr-query", "f.vprdb", "--query", "world/query@0:90", "-o", "fabmap.json", "--quiet")
    report = json.loads(run("vpr-eval", "fabmap.json", "--ground-truth", "fabmap-places.csv", "--json"))
    assert report["localization"]["frames_with_match"] == len(
        {*range(29, 38), *range(max(0, suggested - 4), suggested + 5)}), report["localization"]


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
    for part in (set_anchors, label_frames, estimate_from_a_sample, answer_places, mark_places, relabel_with_truth):
        part(browser)
