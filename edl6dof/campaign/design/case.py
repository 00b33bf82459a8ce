"""One case of a campaign, study or fault matrix: what differs from the scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from os.path import commonprefix
from typing import Any, Literal, get_args

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
        truth: true values, unknown to the flight computer.
        belief: values that the flight computer believes; the truth follows them where ``truth`` does not say
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


def group_of(column: str, campaign: Mapping[str, Any]) -> str:
    """Name of the group of a dispersed quantity: those of one path with a wildcard belong together, and those
    drawn as correlated; groups are independent of each other.  A lone one is its own, by its path.

    Args:
        column: of the results, such as ``truth.wind.scale``; a value of the belief keeps its mark.
        campaign: the campaign section as plain data.
    """
    mark = BELIEF if column.startswith(BELIEF) else ""
    path = column.removeprefix(BELIEF).removeprefix(TRUTH)
    for together in campaign.get("correlated", ()):
        if path in together["paths"]:
            return f"{mark}{commonprefix(together['paths'])}*"
    patterns = (pattern for of in get_args(Of) for pattern in campaign.get(of, ()))
    return mark + next((pattern for pattern in patterns if fnmatchcase(path, pattern)), path)
