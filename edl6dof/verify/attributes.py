"""Fields of records as attributes in plain Python, as compiled code sees them."""

from __future__ import annotations

from typing import Any

import numpy as np


class Record:
    """Fields of a structured numpy scalar as attributes, as compiled code sees them."""

    __slots__ = ("_void",)

    def __init__(self, void: np.void) -> None:
        object.__setattr__(self, "_void", void)

    def __getattr__(self, name: str) -> Any:
        value = self._void[name]
        if isinstance(value, np.void):
            return Record(value)
        return Records(value) if isinstance(value, np.ndarray) and value.dtype.names else value

    __getitem__ = __getattr__

    def __setattr__(self, name: str, value: Any) -> None:
        self._void[name] = value


class Records:
    """A structured array whose items are :class:`Record`."""

    def __init__(self, array: np.ndarray) -> None:
        self.array, self.shape = array, array.shape

    def __getitem__(self, index: int) -> Record:
        return Record(self.array[index])

    def __len__(self) -> int:
        return len(self.array)

    def view(self, kind: type) -> np.ndarray:
        """The same memory as plain numbers."""
        return self.array.view(kind)
