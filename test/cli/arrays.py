#!/usr/bin/env python3
"""Arrays of descriptors have the ranks of their definition, with a database and without.   arrays.py SOURCE BIN"""
import json

import numpy as np

from support import call, folder, ok, run

random = np.random.default_rng(1)
INDEX = np.arange(30)


def save(train, query):
    np.save(folder / "db.npy", train)
    np.save(folder / "q.npy", np.asfortranarray(query))


def printed_json(*words):
    return json.loads(run(*words, "--json"))


def recall_at(*words):
    return printed_json("vpr-eval", "matrix", "--query", "q.npy", "--train", "db.npy", "--ground-truth", "aligned",
                        "--tolerance", 0, *words)["metrics"]["recall_at"]


def trained(metric):
    """The database of the array; its messages and content."""
    done = ok(call("vpr-train", "descriptors", "--train", "db.npy", "--metric", metric, "--c-l", 3, "-o", "db.vprdb", "--force"))
    return done.stderr, printed_json("vpr-train", "info", "db.vprdb")["descriptor"]


def best_matches(c_l):
    """The best matches of the database's distances."""
    run("vpr-query", "db.vprdb", "--query", "q.npy", "--c-l", c_l, "--t-r", 0.2, "-o", "r.json", "--force")
    return printed_json("vpr-eval", "r.json", "--ground-truth", "aligned", "--tolerance", 0)["best_match"]


def without_database():
    """Recall up to 100 equals the definition in float64."""
    train, noise = random.integers(-1000, 1001, (2, 150, 48)).astype(np.float32)
    query = np.float32(0.2) * train + noise
    save(train, query)
    train, query = train.astype(float), query.astype(float)
    similarity = query @ (train / np.linalg.norm(train, axis=1, keepdims=True)).T
    ranks = 1 + (similarity > similarity.diagonal()[:, None]).sum(1)
    found = recall_at("--recall-at", "5,10,100", "--html", "page.html")
    assert found.keys() == {"1", "5", "10", "100"} and found["1"] < found["100"], found
    assert all(abs(found[k] - (ranks <= int(k)).mean()) < 1e-12 for k in found), (found, ranks)
    assert (folder / "page.html").stat().st_size > 10_000


def chords():
    """Chords distinguish frames that are closer than the unit of cosine distances: a thousandth of a radian
    between frames, whose 1 - cos is a sixtieth of a unit."""
    angle = 0.001 * (INDEX * 7 % 30)[:, None]
    train = np.where(np.arange(12) % 2 == 0, np.cos(angle), np.sin(angle))
    save(train, train * (INDEX + 1)[:, None])  # lengths have no effect
    for metric in ("chord", "cosine"):
        messages, descriptor = trained(metric)
        assert ("Use --metric chord" in messages) == (metric == "cosine"), messages
        assert descriptor == ("directions" if metric == "chord" else "vectors"), descriptor
        rate = best_matches(1)["rate"]
        assert rate == 1 if metric == "chord" else rate < 0.5, (metric, rate)
        assert recall_at("--metric", metric)["1"] == 1  # in float64


def lengths():
    """Vectors of equal directions, whose places differ only in length, have Euclidean distances."""
    train = (1 + 0.1 * (INDEX * 7 % 30))[:, None] * np.cos(np.arange(12))
    query = train + 0.001 * (random.random(train.shape) - 0.5)
    save(train, query)
    assert trained("l2")[1] == "points"
    assert best_matches(3)["correct"] == 28
    assert recall_at("--metric", "l2")["1"] == 1 > recall_at("--metric", "cosine")["1"]
    # Exported vectors equal the imported ones up to half a unit.
    run("vpr-train", "export", "db.vprdb", "--descriptors", "x.npy")
    assert abs(np.load(folder / "x.npy") - train).max() < np.linalg.norm(train, axis=1).max() / 32000
    # Added vectors use the same unit, and much longer ones are refused.
    run("vpr-train", "add", "db.vprdb", "--train", "q.npy", "-o", "more.vprdb")
    np.save(folder / "far.npy", 3 * query)
    far = call("vpr-query", "db.vprdb", "--query", "far.npy", "--c-l", 3, "--t-r", 0.2)
    assert far.returncode == 4 and "more than twice as long" in far.stderr, far


without_database()
chords()
lengths()
