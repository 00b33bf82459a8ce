"""Things that are asked for by name: who mistypes one is told which was probably meant."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeVar

Value = TypeVar("Value")


class UnknownName(KeyError):
    """There is no such thing; the text says which was probably meant, worked out only when it is read.

    Attributes:
        kind: what the names are of, such as ``channel``.
        name: what was asked for.
    """

    def __init__(self, kind: str, name: object, known: Iterable[str]):
        super().__init__(name)
        self.kind, self.name, self._known = kind, name, known

    def __str__(self) -> str:
        from edl6dof.config.wording import nearest  # which loads pydantic

        near = nearest(str(self.name), self._known)
        return f"no {self.kind} {self.name!r}" + (f"; did you mean {near!r}?" if near else "")


class Named(dict[str, Value]):
    """Values by name.

    Raises:
        UnknownName: on access by a name that it does not have.
    """

    def __init__(self, kind: str, values: Mapping[str, Value]):
        """``kind``: what the names are of, such as ``figure``."""
        super().__init__(values)
        self._kind = kind

    def __missing__(self, name: str) -> Value:
        raise UnknownName(self._kind, name, self)
