"""The rows of a campaign, read from its folder: columns as numbers, limits, and the share of successes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from edl6dof.campaign.row_columns import BELIEF, MATRIX, ROW, TRUTH, A, B, group_of, is_constant
from edl6dof.campaign.statistics import Proportion
from edl6dof.campaign.store import Store
from edl6dof.config.document.source import parse_document
from edl6dof.metrics.figures import LIMITS, FigureOfMerit


class Results:
    """The rows of a campaign, finished or not."""

    def __init__(self, folder: Path, columns: Sequence[str] | None = None):
        """Read a folder; ``columns``: names to read in addition to success, by default all."""
        self.folder = folder
        self.store = Store(folder)
        self._every = self.store.table(None if columns is None else ["case", "success", MATRIX, *columns])

    @cached_property
    def table(self) -> pa.Table:
        """Rows of independent flights: of matrices A and B in a design of Sobol indices, else all rows."""
        if not self.has_design:
            return self._every
        return self._every.filter(pc.is_in(self._every[MATRIX], pa.array([A, B])))

    @property
    def has_design(self) -> bool:
        """True if the campaign flew the design of Sobol indices."""
        return MATRIX in self._every.column_names

    def swapped(self, name: str) -> dict[str, np.ndarray]:
        """Return the values of a figure by matrix of the design of Sobol indices (A, B, and A with one group
        of inputs from B), each of shape (rows,), NaN where a flight lacks the figure.
        """
        matrices, rows = (self._every[column].to_pylist() for column in (MATRIX, ROW))
        found = {matrix: np.full(1 + max(rows), np.nan) for matrix in dict.fromkeys(matrices)}
        for matrix, row, value in zip(matrices, rows, numbers(self._every[name]), strict=True):
            found[matrix][row] = value
        return found

    @cached_property
    def document(self) -> dict[str, Any]:
        """Plan of the campaign as plain data, defaults included."""
        return parse_document(self.store.plan_text, str(self.folder / "campaign.yaml")).data

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return str(self.document["name"])

    @property
    def has_faults(self) -> bool:
        """True if the campaign is a fault matrix, whose cases are its cells."""
        return self.document.get("fault_matrix") is not None

    @property
    def is_sample(self) -> bool:
        """True if the flights are drawn at random, and are neither the points of a grid nor the cells of a
        fault matrix: only quantiles of a sample have bounds.
        """
        return not (self.has_faults or self.document.get("sweep"))

    @cached_property
    def cases(self) -> np.ndarray:
        """Numbers of the cases, shape (n,)."""
        return self.table["case"].to_numpy()

    @cached_property
    def ok(self) -> np.ndarray:
        """True for the cases that succeeded, shape (n,)."""
        return self.table["success"].to_numpy(zero_copy_only=False).astype(bool)

    @cached_property
    def failed(self) -> np.ndarray:
        """True for the cases whose failure no limit explains: those that failed within all limits, or without
        a value of every figure that has a limit; shape (n,).
        """
        explained = np.zeros(len(self.ok), bool)
        for figure, limit in self.limits:
            explained |= figure.violates(self[figure.name], limit)
        for figure, _ in self.limits:
            explained &= np.isfinite(self[figure.name])
        return ~(self.ok | explained)

    @property
    def success(self) -> Proportion:
        """Share of successes."""
        return Proportion(int(self.ok.sum()), len(self.ok))

    @cached_property
    def causes(self) -> list[tuple[str, int]]:
        """Causes of failures, the most frequent first."""
        return Counter(cause for cause in self.table["cause"].to_pylist() if cause).most_common()

    def has(self, name: str) -> bool:
        """Return True if a numeric column exists."""
        if name not in self.table.column_names:
            return False
        kind = self.table.schema.field(name).type
        return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind))

    def __getitem__(self, name: str) -> np.ndarray:
        """A numeric column, NaN where a case has no value, shape (n,)."""
        return numbers(self.table[name])

    def nearest(self, figure: FigureOfMerit, number: int) -> np.ndarray:
        """Rows of the cases with the worst finite values of a figure, the worst first."""
        values = self[figure.name]
        finite = np.flatnonzero(np.isfinite(values))
        worse = values[finite] if figure.clearance else -values[finite]
        return finite[np.argsort(worse, kind="stable")][:number]

    @cached_property
    def groups(self) -> dict[str, np.ndarray]:
        """Dispersed quantities, shape (n, quantities), in the groups that the plan draws together."""
        found: dict[str, list[np.ndarray]] = {}
        campaign = self.document.get("campaign") or {}
        for name in self.table.column_names:
            if name.startswith((TRUTH, BELIEF)) and self.has(name):
                found.setdefault(group_of(name, campaign), []).append(self[name])
        return {name: np.stack(columns, axis=1) for name, columns in found.items()}

    @cached_property
    def constants(self) -> dict[str, np.ndarray]:
        """Dispersed quantities that are constant but unknown, by column, each of shape (n,)."""
        campaign = self.document.get("campaign") or {}
        dispersed = (name for name in self.table.column_names if name.startswith((TRUTH, BELIEF)))
        return {name: self[name] for name in dispersed if self.has(name) and is_constant(name, campaign)}

    @cached_property
    def limits(self) -> list[tuple[FigureOfMerit, float]]:
        """Figure and limit of every limit that was applied to a case."""
        given = self.document["limits"]
        return [
            (figure, float(given[figure.limit]))
            for figure in LIMITS
            if given.get(figure.limit) is not None and self.has(figure.name)
        ]


def numbers(column: pa.ChunkedArray) -> np.ndarray:
    """Return a numeric column, shape (rows,), NaN where it has no value."""
    return np.asarray(column.cast(pa.float64()).to_numpy(zero_copy_only=False), dtype=float)
