"""Visual place recognition on NumPy arrays, images and video.

Each function has the defaults of a program and gives the bytes of its files: train those of
vpr-train, query those of vpr-query, evaluate those of vpr-eval. Settings are keyword arguments with
the names of JSON keys (--c-l 20 is c_l=20); None is the default. All functions also take threads
(0: all cores), seed, order and max_megapixels, except load.

Work releases the interpreter's lock, stops on KeyboardInterrupt, and calls progress(step, done,
total) up to 20 times per second. Warnings are UserWarning. Errors have the sentences of the
programs and a class by kind: UsageError, InputError, OutputError, DataError and InternalError are
subclasses of Error.
"""

# mypy: no-warn-return-any
from __future__ import annotations

import html as _html
import importlib as _importlib
import json as _json
import os
import re
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, Optional, Union

for _name in ("_interpreters", "_xxsubinterpreters"):  # of Python 3.13, and before
    try:
        _interpreters = _importlib.import_module(_name)
    except ImportError:
        continue
    if _interpreters.get_current() != _interpreters.get_main():  # its state belongs to the process
        raise ImportError("vpr does not run in a sub-interpreter. Use a process")
    break

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _vpr
from ._vpr import Database, Distances, Result, __version__

__all__ = ["Comparison", "Database", "DataError", "Distances", "Error", "Fields", "InputError", "InternalError",
           "Live", "OutputError", "Report", "Result", "UsageError", "compare", "distances",
           "evaluate", "evaluate_scores", "load", "loops", "query", "train"]

Path = Union[str, "os.PathLike[str]"]
Source = Union[None, Path, ArrayLike]
Progress = Optional[Callable[[str, int, int], object]]


class Error(Exception):
    """Base class of the errors."""


class UsageError(Error):
    """Wrong settings, or an output that exists already (exit code 2)."""


class InputError(Error):
    """A file is missing or cannot be decoded (exit code 3)."""


class OutputError(Error):
    """A file cannot be written (exit code 3)."""


class DataError(Error):
    """Data are damaged or do not match (exit code 4)."""


class InternalError(Error):
    """A defect of the toolkit (exit code 1)."""


class Fields(dict[Any, Any]):
    """A JSON object whose keys are also attributes. Keys that are numbers are int or float."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        def number_or_name(key: str) -> Any:
            if key.isdigit():
                return int(key)
            return float(key) if key.replace(".", "", 1).isdigit() else key
        super().__init__((number_or_name(key), values[key]) for key in values)

    def __getattr__(self, name: str) -> Any:
        if name not in self:
            raise AttributeError(name)
        return self[name]


def _read(text: str) -> Any:
    return _json.loads(text, object_hook=Fields)


def _call(function: str, settings: Mapping[str, object], progress: Progress = None) -> Any:
    def plain(value: Any) -> object:
        if isinstance(value, (np.generic, np.ndarray)):
            return value.tolist()
        if isinstance(value, Iterable):
            return list(value)
        if isinstance(value, os.PathLike):
            return os.fspath(value)
        raise UsageError(f"vpr.{function}: a setting has the type {type(value).__name__}")
    given = {key: value for key, value in settings.items() if value is not None}
    for key in given:
        if isinstance(given[key], str) and not given[key]:
            raise UsageError(f"vpr.{function}: {key} is empty. Omit it")
    try:
        return _vpr.Call("vpr." + function, _json.dumps(given, default=plain, allow_nan=False),
                         progress)
    except ValueError:
        raise UsageError(f"vpr.{function}: a setting is not a finite number") from None


def _text(name: str) -> str:
    """Bytes of a file name that are not UTF-8 as %XX, as the programs name sequences."""
    name = re.sub("[\udc80-\udcff]", lambda byte: f"%{ord(byte[0]) - 0xdc00:02X}", name)
    if any("\ud800" <= letter <= "\udfff" for letter in name):
        raise UsageError(f"the name {name!r} is not valid text")
    return name


def _opened(value: Any, kind: type) -> Any:
    if not isinstance(value, kind):
        raise TypeError(f"expected a vpr.{kind.__name__}, as from vpr.load, found {value!r:.60}")
    return value


def _sources(value: Any) -> list[tuple[str, Any]]:
    """The names, as far as there are any, and sources of one sequence, a list or a mapping."""
    if isinstance(value, Mapping):
        return [(_text(str(name)), item) for name, item in value.items()] or [("", None)]
    many = value if isinstance(value, (list, tuple)) else [value]
    return [("", item) for item in many] or [("", None)]


def _frames(images: Any, descriptors: Any, has_many: bool = False) -> Any:
    """The only one of the two, in which images are paths."""
    if images is not None and descriptors is not None:
        raise UsageError("there are images and descriptors. Pass one of them")
    listed = [image for _, image in _sources(images)] if has_many else [images]
    for image in listed:
        if np.asarray(image).dtype.kind in "UO" and np.ndim(image) > 0 or isinstance(image, Iterator):
            raise UsageError("images are a folder, a video, or a list file with one path per "
                             "line. Write the paths to a file: walk.txt")
        if np.ndim(image) > 0:
            raise UsageError("images are paths. Pass arrays as descriptors")
    return images if descriptors is None else descriptors


class Report(Fields):
    """An evaluation. Attributes are the keys of the report file (docs/reference/files.md) and of
    its "metrics": report.counts.pairs.correct, report.recall_at[1], report.localization.share.
    counts.recognitions is another name of counts.pairs. curve has the columns threshold, correct
    and incorrect: best matches accepted at each threshold, the strictest first; recall is
    correct / report.single_best.positives. A pickled report has all of these, but no page."""

    def __init__(self, made: Any) -> None:
        self._made = made
        self.json = _read(made.text())
        self.summary: str = made.summary()
        self.curve: NDArray[np.float64] = made.curve()
        super().__init__({**self.json, **self.json.get("metrics", {})})
        if "counts" in self:
            self["counts"] = Fields({**self.counts, "recognitions": self.counts.pairs})

    def save(self, path: Path, force: bool = False) -> None:
        """Writes the report file of vpr-eval."""
        self._made.save(path, False, force)

    def html(self, path: Path, force: bool = False) -> None:
        """Writes the page of vpr-eval --html."""
        self._made.save(path, True, force)

    def frames(self) -> NDArray[Any]:
        """A row per query frame, as in vpr-eval --outcomes-csv: its best match (sequence and
        train_frame, or place), score, outcome, has_match, recognition, rank and margin. Unknown
        values are -1, NaN or empty. pandas.DataFrame(report.frames()) is a table.

        >>> db = vpr.train(descriptors=monday)
        >>> report = vpr.evaluate(vpr.query(db, descriptors=tuesday), "aligned")
        >>> report.frames()[["frame", "train_frame", "outcome"]][7].item()
        (7, 7, 'correct')
        """
        columns = {name: np.array(values, str) if isinstance(values, list) else values
                   for name, values in self._made.frames().items()}
        table = np.empty(len(columns["frame"]),
                         [(name, column.dtype) for name, column in columns.items()])
        for name, column in columns.items():
            table[name] = column
        return table

    def __reduce__(self) -> Any:
        made = self._made
        return Report, (_Unpickled(made.text(), made.summary(), made.curve(), made.frames()),)

    def __repr__(self) -> str:
        return f"<vpr.Report: {self.summary}>"

    def _repr_html_(self) -> str:
        if isinstance(self._made, _Unpickled):
            return f"<p>{_html.escape(self.summary)}</p>"
        return _framed(self._made.page(True))


def _framed(page: str) -> str:
    return (f'<iframe srcdoc="{_html.escape(page)}" '
            'style="width:100%;height:900px;border:0"></iframe>')


class _Unpickled:
    """The values of an evaluation in another process, which has no images."""

    def __init__(self, *values: Any) -> None:
        self.values = values

    def text(self) -> Any:
        return self.values[0]

    def summary(self) -> Any:
        return self.values[1]

    def curve(self) -> Any:
        return self.values[2]

    def frames(self) -> Any:
        return self.values[3]

    def save(self, path: Path, is_page: bool, force: bool) -> None:
        if is_page:
            raise UsageError("an unpickled report has no images. Evaluate the result again")
        _vpr.save_text(self.text(), path, force)


def _pickled(result: Result) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        was_read = _vpr.write_result(result, folder + "/r.json")
        files = {}
        for name in os.listdir(folder):
            with open(os.path.join(folder, name), "rb") as file:
                files[name] = file.read()
    return _unpickled, (files, was_read)


def _unpickled(files: Mapping[str, bytes], was_read: bool) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files.items():
            with open(os.path.join(folder, name), "wb") as file:
                file.write(content)
        return _vpr.read_result(_call("load", {}), folder + "/r.json", was_read)


class Comparison(Fields):
    """Reports side by side. Attributes are the keys of the file of vpr-eval compare; str() is its
    table, and latex a table of LaTeX."""

    def __init__(self, made: Any) -> None:
        self._made = made
        self.latex: str = made.latex()
        super().__init__(_read(made.text()))

    def save(self, path: Path, force: bool = False) -> None:
        """Writes the file of vpr-eval compare."""
        _vpr.save_text(self._made.text(), path, force)

    def html(self, path: Path, force: bool = False) -> None:
        """Writes the page of vpr-eval compare --html."""
        _vpr.save_text(self._made.page(), path, force)

    def __str__(self) -> str:
        return str(self._made.table())

    def __repr__(self) -> str:
        reports = sum(len(one.comparison.reports) for one in getattr(self, "comparisons", []))
        return f"<vpr.Comparison of {reports or len(self.reports)} reports>"

    def _repr_html_(self) -> str:
        return _framed(self._made.page())


class Live:
    """A query whose frames arrive one by one, as in vpr-query live. Settings: those of query,
    without a selection of frames (fps, speed).

    >>> live = vpr.Live(vpr.train(descriptors=monday), c_l=5, score="zscore", decide="margin")
    >>> lines = [live.add(row) for row in tuesday]
    >>> lines[4].recognized[0].frame
    4
    """

    def __init__(self, db: Database, **settings: object) -> None:
        self._live = _vpr.Live(_call("Live", settings), _opened(db, Database))

    def add(self, frame: Source, name: str = "") -> Fields:
        """Matches the next frame: an image file; an image (uint8), height x width gray levels or
        height x width x 3 in the order blue, green, red; for a database of descriptors, d values;
        or None if it is missing. Returns the line of vpr-query live; its decisions are in
        recognized."""
        if hasattr(frame, "getbands"):
            raise UsageError("a PIL image has red first. Pass "
                             "numpy.asarray(image.convert('RGB'))[:, :, ::-1]")
        return self._live.add(frame, _text(name))

    def finish(self) -> Optional[Fields]:
        """The decisions of the filter that the end of the query settles; None without any."""
        return self._live.finish()


def train(images: Any = None, *, descriptors: Any = None, pretrain: Any = None,
          progress: Progress = None, **settings: object) -> Database:
    """Builds a database of training sequences.

    images: a folder, list or video as on the command line ("monday@10:80"), a list of them, or a
        mapping from names. descriptors: likewise .npy files or arrays, n x d values (float16,
        float32 or float64) or bits (uint8 with 8 per value, or bool). A C-contiguous uint8 array
        with a multiple of 8 columns is used in place: do not change it later.
    Settings: those of vpr-train images and descriptors, such as descriptor, c_l, fps, metric and
        value_bits. With pretrain (frames of other places), those of vpr-train fabmap.

    >>> db = vpr.train(descriptors=monday)
    >>> db.sequences, db.descriptors.dtype, db.descriptors.shape
    (['train'], dtype('int16'), (200, 64))
    """
    return _vpr.train(_call("train", settings, progress),
                      _sources(_frames(images, descriptors, True)),
                      [] if pretrain is None else _sources(pretrain))


def load(path: Path) -> Any:
    """Opens a folder of vpr-train as a Database, or a result file (.json) as a Result."""
    is_result = os.path.isfile(path) or os.fsdecode(path).endswith(".json")
    load = _vpr.load_result if is_result else _vpr.load_database
    return load(_call("load", {}), path)


def query(db: Database, images: Optional[Path] = None, *, descriptors: Source = None,
          name: str = "", progress: Progress = None, **settings: object) -> Result:
    """Recognizes the places of a query sequence, by default at any walking speed.

    images: a folder, list or video. descriptors: an array or a .npy file. name: in results; by
        default of the path, or "query".
    Settings: those of vpr-query, such as c_l, score, decide, margin, t_r, method, fps, speed and
        max_memory (bytes). For FAB-MAP: t_p, c_w, ...

    >>> db = vpr.train(descriptors=monday)
    >>> result = vpr.query(db, descriptors=tuesday, c_l=5, score="zscore", decide="margin")
    >>> result.best[7].item(), len(result.recognitions)
    ((7, 0, 7), 196)
    """
    return _vpr.query(_call("query", settings, progress), _opened(db, Database), _text(name),
                      _frames(images, descriptors), False)


def loops(images: Optional[Path] = None, *, descriptors: Source = None,
          db: Optional[Database] = None, name: str = "", progress: Progress = None,
          **settings: object) -> Result:
    """Recognizes the places of a sequence in its own past, as vpr-query loops.

    db: FAB-MAP's, for its words and places; without it, windows are compared.
    Settings: loop_gap (least distance of a match, in frames) or loop_gap_s (seconds, with
        frame_times), descriptor, and those of query.

    >>> laps = np.concatenate([monday, tuesday])
    >>> result = vpr.loops(descriptors=laps, loop_gap=100, c_l=5, score="zscore", t_r=-2)
    >>> result.recognitions[-1].item()
    (395, 0, 195)
    """
    opened = None if db is None else _opened(db, Database)
    return _vpr.query(_call("loops", settings, progress), opened, _text(name),
                      _frames(images, descriptors), True)


def _table(value: Any, name: str) -> Any:
    """A DataFrame with the names of its columns in lower case, and its index among them."""
    if any(label is not None for label in value.index.names):
        value = value.reset_index()
    table = value.rename(columns=lambda column: str(column).strip().lower())
    table = table.drop(columns="unnamed: 0", errors="ignore")  # an index that was saved
    if {"query", "reference"}.issubset(table) and table[["query", "reference"]].isna().any(axis=None):
        raise UsageError(f"{name}: a row has no query or no reference. Omit frames without a match")
    return table


def _refuse_lists(value: Any, frames: int) -> None:
    """Refuses the lists of matches of each query frame, whose rows look like pairs."""
    is_mapping = isinstance(value, Mapping)
    is_object = isinstance(value, np.ndarray) and value.dtype == object and value.ndim > 0
    items = list(value.values() if is_mapping else value) if is_mapping or is_object or isinstance(
        value, (list, tuple)) else []
    rows: list[Any] = [item for item in items if isinstance(item, (list, tuple, set)) or
            isinstance(item, np.ndarray) and item.ndim == 1 and item.dtype.kind in "iu"]
    lengths = {len(row) for row in rows}
    are_lists = is_mapping or is_object or len(lengths) > 1
    if lengths == {2}:
        are_lists |= isinstance(rows[0], np.ndarray) or isinstance(rows[0], list) and (
            len(rows) == frames > len({row[0] for row in rows}))
    if rows and are_lists:
        raise UsageError("ground_truth: lists of the matches of each query frame need another form. Pass pairs: "
                         "[(query, match) for query, found in enumerate(LISTS) for match in found]")


def _save_table(table: Any, name: str, folder: str) -> str:
    """The argument for the CSV file of a DataFrame of _table(); rows without names or times are frames."""
    has_frames = {"query", "frame", "image", "time"}.intersection(table)
    are_frames = not has_frames and bool({"x", "lat", "latitude"}.intersection(table))
    if are_frames and not table.index.is_monotonic_increasing:
        raise UsageError(f"{name}: its rows are not in the order of their index. Sort them, or use "
                         "reset_index(drop=True) if their order is right")
    if are_frames:
        table = table.assign(frame=range(len(table)))
    path = f"{folder}/{name}.csv"
    table.to_csv(path, index=False)
    return f"{path}@0:{len(table)}" if are_frames else path


def _save_positions(value: Any, name: str, folder: str, has_headings: bool) -> str:
    """The argument for the CSV file of the positions of all frames."""
    array = np.asarray(_vpr.array_of(value, name))
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise UsageError(f"{name}: positions are n x 2 (x and y) or n x 3 (with the heading), found "
                         f"{' x '.join(map(str, array.shape))}. Pass others as a DataFrame with the "
                         "columns of a CSV file, such as x, y, z or time, x, y, z, qx, qy, qz, qw")
    if array.shape[1] == 3 and not has_headings:
        raise UsageError(f"{name}: the third column is the heading, which needs "
                         "angle_deg. Pass heights as a DataFrame with columns x, y, z")
    path = f"{folder}/{name}.csv"
    np.savetxt(path, np.column_stack([np.arange(len(array)), array]), "%.17g", ",", comments="",
               header=",".join(["frame", "x", "y", "heading"][:1 + array.shape[1]]))
    return f"{path}@0:{len(array)}"


def _pairs_or_saved_labels(value: Any, frames: int, folder: str, may_be_pairs: bool) -> Source:
    """Pairs as integers, or the path of a matrix of labels."""
    _refuse_lists(value, frames)
    array = np.asarray(_vpr.array_of(value, "ground_truth"))
    is_whole = array.dtype.kind in "iu" or array.dtype.kind == "f" and (
        (array == array.round()).all() and
        array.max(initial=2 if array.size == 0 else 0) > 1)  # or labels of two training frames
    if array.shape[1:] == (2,) and is_whole and may_be_pairs:
        return array.astype(np.int64)
    path = f"{folder}/ground_truth.npy"
    np.save(path, array)
    return path


def _evaluate(function: str, result: Optional[Result], scores: Source, truth: Source,
              settings: dict[str, Any], progress: Progress) -> Report:
    """Tables and arrays other than pairs become files, so that the readers of ground truths check them."""
    if isinstance(truth, str) and not truth:
        raise UsageError(f"vpr.{function}: ground_truth is empty. Omit it")
    reference = settings.get("reference")
    frames = (getattr(scores, "shape", ()) or (0,))[0] if result is None else result.json.query.frames
    with tempfile.TemporaryDirectory() as folder:
        def argument(value: Any, name: str) -> Source:
            if value is None or isinstance(value, (str, os.PathLike)):
                return value
            if any(isinstance(column, str) for column in getattr(value, "columns", ())):
                return _save_table(_table(value, name), name, folder)
            if reference is not None:
                return _save_positions(value, name, folder, settings.get("angle_deg") is not None)
            return _pairs_or_saved_labels(value, frames, folder, settings.get("format") in (None, "pairs"))

        call = _call(function, {**settings, "reference": argument(reference, "reference")}, progress)
        call.folder = folder + "/"
        return Report(_vpr.evaluate(call, result, scores, argument(truth, "ground_truth")))


def evaluate(result: Result, ground_truth: Source = None, *, progress: Progress = None,
             **settings: object) -> Report:
    """Judges a result by a ground truth; without one, it counts what was recognized.

    ground_truth: a file or folder of any format, "aligned", or an array: pairs (n x 2 integers,
        numbers of a query and a training frame); a matrix of labels (query x training frames,
        bool or uint8); or positions of all frames in meters (x, y and, with angle_deg, the heading
        in degrees) with reference (those of the training frames) and radius_m. Columns of a
        DataFrame, and its index if that has a name, are those of a CSV file. For a result of
        loops, pairs within the gap are ignored.
    Settings: tolerance, format, reference, radius_m, ... as in data set descriptions; confidence,
        recall_at, stretch, poses, places and name as in vpr-eval.

    >>> db = vpr.train(descriptors=monday)
    >>> result = vpr.query(db, descriptors=tuesday, c_l=5, t_r=0.5)
    >>> report = vpr.evaluate(result, "aligned", tolerance=3)
    >>> report.counts.recognitions.correct, report.recall_at[1]
    (196, 0.98)
    """
    return _evaluate("evaluate", _opened(result, Result), None, ground_truth, settings, progress)


def evaluate_scores(scores: Source, ground_truth: Source, *, progress: Progress = None,
                    **settings: object) -> Report:
    """Judges scores of any program, query x training frames, as vpr-eval matrix.

    scores: an array or a .npy file of any number type; NaN is not a score. By default, large scores
        are good; pass distance=True if small ones are. With train_frames (their number), integers
        are the indices of the best training frames of each query, as faiss returns them.
    Settings: those of evaluate, and train_first, missing, threshold and rows_are_windows_of.

    >>> vpr.evaluate_scores(tuesday @ monday.T, "aligned").recall_at[1]
    1.0
    """
    if ground_truth is None:
        raise UsageError("there is no ground truth")
    settings.setdefault("similarity", not settings.get("distance"))
    return _evaluate("evaluate_scores", None, scores, ground_truth, settings, progress)


def distances(db: Database, query: Source, *, progress: Progress = None,
              **settings: object) -> Distances:
    """Frame distances of a query (images, a .npy file or an array) to all training frames.

    >>> d = vpr.distances(vpr.train(descriptors=monday), tuesday)
    >>> d.shape, int(d[0].argmin()), np.asarray(d).dtype
    ((200, 200), 0, dtype('uint16'))
    """
    return _vpr.distances(_call("distances", settings, progress), _opened(db, Database), query)


def compare(reports: Any, *, progress: Progress = None, **settings: object) -> Comparison:
    """Compares reports, as vpr-eval compare: metrics side by side, and differences to the first
    report of a data set with 95 % intervals. Several data sets have a list, comparisons, with
    one comparison each.

    reports: a list, or a mapping from names; reports of evaluate, or paths of report files.
    Settings: block, recall_at, common and allow_different.

    >>> db = vpr.train(descriptors=monday)
    >>> found = {"filter": {}, "windows": {"c_l": 5, "t_r": 0.5}}
    >>> print(vpr.compare({name: vpr.evaluate(vpr.query(db, descriptors=tuesday, **by), "aligned")
    ...                    for name, by in found.items()}).reports[1].name)
    windows
    """
    if isinstance(reports, (Report, str, bytes, os.PathLike)):
        reports = [reports]
    named = reports.items() if isinstance(reports, Mapping) else [("", one) for one in reports]
    texts, names = [], []
    for number, (name, report) in enumerate(named):
        text = report._made.text() if isinstance(report, Report) else _vpr.json_text(report)
        values = _json.loads(text)
        if name and isinstance(values, dict):
            text = _json.dumps({**values, "name": _text(str(name))})
        texts.append(text)
        own = f"report {number + 1}" if isinstance(report, Report) else os.fspath(report)
        names.append(_text(str(name) or own))
    return Comparison(_vpr.compare(_call("compare", settings, progress), texts, names))
