"""Data sets of a tree of experiments, and the dependencies of jobs on their parts.

A replaced frame must rebuild its results, but it does not change the date of its folder, and a
single file for a whole data set would rebuild too much. Therefore each part of a data set (training,
one query, its ground truth) has a stamp: a file with the part's description and the size and date of
all its files. A stamp is rewritten only if its content changes.
"""
import json
import os
import pathlib
import re

LISTS = (".txt", ".lst", ".csv")
TRAINING = ("pretrain", "train", "places")
LABELS = ("schema", "name", "format")  # keys whose strings are not paths


class Mistake(Exception):
    """An error for the user to fix, in one sentence."""


def write_if_new(path, content):
    """Writes a file unless it has this content already, so that its date is the time of its last change."""
    path = pathlib.Path(path)
    if path.exists() and path.read_text() == content:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    partial.write_text(content)
    partial.replace(path)


def read_json(path):
    try:
        return json.loads(pathlib.Path(path).read_text())
    except (OSError, ValueError) as error:
        raise Mistake(f"{path} cannot be read: {error}") from error


def strings(value):
    """All strings in a JSON value that may be paths."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from () if key in LABELS else strings(item)
    elif isinstance(value, list):
        for item in value:
            yield from strings(item)


def with_strings(value, change):
    """A JSON value with every string that may be a path replaced."""
    if isinstance(value, str):
        return change(value)
    if isinstance(value, dict):
        return {key: item if key in LABELS else with_strings(item, change)
                for key, item in value.items()}
    return [with_strings(item, change) for item in value] if isinstance(value, list) else value


def existing(text, folder):
    """The file or folder that a string names, with or without a range @FIRST:LAST; or None."""
    for name in (text, re.sub(r"@[\d:-]*$", "", text)):
        path = pathlib.Path(folder, name)
        if name and path.exists():
            return path
    return None


def behind(path, follow_lists):
    """The files of a sequence or ground truth."""
    if path.is_dir():
        with os.scandir(path) as entries:
            return sorted(pathlib.Path(entry.path) for entry in entries
                          if entry.is_file() and not entry.name.startswith("."))
    if not follow_lists or path.suffix.lower() not in LISTS:
        return [path]
    listed = (path.parent / line.strip() for line in path.read_text("utf-8-sig").splitlines()
              if line.strip() and not line.startswith("#"))
    return [path, *(file for file in listed if file.is_file())]


def stamp(path, part, folder, follow_lists=True):
    """Writes the stamp of a part, whose strings may be paths relative to a folder."""
    files = {}
    for text in strings(part):
        found = existing(text, folder)
        for file in behind(found, follow_lists) if found else []:
            facts = file.stat()
            files[str(file)] = [facts.st_size, facts.st_mtime_ns]
    lines = [f"{json.dumps(name)}: {facts}" for name, facts in files.items()]
    write_if_new(path, "\n".join([json.dumps(part), *lines, ""]))
    return str(path)


class Rendered:
    """A data set rendered by vpr-synth: everything depends on the world."""

    def __init__(self, name, world, out):
        self.world = str(world)
        self.folder = f"{out}/data/{name}"
        self.description = f"{self.folder}/dataset.json"
        content = read_json(world)
        self.title = content.get("name", name)
        self.queries = [walk["name"] for walk in content.get("walks", [])
                        if walk.get("use") == "query"]

    def training(self):
        return [self.folder]

    def query(self, _name):
        return [self.folder]

    truth = query


class Described:
    """A data set with a description: a file of the user, or one written here from the tree's file."""

    def __init__(self, name, description, folder, out):
        self.description, self.folder = description, folder
        self.stamps = pathlib.Path(out, "inputs", name)
        self.content = read_json(description)
        self.title = self.content.get("name", name)
        self.by_name = {query.get("name"): query for query in self.content.get("queries", [])}
        self.queries = [name for name, query in self.by_name.items()
                        if "ground_truth" in query or "place_ground_truth" in query]
        if None in self.by_name or not self.queries:
            raise Mistake(f"{description} has no query with a name and a ground truth")

    def training(self):
        part = {key: self.content.get(key) for key in TRAINING}
        return [stamp(self.stamps / "train", part, self.folder)]

    def query(self, name):
        part = {key: self.by_name[name].get(key) for key in ("name", "sequence")}
        return [stamp(self.stamps / f"query-{identifier(name)}", part, self.folder)]

    def truth(self, name):
        part = {key: value for key, value in self.content.items()
                if key not in (*TRAINING, "queries")}
        part["query"] = {key: value for key, value in self.by_name[name].items()
                         if key != "sequence"}
        return [stamp(self.stamps / f"truth-{identifier(name)}", part, self.folder, False)]


def identifier(name):
    """A name as part of a path."""
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", name)


def written_description(name, content, folder, out):
    """Writes the description in the tree's file to a file of its own; existing paths become absolute."""
    def absolute(text):
        found = existing(text, folder)
        return text if found is None else os.path.abspath(os.path.join(folder, text))

    named = {"schema": "vpr.dataset/3", "name": name, **with_strings(content, absolute)}
    path = pathlib.Path(out, "inputs", name, "dataset.json")
    write_if_new(path, json.dumps(named, indent=1) + "\n")
    return str(path)


def open_data_set(name, row, folder, data, out):
    """The data set of a row of experiments.yaml, or None if it needs a folder that was not
    passed."""
    if data is None and any("{data}" in text for text in strings(row)):
        return None
    row = with_strings(row, lambda text: text.replace("{data}", str(data)))
    if "world" in row:
        return Rendered(name, folder / row["world"], out)
    if isinstance(row["dataset"], str):
        path = folder / row["dataset"]
        return Described(name, str(path), path.parent, out)
    path = written_description(name, row["dataset"], folder, out)
    return Described(name, path, pathlib.Path(path).parent, out)
