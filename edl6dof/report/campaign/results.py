"""A campaign's folder read back: columns as numbers, the limits, and how many succeeded."""

from __future__ import annotations

from collections import Counter
from fnmatch import fnmatchcase
from functools import cached_property
from os.path import commonprefix
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pyarrow as pa

from edl6dof.campaign.design.case import BELIEF, TRUTH
from edl6dof.campaign.design.params import Of
from edl6dof.campaign.statistics import Proportion
from edl6dof.campaign.storage.store import Store
from edl6dof.config.document.source import parse_document
from edl6dof.metrics.evaluation import LIMITS


class Results:
    """The rows of a campaign, finished or not."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.store = Store(folder)
        self.table = self.store.table()

    @cached_property
    def document(self) -> dict[str, Any]:
        """The plan as plain data: scenario, campaign and sweep sections with every default."""
        return parse_document(self.store.plan_text, str(self.folder / "campaign.yaml")).data

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return str(self.document["name"])

    @property
    def has_faults(self) -> bool:
        """Whether the cases are the cells of a fault matrix."""
        return self.document.get("fault_matrix") is not None

    @cached_property
    def cases(self) -> np.ndarray:
        """Numbers of the cases, shape (n,)."""
        return self.table["case"].to_numpy()

    @cached_property
    def ok(self) -> np.ndarray:
        """Which cases succeeded, shape (n,)."""
        return self.table["success"].to_numpy(zero_copy_only=False).astype(bool)

    @property
    def success(self) -> Proportion:
        """Share of successes."""
        return Proportion(int(self.ok.sum()), len(self.ok))

    @cached_property
    def causes(self) -> list[tuple[str, int]]:
        """Causes of failures, the most frequent first."""
        return Counter(cause for cause in self.table["cause"].to_pylist() if cause).most_common()

    def has(self, name: str) -> bool:
        """Whether a numeric column exists."""
        return name in self.table.column_names and is_number(self.table.schema.field(name).type)

    def __getitem__(self, name: str) -> np.ndarray:
        """A numeric column, NaN where a case has no value, shape (n,)."""
        values = self.table[name].cast(pa.float64()).to_numpy(zero_copy_only=False)
        return np.asarray(values, dtype=float)

    @cached_property
    def inputs(self) -> dict[str, np.ndarray]:
        """Dispersed quantities by dotted path; beliefs are marked."""
        names = [
            name for name in self.table.column_names if name.startswith((TRUTH, BELIEF)) and self.has(name)
        ]
        return {name.removeprefix(TRUTH): self[name] for name in names}

    @cached_property
    def groups(self) -> dict[str, np.ndarray]:
        """Values of dispersed quantities, shape (n, quantities), those together that the plan draws together:
        by one path with a wildcard, or as correlated.
        """
        found: dict[str, list[np.ndarray]] = {}
        for name, values in self.inputs.items():
            found.setdefault(self._group(name), []).append(values)
        return {name: np.stack(columns, axis=1) for name, columns in found.items()}

    def _group(self, name: str) -> str:
        """Name of the group of a dispersed quantity: that of a lone one is its own."""
        campaign = self.document.get("campaign") or {}
        prefix = BELIEF if name.startswith(BELIEF) else ""
        path = name.removeprefix(BELIEF)
        for group in campaign.get("correlated", ()):
            if path in group["paths"]:
                return f"{prefix}{commonprefix(group['paths'])}*"
        patterns = (pattern for of in get_args(Of) for pattern in campaign.get(of, ()))
        return prefix + next((pattern for pattern in patterns if fnmatchcase(path, pattern)), path)

    @cached_property
    def limits(self) -> list[tuple[str, str, float, str]]:
        """(figure, label, limit, unit) of every limit that was applied to a case."""
        given = self.document["limits"]
        return [
            (figure.name, figure.meaning, float(given[figure.limit]), figure.unit.label)
            for figure in LIMITS
            if given.get(figure.limit) is not None and self.has(figure.name)
        ]


def is_number(kind: pa.DataType) -> bool:
    """Whether an Arrow type holds numbers."""
    return pa.types.is_floating(kind) or pa.types.is_integer(kind)
