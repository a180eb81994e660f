"""The Python module: the same bytes as the programs, arrays without copies, errors, interruption."""

import html
import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import vpr


def written(path):
    """The content of a JSON file except what may differ between two runs."""
    content = json.loads(path.read_text())
    for key in ("machine", "timing"):
        content.pop(key, None)
    return content


def assert_same_results(one, other):
    assert written(one) == written(other)
    assert one.with_suffix(".npz").read_bytes() == other.with_suffix(".npz").read_bytes()


def assert_same_databases(one, other):
    names = {path.name for path in other.iterdir()} - {"paths.txt"}
    assert {path.name for path in one.iterdir()} - {"paths.txt"} == names
    for name in names:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name


def flags(settings):
    """Command line flags of keyword arguments."""
    result = []
    for key, value in settings.items():
        result += ["--" + key.replace("_", "-")] + ([] if value is True else [value])
    return result


@pytest.mark.parametrize("settings", [{}, {"metric": "l2"}, {"value_bits": 8, "c_l": 10}])
@pytest.mark.parametrize("order", ["C", "F"])
def test_vectors_are_trained_as_by_the_program(run, walks, tmp_path, settings, order):
    monday = np.asarray(np.load(walks / "monday.npy"), order=order)
    db = vpr.train(descriptors={"monday": monday}, **settings)
    db.save(tmp_path / "p.vprdb")
    run("vpr-train", "descriptors", "--train", "monday.npy", *flags(settings), "-o",
        tmp_path / "c.vprdb", folder=walks)
    assert_same_databases(tmp_path / "p.vprdb", tmp_path / "c.vprdb")


def test_images_are_trained_as_by_the_program(run, walks, tmp_path):
    db = vpr.train([walks / "monday", walks / "other"], c_l=10)
    db.save(tmp_path / "p.vprdb")
    assert db.sequences == ["monday", "other"]
    run("vpr-train", "fastable", "--train", walks / "monday", "--train", walks / "other", "--c-l",
        10, "-o", tmp_path / "c.vprdb", folder=walks)
    assert_same_databases(tmp_path / "p.vprdb", tmp_path / "c.vprdb")


QUERIES = [{}, {"c_l": 5, "t_r": 0.6}, {"c_l": 5, "score": "zscore", "decide": "margin"},
           {"method": "openable", "c_l": 5, "t_r": 0.6}, {"speed": "0.5"}]


@pytest.mark.parametrize("settings", QUERIES)
@pytest.mark.parametrize("kind", ["", "_bits"])
def test_arrays_are_matched_as_by_the_program(run, walks, tmp_path, settings, kind):
    bits = ["--bits"] if kind else []
    run("vpr-train", "descriptors", "--train", f"monday{kind}.npy", *bits, "--c-l", 5, "-o",
        tmp_path / "db.vprdb", folder=walks)
    run("vpr-query", tmp_path / "db.vprdb", "--query", f"tuesday{kind}.npy", *flags(settings),
        "-o", tmp_path / "c.json", folder=walks)
    db = vpr.train(descriptors={f"monday{kind}": np.load(walks / f"monday{kind}.npy")}, c_l=5)
    for source in (db, vpr.load(tmp_path / "db.vprdb")):
        result = vpr.query(source, descriptors=np.load(walks / f"tuesday{kind}.npy"),
                           name=f"tuesday{kind}", **settings)
        result.save(tmp_path / "p.json", force=True)
        assert_same_results(tmp_path / "p.json", tmp_path / "c.json")


def test_arrays_of_pairs_are_numbers_of_frames(walks, tmp_path):
    for side in ("monday", "tuesday"):  # images 1.png, 2.png, ... are frames 0, 1, ...
        (tmp_path / side).mkdir()
        for i, path in enumerate(sorted((walks / side).iterdir())):
            os.symlink(path, tmp_path / side / f"{i + 1}{path.suffix}")
    result = vpr.query(vpr.train(tmp_path / "monday"), tmp_path / "tuesday", c_l=5, t_r=0.5)
    some = np.arange(10, 20)
    labels = np.zeros((result.json.query.frames, result.json.sequences[0].frames), bool)
    labels[some, some] = True
    by_pairs, by_labels = (vpr.evaluate(result, truth) for truth in (np.c_[some, some], labels))
    assert np.array_equal(by_pairs.frames()["has_match"], by_labels.frames()["has_match"])
    assert by_pairs.json.metrics == by_labels.json.metrics


@pytest.mark.parametrize("settings", QUERIES[:3])
def test_images_are_matched_as_by_the_program(run, walks, tmp_path, settings):
    db = vpr.train(walks / "monday", c_l=5)
    db.save(tmp_path / "db.vprdb")
    result = vpr.query(db, walks / "tuesday", **settings)
    result.save(tmp_path / "p.json")
    assert np.array_equal(np.load(tmp_path / "p.npz")["best"][:, 2], result.best["train"])
    run("vpr-query", tmp_path / "db.vprdb", "--query", walks / "tuesday", *flags(settings), "-o",
        tmp_path / "c.json", folder=walks)
    assert_same_results(tmp_path / "p.json", tmp_path / "c.json")
    assert len(result.recognitions) > 0


def test_places_are_recognized_as_by_the_program(run, walks, tmp_path):
    settings = {"features": "orb", "words": 50}
    db = vpr.train(walks / "monday", pretrain=walks / "other", **settings)
    db.save(tmp_path / "p.vprdb")
    run("vpr-train", "fabmap", "--pretrain", walks / "other", "--train", walks / "monday",
        *flags(settings), "-o", tmp_path / "c.vprdb", folder=walks)
    assert_same_databases(tmp_path / "p.vprdb", tmp_path / "c.vprdb")
    places = vpr.query(vpr.load(tmp_path / "c.vprdb"), walks / "tuesday", t_p=0.5)
    places.save(tmp_path / "p.json")
    assert places.best.dtype.names == ("query", "sequence", "train", "view")
    with pytest.raises(AttributeError, match="no margins"):
        places.margins
    run("vpr-query", tmp_path / "c.vprdb", "--query", walks / "tuesday", "--t-p", 0.5, "-o",
        tmp_path / "c.json", folder=walks)
    assert_same_results(tmp_path / "p.json", tmp_path / "c.json")
    with pytest.raises(vpr.DataError, match="has no frame descriptors"):
        db.descriptors
    for method in ("filter", "nonsense"):
        with pytest.raises(vpr.DataError, match=f"which {method} cannot use"):
            vpr.query(db, walks / "tuesday", method=method)
    with pytest.raises(vpr.UsageError, match="loop_gap has no effect on a query"):
        vpr.query(db, walks / "tuesday", loop_gap=3)


@pytest.mark.parametrize("settings", [
    {"loop_gap": 100, "c_l": 5, "t_r": 0.6},
    {"loop_gap": 100, "c_l": 5, "score": "zscore", "decide": "margin", "margin": 1},
    {"loop_gap_s": 100.5, "c_l": 5, "frame_times": "times.txt"}])
def test_loops_are_found_as_by_the_program(run, walks, tmp_path, settings):
    laps = np.concatenate([np.load(walks / f"{day}.npy") for day in ("monday", "tuesday")])
    np.save(tmp_path / "query.npy", laps)
    (tmp_path / "times.txt").write_text("".join(f"{i}.5\n" for i in range(400)))
    given = dict(settings)
    gap = given.pop("loop_gap", None) or f"{given.pop('loop_gap_s')}s"
    run("vpr-query", "loops", "--query", "query.npy", "--gap", gap, *flags(given), "-o",
        "c.json", folder=tmp_path)
    if "frame_times" in settings:
        settings = {**settings, "frame_times": str(tmp_path / "times.txt")}
    result = vpr.loops(descriptors=laps, **settings)
    assert len(result.best) > 300
    result.save(tmp_path / "p.json")
    assert_same_results(tmp_path / "p.json", tmp_path / "c.json")


def test_loops_of_places_are_found_as_by_the_program(run, walks, tmp_path):
    db = vpr.train(walks / "monday", pretrain=walks / "other", features="orb", words=50)
    db.save(tmp_path / "db.vprdb")
    vpr.loops(walks / "tuesday", db=db, loop_gap=20, t_p=0.5).save(tmp_path / "p.json")
    run("vpr-query", "loops", tmp_path / "db.vprdb", "--query", walks / "tuesday", "--gap", 20,
        "--t-p", 0.5, "-o", tmp_path / "c.json", folder=walks)
    assert_same_results(tmp_path / "p.json", tmp_path / "c.json")
    with pytest.raises(vpr.DataError, match="have no database"):
        vpr.loops(walks / "tuesday", db=vpr.train(walks / "monday"), loop_gap=20)


def matched(walks, **settings):
    db = vpr.train(descriptors=walks / "monday.npy", c_l=5)
    return vpr.query(db, descriptors=walks / "tuesday.npy", c_l=5, t_r=0.5, **settings)


@pytest.mark.parametrize("saved", [False, True])
def test_results_are_judged_as_by_the_program(run, walks, tmp_path, saved):
    result = matched(walks)
    result.save(tmp_path / "r.json")
    if saved:
        result = vpr.load(tmp_path / "r.json")
    report = vpr.evaluate(result, "aligned", tolerance=3, recall_at=[1, 5])
    report.save(tmp_path / "p.json")
    run("vpr-eval", tmp_path / "r.json", "--ground-truth", "aligned", "--tolerance", 3,
        "-o", tmp_path / "c.json", folder=walks)
    program = written(tmp_path / "c.json")
    assert written(tmp_path / "p.json") == program
    assert report.recall_at[1] == program["metrics"]["recall_at"]["1"]
    assert report.counts.pairs.correct == program["counts"]["pairs"]["correct"] > 0
    assert report.counts.recognitions == report.counts.pairs
    assert 0 < report.curve[-1, 1] <= report.single_best.positives
    report.html(tmp_path / "page.html")
    assert report.summary in (tmp_path / "page.html").read_text()
    assert "<iframe" in report._repr_html_() and report.summary in repr(report)


def test_reports_show_ten_images_in_a_notebook(walks):
    result = vpr.query(vpr.train(walks / "monday"), walks / "tuesday", c_l=5, t_r=0.6)
    page = html.unescape(vpr.evaluate(result, "aligned", tolerance=3)._repr_html_())
    assert page.count("<img") == 10 and "<svg" in page


def test_scores_are_judged_as_by_the_program(run, walks, tmp_path):
    scores = np.load(walks / "tuesday.npy") @ np.load(walks / "monday.npy").T
    np.save(tmp_path / "S.npy", scores)
    run("vpr-eval", "matrix", "S.npy", "--similarity", "--ground-truth", "aligned", "-o", "c.json",
        folder=tmp_path)
    for given in (scores, np.asfortranarray(scores)[:, ::1], tmp_path / "S.npy"):
        report = vpr.evaluate_scores(given, "aligned", similarity=True, name="S")
        report.save(tmp_path / "p.json", force=True)
        program = written(tmp_path / "c.json")
        own = written(tmp_path / "p.json")
        assert own.pop("name") == "S"
        if np.isfortran(given) if isinstance(given, np.ndarray) else False:
            own["provenance"]["scores"] = program["provenance"]["scores"]  # of another file
        assert own == program
    report = vpr.evaluate_scores(scores, "aligned", similarity=True, recall_at=[20, 5, 5])
    assert list(report.recall_at) == [1, 5, 20]
    by_default = vpr.evaluate_scores(scores.tolist(), "aligned", name="S", recall_at=[1, 5, 20])
    assert by_default.json.metrics == report.json.metrics
    indices = np.argsort(-scores, axis=1)[:, :20]
    listed = vpr.evaluate_scores(indices, "aligned", train_frames=200)
    assert listed.recall_at[1] == report.recall_at[1]
    with pytest.warns(UserWarning, match="with --similarity"):
        vpr.evaluate_scores(-scores, "aligned")


def test_ground_truths_may_be_arrays(walks):
    result = matched(walks)
    frames = np.arange(200)
    aligned = vpr.evaluate(result, "aligned").counts
    assert vpr.evaluate(result, np.column_stack([frames, frames])).counts == aligned
    assert vpr.evaluate(result, [(i, i) for i in frames]).counts == aligned
    assert vpr.evaluate(result, np.eye(200, dtype=bool)).counts == aligned
    positions = np.column_stack([1.5 * frames, np.zeros(200)])
    assert vpr.evaluate(result, positions, reference=positions.copy(), radius_m=1).counts == aligned
    with pytest.raises(vpr.DataError, match="reference.csv@0:199: its range has 199 frames, but the sequence has 200"):
        vpr.evaluate(result, positions, reference=positions[:-1], radius_m=1)
    with pytest.raises(vpr.UsageError, match="heading, which needs angle_deg"):
        vpr.evaluate(result, np.c_[positions, frames], reference=positions, radius_m=1)
    with pytest.raises(vpr.UsageError, match="recall_at must be from 1"):
        vpr.evaluate(result, "aligned", recall_at=[0])
    for lists in ([np.array([i // 2, i]) for i in frames], [[i // 2, i] for i in range(200)], {0: [1], 1: [2, 3]},
                  [[i] * (1 + i % 2) for i in range(200)], np.array([[0], [1, 2]], object)):
        with pytest.raises(vpr.UsageError, match="^ground_truth: lists of the matches of each query frame"):
            vpr.evaluate(result, lists)
    with pytest.raises(vpr.UsageError, match="^ground_truth: positions are n x 2 .* found 200 x 4"):
        vpr.evaluate(result, np.c_[positions, positions], reference=positions, radius_m=1)
    with pytest.raises(vpr.DataError, match="^ground_truth, pair 1: a frame is negative"):
        vpr.evaluate(result, np.c_[frames, -frames])
    pandas = pytest.importorskip("pandas")
    mixed = pandas.DataFrame({"frame": frames, "x": 1.5 * frames, "y": 0}).sample(frac=1, random_state=1)
    for table in (mixed, mixed.set_index("frame"), mixed.rename(columns={"frame": "Frame "}).assign(**{"Unnamed: 0": 0})):
        assert vpr.evaluate(result, table, reference=positions, radius_m=1).counts == aligned
    with pytest.raises(vpr.UsageError, match="not in the order of their index"):
        vpr.evaluate(result, mixed.drop(columns="frame"), reference=positions, radius_m=1)
    with pytest.raises(vpr.UsageError, match="no query or no reference"):
        vpr.evaluate(result, pandas.DataFrame({"query": [0, 1], "reference": [0, None]}))
    named = pandas.DataFrame({"Reference ": frames[:150], "QUERY": frames[:150] + 50})
    swapped = vpr.evaluate(result, named).counts
    assert swapped == vpr.evaluate(result, np.column_stack([frames[50:], frames[:150]])).counts
    with pytest.raises(vpr.Error):
        vpr.evaluate(result, named.rename(columns={"QUERY": "query_id"}))
    assert vpr.evaluate(result, np.column_stack([frames, frames]).astype(float)).counts == aligned
    table = pandas.DataFrame({"y": 1.5 * frames, "x": 0})
    assert vpr.evaluate(result, table, reference=table, radius_m=1).counts == aligned
    for empty in (np.empty((0, 2)), np.empty((0, 2), int)):
        assert vpr.evaluate(result, empty).counts.pairs.correct == 0
    unjudged = vpr.evaluate(result)
    assert unjudged.judged == "nothing"
    with pytest.raises(vpr.DataError, match="^ground_truth, pair 0: query 200 is out of range"):
        vpr.evaluate(result, [(200, 0)])
    with pytest.raises(vpr.DataError, match="^ground_truth.npy"):
        vpr.evaluate(result, np.eye(200) * 2)


def test_distances_are_those_of_the_descriptors(walks):
    db = vpr.train(descriptors=walks / "monday_bits.npy")
    query = np.load(walks / "tuesday_bits.npy")
    found = vpr.distances(db, query)
    expected = np.unpackbits(query[:, None] ^ db.descriptors[None, :, :query.shape[1]],
                             axis=2).sum(axis=2)
    assert found.shape == (200, 200) and len(found) == 200
    assert np.array_equal(np.asarray(found), expected)
    assert np.array_equal(found[-1], expected[-1])
    with pytest.raises(IndexError):
        found[200]
    vectors = np.load(walks / "monday.npy").astype(np.float32)
    vectors[3] = np.nan
    gap = np.asarray(vpr.distances(vpr.train(descriptors=vectors, metric="l2", skip_unreadable=True), vectors[5:9]))
    assert (gap[:, 3] == 65535).all() and (np.delete(gap, 3, axis=1) < 65535).all()


def test_live_frames_have_the_length_of_the_database(walks):
    live = vpr.Live(vpr.train(descriptors=walks / "monday.npy"))
    with pytest.raises(vpr.DataError, match="descriptors of the database have 64 numbers"):
        live.add(np.ones(5))
    with pytest.raises(vpr.DataError, match="^frame: values of type >f4 are not supported"):
        live.add(np.ones(64, ">f4"))
    with pytest.raises(vpr.DataError, match="frame: row 0 is missing"):
        live.add(np.full(64, np.nan))


def test_live_frames_are_matched_as_by_the_program(run, walks, tmp_path):
    db = vpr.train(walks / "monday")
    db.save(tmp_path / "db.vprdb")
    live = vpr.Live(db, c_l=5, score="zscore", decide="margin")
    images = sorted((walks / "tuesday").iterdir())
    (tmp_path / "list.txt").write_text("".join(f"{path}\n" for path in images))
    program = run("vpr-query", "live", tmp_path / "db.vprdb", "--query", tmp_path / "list.txt",
                  "--c-l", 5, "--score", "zscore", "--decide", "margin", folder=walks)
    lines = [json.loads(line) for line in program.stdout.splitlines()]
    assert [live.add(path) for path in images] == lines
    assert any(line["recognized"] for line in lines)
    live = vpr.Live(db, c_l=5, score="zscore", decide="margin")
    for path, line in zip(images, lines):
        pixels = np.frombuffer(path.read_bytes()[-64 * 96:], np.uint8).reshape(64, 96)
        sent = pickle.loads(pickle.dumps(pixels)) if path == images[0] else pixels  # its type is another object
        assert live.add(sent, name=path.name) == line
    assert live.add(None)["readable"] is False
    for other in (np.zeros((4, 4, 2), np.uint8), np.zeros((0, 4), np.uint8), np.zeros((4, 4), bool)):
        with pytest.raises(vpr.DataError, match="an image has"):
            live.add(other)
    with pytest.raises(vpr.UsageError, match="red first"):
        live.add(pytest.importorskip("PIL.Image").new("RGB", (96, 64)))
    assert live.finish() is None
    with pytest.raises(vpr.UsageError, match="is finished"):
        live.add(None)


def test_bits_have_loops_and_arrays_are_selected(walks):
    bits = np.load(walks / "monday_bits.npy")
    loops = vpr.loops(descriptors=np.concatenate([bits, bits]), loop_gap=100, c_l=5)
    assert loops.best[-1]["train"] == 195
    half = vpr.query(vpr.train(descriptors=bits), descriptors=bits.copy(), fps=2, recorded_fps=4)
    assert len(half.json.query) and half.json.query.frames == 100


def test_live_descriptors_are_matched_as_in_a_query(walks):
    db = vpr.train(descriptors=walks / "monday.npy")
    rows = np.load(walks / "tuesday.npy")
    settings = {"c_l": 5, "score": "zscore", "decide": "margin"}
    result = vpr.query(db, descriptors=rows, **settings)
    live = vpr.Live(db, **settings)
    lines = [live.add(row) for row in rows]
    assert [line["match"]["sum"] for line in lines[4:]] == result.best_scores.tolist()
    assert live.add(None)["readable"] is False


def test_names_may_have_bytes_that_are_not_text(walks):
    rows = np.load(walks / "monday.npy")
    db = vpr.train(descriptors={"a\udcff": rows})
    assert db.sequences == ["a%FF"]
    assert vpr.query(db, descriptors=rows, name="b\udc80").json.query.name == "b%80"
    assert vpr.Live(db).add(rows[0], name="c\udcff").name == "c%FF"
    with pytest.raises(vpr.UsageError, match="is not valid text"):
        vpr.query(db, descriptors=rows, name="\ud800")


@pytest.mark.parametrize("kind", [vpr.Database, vpr.Result, vpr.Distances])
def test_objects_are_made_by_functions_only(kind):
    for make in (kind, lambda: kind.__new__(kind)):
        with pytest.raises(TypeError, match=f"^{kind.__name__} objects are made by"):
            make()


def masked():
    return np.ma.masked_greater(np.eye(64), 0)


@pytest.mark.parametrize("call, kind", [
    (lambda db, walks: vpr.query(db, descriptors=walks / "tuesday.npy", c_L=5), "UsageError"),
    (lambda db, walks: vpr.query(db, descriptors=walks / "tuesday.npy", c_l="a"), "UsageError"),
    (lambda db, walks: vpr.query(db), "UsageError"),
    (lambda db, walks: vpr.train(), "UsageError"),
    (lambda db, walks: vpr.train([]), "UsageError"),
    (lambda db, walks: vpr.train(descriptors={}), "UsageError"),
    (lambda db, walks: vpr.train([np.zeros((64, 96), np.uint8)] * 3), "UsageError"),
    (lambda db, walks: vpr.train(walks / "monday", metric="l2"), "UsageError"),
    (lambda db, walks: vpr.train(descriptors=np.eye(64), descriptor="hog"), "UsageError"),
    (lambda db, walks: vpr.train(descriptors=np.eye(64, dtype=np.uint8), metric="cosine"), "UsageError"),
    (lambda db, walks: vpr.Live(db).add(""), "UsageError"),
    (lambda db, walks: vpr.evaluate(vpr.query(db, descriptors=walks / "tuesday.npy"), ""), "UsageError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(9), "aligned", train_frames=20), "UsageError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(9, dtype=int), "aligned", train_frames=0), "UsageError"),
    (lambda db, walks: vpr.query(db, "x", descriptors=np.eye(64)), "UsageError"),
    (lambda db, walks: vpr.query(db, descriptors=np.eye(64), c_l=5, t_r=np.nan), "UsageError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(9), None), "UsageError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(9), "aligned", recall_at=[0]), "UsageError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(9), "aligned", stretch=0), "UsageError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(9), "aligned", places="p.csv"), "UsageError"),
    (lambda db, walks: vpr.evaluate(vpr.query(db, descriptors=walks / "tuesday.npy"), tolerance=3), "UsageError"),
    (lambda db, walks: vpr.loops(descriptors=walks / "monday.npy", loop_gap=20, c_l=5, frame_times="x"), "UsageError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(9), "aligned", rows_are_windows_of=0), "UsageError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(9), "aligned", rows_are_windows_of=10), "UsageError"),
    (lambda db, walks: vpr.query(db, descriptors=np.eye(64), method="\udcff"), "UsageError"),
    (lambda db, walks: vpr.query(db, descriptors=walks / "tuesday.npy", c_l=5, t_r=1).save(
        walks / "tuesday.npy", force=True), "UsageError"),
    (lambda db, walks: vpr.load("missing\udcff"), "InputError"),
    (lambda db, walks: vpr.loops(descriptors=np.eye(64), loop_gap_s=9, c_l=5), "UsageError"),
    (lambda db, walks: db.save(""), "UsageError"),
    (lambda db, walks: vpr.query(db, descriptors=masked()), "DataError"),
    (lambda db, walks: vpr.evaluate_scores(masked(), "aligned"), "DataError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(64), masked()), "DataError"),
    (lambda db, walks: vpr.evaluate_scores(np.eye(64), zip([0], [0])), "DataError"),
    (lambda db, walks: vpr.query(db, descriptors=(row for row in np.eye(64))), "DataError"),
    (lambda db, walks: vpr.query(db, descriptors=walks / "tuesday.npy", frame_times="x"),
     "UsageError"),
    (lambda db, walks: vpr.train(walks / "monday", threads=2000), "UsageError"),
    (lambda db, walks: vpr.query(db, walks / "missing"), "InputError"),
    (lambda db, walks: vpr.query(db, walks / "tuesday"), "DataError"),
    (lambda db, walks: vpr.query(db, descriptors=np.zeros((3, 64))), "DataError"),
    (lambda db, walks: vpr.query(db, descriptors=np.ones((3, 64), ">f4")), "DataError"),
    (lambda db, walks: vpr.train(descriptors=np.ones(3)), "DataError"),
    (lambda db, walks: vpr.load(walks / "missing.vprdb"), "InputError"),
    (lambda db, walks: db.save(walks / "missing" / "x.vprdb"), "OutputError")])
def test_errors_have_the_kinds_of_the_programs(walks, call, kind):
    db = vpr.train(descriptors=walks / "monday.npy")
    with pytest.raises(vpr.Error) as error:
        call(db, walks)
    assert type(error.value) is getattr(vpr, kind) and str(error.value)


def test_calls_in_other_threads_end_with_the_interpreter(walks):
    code = ("import threading, numpy as np, vpr; a = np.load('monday.npy')\n"
            "db = vpr.train(descriptors=np.tile(a, (100, 1)))\n"
            "threading.Thread(target=vpr.query, args=(db,), daemon=True,\n"
            "                 kwargs=dict(descriptors=np.tile(a, (400, 1)))).start()\n"
            "import time; time.sleep(0.5)")
    subprocess.run([sys.executable, "-c", code], cwd=walks, check=True)


def test_errors_have_the_sentences_of_the_programs(run, walks, tmp_path):
    db = vpr.train(descriptors=walks / "monday.npy")
    db.save(tmp_path / "db.vprdb")
    program = run("vpr-query", tmp_path / "db.vprdb", "--query", walks / "tuesday.npy", "--c-l",
                  0, folder=walks, code=2)
    with pytest.raises(vpr.UsageError) as error:
        vpr.query(db, descriptors=walks / "tuesday.npy", c_l=0)
    assert program.stderr == f"vpr-query: {error.value}\n"
    with pytest.raises(vpr.UsageError, match="already"):
        db.save(tmp_path / "db.vprdb")


def test_arrays_are_not_copied(walks):
    bits = np.load(walks / "monday_bits.npy")
    db = vpr.train(descriptors=bits)
    assert np.shares_memory(db.descriptors, bits)
    assert not db.descriptors.flags.writeable
    with pytest.raises(ValueError):
        db.descriptors[0, 0] = 1
    view = db.descriptors
    del db
    assert np.array_equal(view, bits)


def test_progress_is_reported_and_may_stop_the_work(walks):
    bits = np.random.default_rng(1).integers(0, 256, (200000, 176), np.uint8)
    db = vpr.train(descriptors=bits[:3000])
    steps = []
    vpr.query(db, descriptors=bits[:20000], c_l=10, t_r=0.1,
              progress=lambda step, done, total: steps.append((step, done, total)))
    assert steps and all(done <= total for _, done, total in steps)

    def refuse(step, done, total):
        raise RuntimeError(step)
    with pytest.raises(RuntimeError):
        vpr.query(db, descriptors=bits, c_l=10, t_r=0.1, progress=refuse)


def test_arguments_of_other_types_are_errors(walks):
    db = vpr.train(descriptors=walks / "monday.npy")
    for call in (lambda: vpr.query(None, descriptors=walks / "tuesday.npy"), lambda: vpr.Live("db"),
                 lambda: vpr.distances(None, "x"), lambda: vpr.loops("x", db="db", loop_gap=9),
                 lambda: vpr.evaluate(db, "aligned")):
        with pytest.raises(TypeError, match="expected a vpr"):
            call()


def test_other_threads_run_and_interrupts_stop_the_work():
    bits = np.random.default_rng(1).integers(0, 256, (400000, 176), np.uint8)
    db = vpr.train(descriptors=bits[:3000])
    ticks = []

    def interrupt():
        for _ in range(5):
            time.sleep(0.02)
            ticks.append(1)
        os.kill(os.getpid(), signal.SIGINT)
    thread = threading.Thread(target=interrupt)
    thread.start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        vpr.query(db, descriptors=bits, c_l=10, t_r=0.1)
    thread.join()
    assert len(ticks) == 5
    assert time.monotonic() - started < 60


def test_warnings_are_those_of_the_programs(walks):
    db = vpr.train(descriptors=walks / "monday.npy")
    with pytest.warns(UserWarning, match="the same frames as the training sequence"):
        vpr.query(db, descriptors=walks / "monday.npy")


def test_reports_have_a_table_of_frames(run, walks, tmp_path):
    result = matched(walks)
    report = vpr.evaluate(result, "aligned", tolerance=3)
    frames = report.frames()
    assert len(frames) == 200 and frames["frame"].tolist() == list(range(200))
    assert (frames["outcome"] == "correct").sum() == report.best_match.correct
    assert frames[0]["train_frame"] == -1 and np.isnan(frames[0]["score"])
    assert frames[7]["sequence"] == "monday" and frames[7]["train_frame"] == 7
    result.save(tmp_path / "r.json")
    run("vpr-eval", tmp_path / "r.json", "--ground-truth", "aligned", "--tolerance", 3,
        "--outcomes-csv", tmp_path / "o.csv", folder=walks)
    pandas = pytest.importorskip("pandas")
    table, program = pandas.DataFrame(frames), pandas.read_csv(tmp_path / "o.csv")
    for column in ("train_frame", "rank"):
        assert table[column].tolist() == program[column].fillna(-1).tolist()
    assert table["outcome"].tolist() == program["outcome"].tolist()


@pytest.mark.parametrize("saved", [False, True])
def test_results_and_reports_are_pickled(walks, tmp_path, saved):
    result = matched(walks)
    if saved:
        result.save(tmp_path / "r.json")
        result = vpr.load(tmp_path / "r.json")
    copy = pickle.loads(pickle.dumps(result))
    for name in ("recognitions", "best", "best_scores"):
        assert np.array_equal(getattr(copy, name), getattr(result, name))
    assert copy.json.settings == result.json.settings and repr(copy) == repr(result)
    report = vpr.evaluate(result, "aligned", tolerance=3)
    assert vpr.evaluate(copy, "aligned", tolerance=3).json.metrics == report.json.metrics
    if not saved:
        copy.save(tmp_path / "copy.json")
    other = pickle.loads(pickle.dumps(report))
    assert other == report and other.summary == report.summary
    assert np.array_equal(other.curve, report.curve) and np.array_equal(
        other.frames()["outcome"], report.frames()["outcome"])
    assert report.summary in html.unescape(other._repr_html_())
    report.save(tmp_path / "one.json")
    other.save(tmp_path / "other.json")
    assert written(tmp_path / "one.json") == written(tmp_path / "other.json")
    with pytest.raises(vpr.UsageError, match="has no images"):
        other.html(tmp_path / "page.html")


def test_databases_and_results_show_themselves(walks):
    db = vpr.train([walks / "monday", walks / "other"])
    assert repr(db) == "<vpr.Database: 120 frames of monday, other, ldb+hog>"
    assert "monday" in db._repr_html_() and db._repr_html_().startswith("<pre>")
    result = vpr.query(db, walks / "tuesday")
    assert "of 60 frames of tuesday recognized" in repr(result)
    assert "= monday" in result._repr_html_()
    places = vpr.train(walks / "monday", pretrain=walks / "other", features="orb", words=50)
    assert repr(places).startswith("<vpr.Database: FAB-MAP, places ")


def test_reports_are_compared_as_by_the_program(run, walks, tmp_path):
    reports = {}
    for name, by in {"a": {}, "b": {"c_l": 5, "t_r": 0.5}}.items():
        db = vpr.train(descriptors=walks / "monday.npy", c_l=5)
        reports[name] = vpr.evaluate(vpr.query(db, descriptors=walks / "tuesday.npy", **by), "aligned")
        reports[name].save(tmp_path / f"{name}.json")
    found = vpr.compare(reports)
    found.save(tmp_path / "p.json")
    found.html(tmp_path / "p.html")
    table = run("vpr-eval", "compare", "a.json", "b.json", "-o", "c.json", "--name", "a", "--name", "b",
                folder=tmp_path).stdout
    assert str(found).strip() == table.strip()
    program, own = written(tmp_path / "c.json"), written(tmp_path / "p.json")
    assert own == program
    assert "tabular" in found.latex and "<html" in (tmp_path / "p.html").read_text()
    paths = vpr.compare([tmp_path / "a.json", pickle.loads(pickle.dumps(reports["b"]))])
    assert [one.difference for one in paths.metrics] == [one.difference for one in found.metrics]
    with pytest.raises(vpr.UsageError, match="two or more"):
        vpr.compare([reports["a"]])
    with pytest.raises(vpr.DataError, match="different ground truths"):
        other = vpr.evaluate(matched(walks), "aligned", tolerance=9)
        vpr.compare([reports["a"], other])
    (tmp_path / "bytes.json").write_bytes(b"\xff")
    (tmp_path / "list.json").write_text("[]")
    for path, error in {"none.json": vpr.InputError, ".": vpr.InputError, "bytes.json": vpr.DataError,
                        "list.json": vpr.DataError}.items():
        with pytest.raises(error):
            vpr.compare({"a": reports["a"], "b": tmp_path / path})


def test_a_masked_array_without_masked_values_is_a_ground_truth(walks):
    result = matched(walks)
    truth = np.eye(len(np.load(walks / "tuesday.npy")), len(np.load(walks / "monday.npy")), dtype=bool)
    assert vpr.evaluate(result, np.ma.masked_array(truth)).frames()["outcome"].tolist() == vpr.evaluate(
        result, truth).frames()["outcome"].tolist()
