"""Visual place recognition on NumPy arrays, images and video.

Each function has the defaults of a program and gives the bytes of its files: train those of
vpr-train, query those of vpr-query, evaluate those of vpr-eval. Settings are keyword arguments with
the names of JSON keys (--c-l 20 is c_l=20); None is the default. All functions also take threads
(0: all cores), seed, order and max_megapixels.

Work releases the interpreter's lock, stops on KeyboardInterrupt, and calls progress(step, done,
total) up to 20 times per second. Warnings are UserWarning. Errors have the sentences of the
programs and a class by kind: UsageError, InputError, OutputError, DataError and InternalError are
subclasses of Error.
"""

from __future__ import annotations

import html as _html
import json as _json
import os
import tempfile
from collections.abc import Callable, Mapping
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _vpr
from ._vpr import Database, Distances, Result, __version__

__all__ = ["Database", "DataError", "Distances", "Error", "Fields", "InputError", "InternalError",
           "Live", "OutputError", "Report", "Result", "UsageError", "distances", "evaluate",
           "evaluate_scores", "load", "loops", "query", "query_scores", "train"]

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
    """A JSON object whose keys are also attributes. Keys that are numbers are int."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        super().__init__((int(key) if key.isdigit() else key, values[key]) for key in values)

    def __getattr__(self, name: str) -> Any:
        if name not in self:
            raise AttributeError(name)
        return self[name]


def _read(text: str) -> Any:
    return _json.loads(text, object_hook=Fields)


def _text(settings: Mapping[str, object]) -> str:
    def plain(value: object) -> object:
        is_array = isinstance(value, (np.generic, np.ndarray))
        return value.tolist() if is_array else os.fspath(value)  # type: ignore
    return _json.dumps({key: value for key, value in settings.items() if value is not None},
                       default=plain)


def _sources(value: Any) -> list[tuple[str, Any]]:
    """The names, as far as there are any, and sources of one sequence, a list or a mapping."""
    if isinstance(value, Mapping):
        return list(value.items())
    return [("", item) for item in (value if isinstance(value, (list, tuple)) else [value])]


class Report:
    """An evaluation. Attributes are the keys of the report file (docs/reference/files.md) and of
    its "metrics": report.counts.pairs.correct, report.recall_at[1], report.localization.share.
    counts.recognitions is another name of counts.pairs."""

    def __init__(self, made: Any) -> None:
        self._made = made
        self.json = _read(made.text())
        self.summary: str = made.summary()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        value = self.json.get("metrics", {}).get(name) or getattr(self.json, name)
        return Fields({**value, "recognitions": value.pairs}) if name == "counts" else value

    @property
    def curve(self) -> NDArray[np.float64]:
        """Columns threshold, correct and incorrect: best matches accepted at each threshold, the
        strictest first. Recall is correct / report.single_best.positives."""
        curve: NDArray[np.float64] = self._made.curve()
        return curve

    def save(self, path: Path, force: bool = False) -> None:
        """Writes the report file of vpr-eval."""
        _vpr.save_text(path, self._made.text(), force)

    def html(self, path: Path, force: bool = False) -> None:
        """Writes the page of vpr-eval --html."""
        _vpr.save_text(path, self._made.page(False), force)

    def __repr__(self) -> str:
        return f"<vpr.Report: {self.summary}>"

    def _repr_html_(self) -> str:
        page = _html.escape(self._made.page(True))
        return f'<iframe srcdoc="{page}" style="width:100%;height:900px;border:0"></iframe>'


class Live:
    """A query whose frames arrive one by one, as in vpr-query live. Settings: those of query.

    >>> live = vpr.Live(vpr.train(descriptors=monday), c_l=5, score="zscore", decide="margin")
    >>> lines = [live.add(row) for row in tuesday]
    >>> lines[4].recognized[0].frame
    4
    """

    def __init__(self, db: Database, **settings: object) -> None:
        self._live = _vpr.Live(db, _text(settings))

    def add(self, frame: Source, name: str = "") -> Fields:
        """Matches the next frame: an image file; an image (uint8), height x width gray levels or
        height x width x 3 in the order blue, green, red; for a database of descriptors, d values;
        or None if it is missing. Returns the line of vpr-query live; its decisions are in
        recognized."""
        line: Fields = self._live.add(frame, name)
        return line

    def finish(self) -> Optional[Fields]:
        """The decisions of the filter that the end of the query settles; None without any."""
        line: Optional[Fields] = self._live.finish()
        return line


def train(images: Any = None, *, descriptors: Any = None, pretrain: Any = None,
          progress: Progress = None, **settings: object) -> Database:
    """Builds a database of training sequences.

    images: a folder, list or video as on the command line ("monday@10:80"), a list of them, or a
        mapping from names. descriptors: likewise .npy files or arrays, n x d values (float16,
        float32 or float64) or bits (uint8 with 8 per value, or bool). A C-contiguous uint8 array
        with a multiple of 8 columns is used in place: do not change it later.
    Settings: those of vpr-train fastable and descriptors, such as descriptor, c_l, fps, metric and
        value_bits. With pretrain (frames of other places), those of vpr-train fabmap.

    >>> db = vpr.train(descriptors=monday)
    >>> db.sequences, db.descriptors.dtype, db.descriptors.shape
    (['train'], dtype('int16'), (200, 64))
    """
    return _vpr.train(_sources(images if descriptors is None else descriptors),
                      [] if pretrain is None else _sources(pretrain), _text(settings), progress)


def load(path: Path) -> Any:
    """Opens a folder of vpr-train as a Database, or a result file (.json) as a Result."""
    is_result = os.fspath(path).endswith(".json")
    return _vpr.load_result(path) if is_result else _vpr.load_database(path)


def query(db: Database, images: Optional[Path] = None, *, descriptors: Source = None,
          name: str = "", progress: Progress = None, **settings: object) -> Result:
    """Recognizes the places of a query sequence, by default at any walking speed.

    images: a folder, list or video. descriptors: an array or a .npy file. name: in results; by
        default of the path, or "query".
    Settings: those of vpr-query, such as c_l, score, decide, margin, t_r, method, fps, speed, fuse
        (the folder of a FAB-MAP database) and max_memory (bytes). For FAB-MAP: t_p, c_w, ...

    >>> db = vpr.train(descriptors=monday)
    >>> result = vpr.query(db, descriptors=tuesday, c_l=5, score="zscore", decide="margin")
    >>> result.best[7], len(result.recognitions)
    ((7, 0, 7), 196)
    """
    return _vpr.query("vpr.query", db, name, images if descriptors is None else descriptors,
                      _text(settings), progress)


def loops(images: Optional[Path] = None, *, descriptors: Source = None,
          db: Optional[Database] = None, name: str = "", progress: Progress = None,
          **settings: object) -> Result:
    """Recognizes the places of a sequence in its own past, as vpr-query loops.

    db: FAB-MAP's, for its words and places; without it, windows are compared.
    Settings: loop_gap (the least number of frames between a frame and its match) or loop_gap_s
        (seconds, with frame_times), descriptor, and those of query.

    >>> laps = np.concatenate([monday, tuesday])
    >>> result = vpr.loops(descriptors=laps, loop_gap=100, c_l=5, score="zscore", t_r=-2)
    >>> result.recognitions[-1]
    (395, 0, 195)
    """
    return _vpr.query("vpr.loops", db, name, images if descriptors is None else descriptors,
                      _text(settings), progress)


def query_scores(scores: Source, *, name: str = "", progress: Progress = None,
                 **settings: object) -> Result:
    """Matches windows of scores of any program, query x training frames, as vpr-query matrix.

    scores: an array or a .npy file. Pass similarity=True if large scores are good, or distance=True.
    Settings: those of query, and train_first, missing and train_sequence (["NAME=FIRST:LAST", ...]).

    >>> result = vpr.query_scores(tuesday @ monday.T, similarity=True, c_l=5)
    >>> result.best[7]
    (7, 0, 7)
    """
    return _vpr.query("vpr.query_scores", None, name, scores, _text(settings), progress)


def _evaluate(judge: Callable[..., Any], judged: object, truth: Source, settings: dict[str, Any],
              progress: Progress) -> Report:
    """Arrays go through temporary files, so that the readers of ground truths check them."""
    with tempfile.TemporaryDirectory() as folder:
        def saved(name: str, value: Any, is_positions: bool) -> str:
            if value is None or isinstance(value, (str, os.PathLike)):
                return os.fspath(value or "")
            array = np.asarray(value)
            path = os.path.join(folder, name)
            if is_positions:
                array = np.column_stack([np.arange(len(array)), array])
            elif array.shape[1:] != (2,) or array.dtype.kind not in "iu":
                np.save(path + ".npy", array)
                return path + ".npy"
            columns = ["frame", "x", "y", "heading"] if is_positions else ["query", "reference"]
            header = ",".join(columns[:array.shape[1]])
            np.savetxt(path + ".csv", array, "%.17g", ",", header=header, comments="")
            return path + ".csv"
        has_positions = settings.get("reference") is not None
        if has_positions:
            settings["reference"] = saved("reference", settings["reference"], True)
        path = saved("query", truth, has_positions)
        return Report(judge(judged, path, _text(settings), progress))


def evaluate(result: Result, ground_truth: Source = None, *, progress: Progress = None,
             **settings: object) -> Report:
    """Judges a result by a ground truth; without one, it counts what was recognized.

    ground_truth: a file or folder of any format, "aligned", or an array: pairs (n x 2 integers,
        query and training frame); a matrix of labels (query x training frames, bool or uint8); or
        positions in meters (x, y and optionally the heading in degrees) with reference (those of
        the training frames) and radius_m.
    Settings: tolerance, format, reference, radius_m, ... as in data set descriptions; confidence,
        recall_at, stretch, poses, places and name as in vpr-eval.

    >>> db = vpr.train(descriptors=monday)
    >>> result = vpr.query(db, descriptors=tuesday, c_l=5, t_r=0.5)
    >>> report = vpr.evaluate(result, "aligned", tolerance=3)
    >>> report.counts.recognitions.correct, report.recall_at[1]
    (196, 0.98)
    """
    return _evaluate(_vpr.evaluate, result, ground_truth, settings, progress)


def evaluate_scores(scores: Source, ground_truth: Source, *, progress: Progress = None,
                    **settings: object) -> Report:
    """Judges scores of any program, query x training frames, as vpr-eval matrix.

    scores: an array or a .npy file of any number type; NaN is not a score. By default, large scores
        are good; pass distance=True if small ones are.
    Settings: those of evaluate, and train_first, missing, threshold and rows_are_windows_of.

    >>> vpr.evaluate_scores(tuesday @ monday.T, "aligned").recall_at[1]
    1.0
    """
    settings.setdefault("similarity", not settings.get("distance"))
    return _evaluate(_vpr.evaluate_scores, scores, ground_truth, settings, progress)


def distances(db: Database, query: Source, *, progress: Progress = None,
              **settings: object) -> Distances:
    """Frame distances of a query (images, a .npy file or an array) to all training frames.

    >>> d = vpr.distances(vpr.train(descriptors=monday), tuesday)
    >>> d.shape, d[0].argmin(), np.asarray(d).dtype
    ((200, 200), 0, dtype('uint16'))
    """
    return _vpr.distances(db, query, _text(settings), progress)
