"""Columns of a campaign's rows that hold the changes of a case, and the groups of dispersed quantities."""

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase
from os.path import commonprefix
from typing import Any, Literal, get_args

#: A change of the truth alone, of the flight computer's belief alone, or of both.
Of = Literal["truth", "belief", "both"]

#: Prefixes of the columns that hold what was changed.
TRUTH, BELIEF = "truth.", "belief."

#: Columns of the matrix and row of a case in a design of Sobol indices; names of the two matrices.
MATRIX, ROW = "matrix", "row"
A, B = "A", "B"


def group_of(column: str, campaign: Mapping[str, Any]) -> str:
    """Return the name of the group of a dispersed quantity.

    The quantities of one path with a wildcard form a group, and so do quantities drawn with a correlation.
    Groups are independent of each other.  Any other quantity is a group of one, named by its path.

    Args:
        column: column of the results, such as ``truth.wind.scale``; the group name keeps the prefix of
            belief.
        campaign: the campaign section as plain data.
    """
    mark = BELIEF if column.startswith(BELIEF) else ""
    path = column.removeprefix(BELIEF).removeprefix(TRUTH)
    for together in campaign.get("correlated", ()):
        if path in together["paths"]:
            return f"{mark}{commonprefix(together['paths'])}*"
    patterns = (pattern for of in get_args(Of) for pattern in campaign.get(of, ()))
    return mark + next((pattern for pattern in patterns if fnmatchcase(path, pattern)), path)


def is_constant(column: str, campaign: Mapping[str, Any]) -> bool:
    """Return whether a dispersed quantity, named by its column, is constant but unknown (epistemic)."""
    path = column.removeprefix(BELIEF).removeprefix(TRUTH)
    return any(fnmatchcase(path, pattern) for pattern in campaign.get("constant", ()))
