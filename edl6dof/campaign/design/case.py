"""One case of a campaign, study or fault matrix: what differs from the scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

#: Who knows of a change: nature alone, the flight computer alone, or both.
Of = Literal["truth", "belief", "both"]

#: Prefixes of the columns that hold what was changed.
TRUTH, BELIEF = "truth.", "belief."

#: Columns that say to which matrix and row of a design of Sobol indices a case belongs; the two matrices.
MATRIX, ROW = "matrix", "row"
A, B = "A", "B"


@dataclass(frozen=True)
class Case:
    """Changes of one flight, by dotted path.

    Attributes:
        index: number of the case; rows come in its order.
        truth: values of which the flight computer is not told.
        belief: values that the flight computer is told; the truth follows them where ``truth`` does not say
            otherwise.
        profile: which random profiles (density, gusts) of the scenario's seed it meets; the scenario's own
            when ``None``.
        label: columns to put into the row as they are, such as the name of the law or the failed thruster.
    """

    index: int
    truth: Mapping[str, Any] = field(default_factory=dict)
    belief: Mapping[str, Any] = field(default_factory=dict)
    profile: int | None = None
    label: Mapping[str, Any] = field(default_factory=dict)

    @property
    def told(self) -> dict[str, Any]:
        """Changes of the scenario itself."""
        return dict(self.belief) if self.profile is None else {**self.belief, "profile": self.profile}

    def changes(self, truth: Mapping[str, Any]) -> dict[str, Any]:
        """The values by dotted path that turn a scenario with this ``truth`` section into the case."""
        return {**self.told, "truth": {**truth, **self.truth}}
