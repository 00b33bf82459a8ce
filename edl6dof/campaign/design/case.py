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
        truth: values that the flight computer does not know.
        belief: values that the flight computer knows; they also hold in the truth unless ``truth`` has
            another value.
        profile: number of the random profiles (density, gusts) of the scenario's seed; ``None`` for the
            scenario's own.
        label: columns that are copied into the row, such as the name of the law or the failed thruster.
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
    """Return the name of the group of a dispersed quantity.

    The quantities of one path with a wildcard form a group, and so do quantities drawn with a correlation.
    Groups are independent of each other.  Any other quantity is a group of one with its path as name.

    Args:
        column: column of the results, such as ``truth.wind.scale``; the mark of a quantity that the flight
            computer knows is kept in the name.
        campaign: the campaign section as plain data.
    """
    mark = BELIEF if column.startswith(BELIEF) else ""
    path = column.removeprefix(BELIEF).removeprefix(TRUTH)
    for together in campaign.get("correlated", ()):
        if path in together["paths"]:
            return f"{mark}{commonprefix(together['paths'])}*"
    patterns = (pattern for of in get_args(Of) for pattern in campaign.get(of, ()))
    return mark + next((pattern for pattern in patterns if fnmatchcase(path, pattern)), path)
