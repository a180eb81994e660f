from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import Fields, Path

__version__: str

class Database:
    sequences: list[str]
    descriptors: NDArray[Any]
    def save(self, path: Path, force: bool = ...) -> None: ...

class Result:
    json: Fields
    recognitions: NDArray[Any]
    best: NDArray[Any]
    margins: NDArray[np.float64]
    def __getattr__(self, name: str) -> NDArray[Any]: ...
    def save(self, path: Path, force: bool = ...) -> None: ...

class Distances:
    shape: tuple[int, int]
    unit: float
    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> NDArray[np.uint16]: ...
    def __array__(self, dtype: Any = ..., copy: Any = ...) -> NDArray[Any]: ...

Live: Callable[..., Any]
Report: type
train: Callable[..., Database]
load_database: Callable[..., Database]
load_result: Callable[..., Result]
query: Callable[..., Result]
evaluate: Callable[..., Any]
evaluate_scores: Callable[..., Any]
distances: Callable[..., Distances]
save_text: Callable[..., None]
