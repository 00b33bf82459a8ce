"""Which dispersed quantities belong together: those of one path with a wildcard, and those drawn as
correlated.  Groups are independent of each other.
"""

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase
from os.path import commonprefix
from typing import Any, get_args

from edl6dof.campaign.design.case import BELIEF, TRUTH, Of


def group_of(column: str, campaign: Mapping[str, Any]) -> str:
    """Name of the group of a dispersed quantity; a lone one is its own, by its path.

    Args:
        column: of the results, such as ``truth.wind.scale``; what the flight computer is told keeps its mark.
        campaign: the campaign section as plain data.
    """
    mark = BELIEF if column.startswith(BELIEF) else ""
    path = column.removeprefix(BELIEF).removeprefix(TRUTH)
    for together in campaign.get("correlated", ()):
        if path in together["paths"]:
            return f"{mark}{commonprefix(together['paths'])}*"
    patterns = (pattern for of in get_args(Of) for pattern in campaign.get(of, ()))
    return mark + next((pattern for pattern in patterns if fnmatchcase(path, pattern)), path)
