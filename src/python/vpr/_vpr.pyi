from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import Fields, Path

__version__: str

class Database:
    sequences: list[str]
    descriptors: NDArray[Any]
    def _repr_html_(self) -> str: ...
    def save(self, path: Path, force: bool = ...) -> None: ...

class Result:
    json: Fields
    recognitions: NDArray[Any]
    best: NDArray[Any]
    margins: NDArray[np.float64]
    def __getattr__(self, name: str) -> NDArray[Any]: ...
    def _repr_html_(self) -> str: ...
    def save(self, path: Path, force: bool = ...) -> None: ...

class Distances:
    shape: tuple[int, int]
    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> NDArray[np.uint16]: ...
    def __array__(self, dtype: Any = ..., copy: Any = ...) -> NDArray[Any]: ...

def __getattr__(name: str) -> Any: ...  # functions with a wrapper in vpr
