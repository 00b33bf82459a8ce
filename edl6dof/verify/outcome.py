"""What a check case hands back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


class NotInstalledError(RuntimeError):
    """A check case lacks its reference data."""


@dataclass(frozen=True)
class Result:
    """One comparison: the error found against its tolerance, both in ``unit``.

    Attributes:
        quantity: what is compared.
        verifies: the model or method that the comparison proves.
        source: where the expected value comes from, independent of the simulator.
        why: why the tolerance is what it is.
    """

    quantity: str
    verifies: str
    source: str
    error: float
    tolerance: float
    unit: str
    why: str

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance; an error that is not a number is not."""
        return bool(self.error <= self.tolerance)


@dataclass(frozen=True)
class History:
    """Curves for the plot of a case; dashed ones (name ends in ``expected``) come from the independent
    source.
    """

    title: str
    x_label: str
    y_label: str
    x: np.ndarray
    curves: dict[str, np.ndarray]


@dataclass(frozen=True)
class Outcome:
    """All comparisons of one case, and its history if it has one."""

    results: tuple[Result, ...]
    history: History | None = None

    @property
    def passed(self) -> bool:
        """Whether every comparison is within its tolerance; a case without any has proved nothing."""
        return bool(self.results) and all(result.passed for result in self.results)


#: A case takes scenario overrides that plant an error in what is flown, and not in what is expected.
Oracle = Callable[..., Outcome]
