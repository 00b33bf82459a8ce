"""Heading alignment: near the end the range control stops, and the bank angle takes out the heading error.

Source: Mendeck & Craig McGrew 2014, "Entry guidance design and postflight performance for 2011 Mars Science
Laboratory mission".
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import atan2
from edl6dof.spatial.vector import clamp


class HeadingAlignmentParams(Params):
    """Heading alignment: below a speed, bank against the heading error instead of controlling range."""

    speed_m_s: float = param(0.0, "speed below which it takes over; 0 for never", ge=0.0)
    gain: float = param(20.0, "bank angle per heading error", ge=0.0, le=1000.0)
    limit_deg: float = param(30.0, "largest bank angle it commands", ge=0.0, le=90.0)


@kernel
def heading_bank(p, range_to_go, crossrange):
    """Bank angle (rad) against the heading error, the angle at the vehicle between its velocity and the aim
    point, by its range and crossrange (m); ``p`` are the settings of heading alignment.
    """
    return clamp(-p.gain * atan2(crossrange, max(range_to_go, 1.0)), -p.limit, p.limit)
