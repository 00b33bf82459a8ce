"""How far the estimated state was from the truth at the moments that count."""

from __future__ import annotations

import numpy as np

from edl6dof.spatial.arrays import lengths, total
from edl6dof.telemetry.columns import Telemetry

_POSITION = ("nav.error_north_m", "nav.error_east_m", "nav.error_down_m")
_VELOCITY = ("nav.error_v_north_m_s", "nav.error_v_east_m_s", "nav.error_v_down_m_s")
#: A rotation about the vertical leaves the vertical where it is.
_VERTICAL = ("nav.error_attitude_north_deg", "nav.error_attitude_east_deg")
_ATTITUDE = (*_VERTICAL, "nav.error_attitude_down_deg")


def navigation_figures(telemetry: Telemetry, when: dict[str, float]) -> dict[str, float]:
    """Errors of the estimate at mortar fire, ignition, backshell release and just before touchdown, as far as
    the flight came.

    Args:
        telemetry: its rows.
        when: time (s) of its events by key, see :func:`edl6dof.telemetry.timeline.first_times`.
    """
    figures: dict[str, float] = {}
    if (t := when.get("mortar")) is not None:
        figures["parachute_nav_position_m"] = _length(telemetry.at(t, *_POSITION))
    if (t := when.get("backshell")) is not None:
        figures["backshell_nav_attitude_deg"] = _length(telemetry.at(t, *_ATTITUDE))
        figures["backshell_told_height_m"] = total(telemetry.at(t, "truth.height_m", "nav.error_height_m"))
    if (t := when.get("ignition")) is not None:
        figures.update(_height_and_velocity("ignition", telemetry, t))
    if (t := when.get("touchdown")) is not None:
        # the estimate is a reading old: where contact shakes the vehicle, it has not seen that yet
        t = float(telemetry.beside(t)["t_s"][0])
        figures.update(_height_and_velocity("touchdown", telemetry, t))
        figures["touchdown_nav_vertical_deg"] = _length(telemetry.at(t, *_VERTICAL))
    return figures


def _height_and_velocity(moment: str, telemetry: Telemetry, t: float) -> dict[str, float]:
    (height,) = telemetry.at(t, "nav.error_height_m")
    return {
        f"{moment}_nav_height_m": height,
        f"{moment}_nav_velocity_m_s": _length(telemetry.at(t, *_VELOCITY)),
    }


def _length(components: list[float]) -> float:
    return float(lengths(np.array(components)))
