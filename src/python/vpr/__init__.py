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
from numpy.typing import NDArray

from . import _vpr
from ._vpr import Database, Distances, Result, __version__

__all__ = ["Database", "DataError", "Distances", "Error", "Fields", "InputError", "InternalError",
           "Live", "OutputError", "Report", "Result", "UsageError", "distances", "evaluate",
           "evaluate_scores", "load", "loops", "query", "query_scores", "train"]

Path = Union[str, "os.PathLike[str]"]
Array = NDArray[Any]
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

    def __getattr__(self, name: str) -> Any:
        if name not in self:
            raise AttributeError(name)
        return self[name]


def _read(text: str) -> Fields:
    def fields(values: dict[str, Any]) -> Fields:
        return Fields((int(key) if key.isdigit() else key, value) for key, value in values.items())
    result: Fields = _json.loads(text, object_hook=fields)
    return result


def _text(settings: Mapping[str, object]) -> str:
    def plain(value: object) -> object:
        if isinstance(value, (np.generic, np.ndarray)):
            return value.tolist()
        return os.fspath(value)  # type: ignore[call-overload]
    return _json.dumps({key: value for key, value in settings.items() if value is not None},
                       default=plain)


def _source(value: Union[None, Path, Array]) -> _vpr.Source:
    if value is None:
        raise UsageError("frames are missing: pass images or descriptors")
    return value if isinstance(value, np.ndarray) else os.fspath(value)


def _sources(value: Any) -> list[tuple[str, _vpr.Source]]:
    """One sequence, a list, or a mapping, as names and sources; "": the name of the path."""
    if isinstance(value, Mapping):
        return [(name, _source(item)) for name, item in value.items()]
    items = list(value) if isinstance(value, (list, tuple)) else [value]
    names = ["train"] if len(items) == 1 else [f"train{i}" for i in range(len(items))]
    return [(name if isinstance(item, np.ndarray) else "", _source(item))
            for name, item in zip(names, items)]


def _query(images: Optional[Path], descriptors: Union[None, Path, Array],
           name: str) -> tuple[str, _vpr.Source]:
    source = _source(images if descriptors is None else descriptors)
    return name or ("query" if isinstance(source, np.ndarray) else ""), source


class Report:
    """An evaluation. Attributes are the keys of the report file (docs/reference/files.md) and of
    its "metrics": report.counts.pairs.correct, report.recall_at[1], report.localization.share."""

    def __init__(self, made: _vpr.Report) -> None:
        self._made = made
        self.json = _read(made.text())
        self.summary = made.summary()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        metrics = self.json.get("metrics", Fields())
        return metrics[name] if name in metrics else getattr(self.json, name)

    @property
    def curve(self) -> NDArray[np.float64]:
        """Columns threshold, correct and incorrect: best matches accepted at each threshold, the
        strictest first. Recall is correct / report.single_best.positives."""
        return self._made.curve()

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

    def add(self, frame: Union[None, Path, Array], name: str = "") -> Fields:
        """Matches the next frame: an image file; an image (uint8), height x width gray levels or
        height x width x 3 in the order blue, green, red; for a database of descriptors, d values;
        or None if it is missing. Returns the line of vpr-query live; its decisions are in
        recognized."""
        is_path = not (frame is None or isinstance(frame, np.ndarray))
        source = None if frame is None else _source(frame)
        return self._live.add(source, name or (os.path.basename(str(source)) if is_path else ""))

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
    Settings: those of vpr-train fastable and descriptors, such as descriptor, c_l, fps, metric and
        value_bits. With pretrain (frames of other places), those of vpr-train fabmap.

    >>> db = vpr.train(descriptors=monday)
    >>> db.sequences, db.descriptors.dtype, db.descriptors.shape
    (['train'], dtype('int16'), (200, 64))
    """
    sources = _sources(images if descriptors is None else descriptors)
    return _vpr.train(sources, [] if pretrain is None else _sources(pretrain), _text(settings),
                      progress)


def load(path: Path) -> Any:
    """Opens a folder of vpr-train as a Database, or a result file (.json) as a Result."""
    is_result = os.fspath(path).endswith(".json")
    return _vpr.load_result(path) if is_result else _vpr.load_database(path)


def query(db: Database, images: Optional[Path] = None, *,
          descriptors: Union[None, Path, Array] = None, name: str = "",
          progress: Progress = None, **settings: object) -> Result:
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
    return _vpr.query(db, *_query(images, descriptors, name), _text(settings), progress)


def loops(images: Optional[Path] = None, *, descriptors: Union[None, Path, Array] = None,
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
    return _vpr.loops(db, *_query(images, descriptors, name), _text(settings), progress)


def query_scores(scores: Union[Path, Array], *, name: str = "",
                 progress: Progress = None, **settings: object) -> Result:
    """Matches windows of scores of any program, query x training frames, as vpr-query matrix.

    scores: an array or a .npy file. Pass similarity=True if large scores are good, or distance=True.
    Settings: those of query, and train_first, missing and train_sequence (["NAME=FIRST:LAST", ...]).

    >>> result = vpr.query_scores(tuesday @ monday.T, similarity=True, c_l=5)
    >>> result.best[7]
    (7, 0, 7)
    """
    return _vpr.query_scores(_source(scores), name, _text(settings), progress)


def _evaluate(truth: Union[None, Path, Array], settings: dict[str, Any],
              judge: Callable[[str, str], _vpr.Report]) -> Report:
    """Arrays go through temporary files, so that the readers of ground truths check them."""
    reference = settings.get("reference")
    with tempfile.TemporaryDirectory() as folder:
        def csv(name: str, array: Array, columns: str) -> str:
            path = os.path.join(folder, name + ".csv")
            np.savetxt(path, array, "%.17g", ",", header=columns, comments="")
            return path

        def positions(name: str, array: Array) -> str:
            columns = "frame,x,y,heading" if array.shape[1] == 3 else "frame,x,y"
            return csv(name, np.column_stack([np.arange(len(array)), array]), columns)
        if isinstance(reference, np.ndarray):
            settings["reference"] = positions("reference", reference)
        if isinstance(truth, np.ndarray) and "reference" in settings:
            truth = positions("query", truth)
        elif isinstance(truth, np.ndarray) and truth.shape[1:] == (2,) and truth.dtype.kind in "iu":
            truth = csv("query", truth, "query,reference")
        elif isinstance(truth, np.ndarray):
            np.save(os.path.join(folder, "query.npy"), truth)
            truth = os.path.join(folder, "query.npy")
        return Report(judge("" if truth is None else os.fspath(truth), _text(settings)))


def evaluate(result: Result, ground_truth: Union[None, Path, Array] = None, *,
             progress: Progress = None, **settings: object) -> Report:
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
    >>> report.counts.pairs.correct, report.recall_at[1]
    (196, 0.98)
    """
    return _evaluate(ground_truth, settings,
                     lambda truth, text: _vpr.evaluate(result, truth, text, progress))


def evaluate_scores(scores: Union[Path, Array], ground_truth: Union[Path, Array], *,
                    progress: Progress = None, **settings: object) -> Report:
    """Judges scores of any program, query x training frames, as vpr-eval matrix.

    scores: an array or a .npy file of any number type; NaN is not a score. Pass similarity=True if
        large scores are good, or distance=True.
    Settings: those of evaluate, and train_first, missing, threshold and rows_are_windows_of.

    >>> vpr.evaluate_scores(tuesday @ monday.T, "aligned", similarity=True).recall_at[1]
    1.0
    """
    return _evaluate(ground_truth, settings, lambda truth, text: _vpr.evaluate_scores(
        _source(scores), truth, text, progress))


def distances(db: Database, query: Union[Path, Array], *, progress: Progress = None,
              **settings: object) -> Distances:
    """Frame distances of a query (images, a .npy file or an array) to all training frames.

    >>> d = vpr.distances(vpr.train(descriptors=monday), tuesday)
    >>> d.shape, d[0].argmin(), np.asarray(d).dtype
    ((200, 200), 0, dtype('uint16'))
    """
    return _vpr.distances(db, _source(query), _text(settings), progress)
