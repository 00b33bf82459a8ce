"""The figures that are an extreme over a part of the flight, declared once: which columns, and which part.

Figures of a flight are formed from this table (:mod:`edl6dof.metrics.evaluation`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf
from typing import Literal, NamedTuple

import numpy as np

from edl6dof.interface.roles import LIFT, PARACHUTE, span
from edl6dof.telemetry.columns import Telemetry

#: Seconds after the trim wing opens that count as its transient.
WING_TRANSIENT_S = 10.0
#: Seconds after engine ignition that count as the initial transient of roll.
ROLL_TRANSIENT_S = 8.0
#: Seconds after engine ignition from which backshell and vehicle count as separated.
SEPARATED_S = 5.0


class Part(NamedTuple):
    """Rows of a flight: those of the phases of a role, ``after_s`` or more (``later``: more) seconds after an
    event, and before another.  Events by their milestones, and ``touchdown``; without them the part begins
    and ends with the phases or the flight.
    """

    role: str = ""
    since: str = ""
    after_s: float = 0.0
    later: bool = False
    until: str = ""

    def rows(self, telemetry: Telemetry, when: Mapping[str, float], roles: Sequence[str]) -> Telemetry:
        """These rows of a flight, given the times (s) of its events and the roles of its phases."""
        if self.role:
            telemetry = telemetry.rows(*role_rows(telemetry, roles, self.role))
        times = telemetry["t_s"]
        first = 0
        if self.since:
            side: Literal["left", "right"] = "right" if self.later else "left"
            first = int(np.searchsorted(times, when.get(self.since, inf) + self.after_s, side=side))
        last = int(np.searchsorted(times, when.get(self.until, inf))) if self.until else None
        return telemetry.rows(first, last)


class Extreme(NamedTuple):
    """One figure.

    Attributes:
        kind: ``largest`` magnitude of all columns; ``longest`` vector of them; ``nearest`` two places, each
            of three columns, come; ``swing``: largest magnitude of the first, a rate, without its part that
            is banking, which follows from the second, the roll rate, and the third, an angle.
        columns: telemetry channels.
        part: rows over which it is taken.
    """

    kind: Literal["largest", "longest", "nearest", "swing"]
    columns: tuple[str, ...]
    part: Part

    def of(self, telemetry: Telemetry) -> float:
        """The figure over all rows of a telemetry, in the unit of its columns; ``nan`` of no rows."""
        if self.kind == "longest":
            return telemetry.longest(*self.columns)
        if self.kind == "nearest":
            return telemetry.nearest(self.columns[:3], self.columns[3:])
        return float(np.max(telemetry.largest(*self.columns)))


def role_rows(telemetry: Telemetry, roles: Sequence[str], role: str) -> tuple[int, int]:
    """First row of the phases of a role, none of which comes twice, and the row after their last."""
    first, end = np.searchsorted(telemetry["guide.phase"], span(roles, role)).tolist()
    return first, end


def _place(stem: str) -> tuple[str, ...]:
    return tuple(f"truth.{stem}_{axis}_m" for axis in ("east", "north", "up"))


_ROLL, _PITCH, _YAW = (f"truth.rate_{axis}_deg_s" for axis in "pqr")
_RATES = (_ROLL, _PITCH, _YAW)
_POWERED, _SETTLED, _SEPARATED = (
    Part(since="ignition", after_s=after, later=after > 0.0, until="touchdown")
    for after in (0.0, ROLL_TRANSIENT_S, SEPARATED_S)
)

#: By the name of the figure.
EXTREMES: dict[str, Extreme] = {
    "max_bank_rate_deg_s": Extreme("largest", (_ROLL,), Part(LIFT)),
    "max_rate_parachute_deg_s": Extreme("largest", _RATES, Part(PARACHUTE)),
    "max_rate_powered_deg_s": Extreme("largest", _RATES, _POWERED),
    "max_attitude_error_powered_deg": Extreme(
        "longest", ("control.error_pitch_deg", "control.error_yaw_deg"), _POWERED
    ),
    "max_disturbance_torque_nm": Extreme(
        "largest", tuple(f"truth.disturbance_{axis}_nm" for axis in "xyz"), _POWERED
    ),
    "max_estimated_torque_nm": Extreme(
        "largest", tuple(f"estimate.torque_{axis}_nm" for axis in "xyz"), _POWERED
    ),
    "max_roll_error_powered_deg": Extreme("largest", ("control.error_roll_deg",), _SETTLED),
    "min_backshell_distance_m": Extreme("nearest", (*_place("site"), *_place("backshell")), _SEPARATED),
}

#: Parts of lift control in which the swings of pitch and yaw count, and what they are.
CALM = (Part(LIFT, until="trim_wing"), Part(LIFT, since="trim_wing", after_s=WING_TRANSIENT_S))
SWINGS = ((_PITCH, _ROLL, "truth.beta_deg"), (_YAW, _ROLL, "truth.alpha_deg"))
