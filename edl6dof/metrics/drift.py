"""How near backshell and canopy came to the lander once they had parted, between rows as well."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from edl6dof.interface.roles import HOVER_IMAGING, begun
from edl6dof.spatial.arrays import lengths

_AXES = ("east", "north", "up")
#: Seconds after ignition from which backshell and lander count as parted.
PARTED_S = 5.0


def drift_figures(
    telemetry: Mapping[str, np.ndarray], when: Mapping[str, float], line_m: float
) -> dict[str, float]:
    """Least distance of the lander from backshell and canopy after they have parted; and from hover on, how
    far aside of the lander what is above it passes.

    The canopy is the point ``line_m`` above the backshell that hangs from it.  Between two rows both move on
    straight lines.

    Args:
        telemetry: channels of a flight.
        when: time (s) of its events by key.
        line_m: from the backshell to the canopy, m.
    """
    if "ignition" not in when or "backshell" not in when:
        return {}
    t = telemetry["t_s"]
    last = t <= when.get("touchdown", np.inf)
    off = np.column_stack(
        [telemetry[f"truth.backshell_{axis}_m"] - telemetry[f"truth.site_{axis}_m"] for axis in _AXES]
    )
    parted = last & (t >= when["ignition"] + PARTED_S)
    figures = {}
    if np.count_nonzero(parted) > 1:
        figures["min_drift_distance_m"] = min(
            least_length(off[parted] + (0.0, 0.0, h)) for h in (0.0, line_m)
        )
    hovering = last & (t >= when.get(begun(HOVER_IMAGING), np.inf)) & (off[:, 2] + line_m > 0.0)
    if np.count_nonzero(hovering) > 1:
        figures["min_overhead_m"] = least_length(off[hovering, :2])
    return figures


def least_length(way: np.ndarray) -> float:
    """Least length of a vector, rows of ``way``, that moves on straight lines from row to row."""
    start, step = way[:-1], np.diff(way, axis=0)
    share = -np.sum(start * step, axis=1) / np.maximum(np.sum(step * step, axis=1), 1e-30)
    return float(np.min(lengths(start + np.clip(share, 0.0, 1.0)[:, None] * step)))
