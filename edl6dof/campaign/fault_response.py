"""Effects of faults on a flight, and the response of the flight computer: columns of a row of a fault
matrix.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import Collect
from edl6dof.interface.effectors import ThrusterFailure
from edl6dof.metrics.out_of_use import failed_instruments, failed_thrusters
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.vehicle.faults.component import INSTRUMENTS, Component
from edl6dof.vehicle.faults.fault import FaultParams, about
from edl6dof.vehicle.plant import NOT_BEGUN

#: Regimes: until backshell release, and from then on; a fault that did not begin before touchdown.
AIR, POWERED, NOT_BEGUN_YET = "air", "powered", "not begun"
#: The failure of a thruster that has an effect without a command.
_OPEN: ThrusterFailure = "stuck_on"


@dataclass(frozen=True)
class Failure:
    """A failed component, and the kind of failure (``None`` for an instrument)."""

    component: Component
    name: str
    kind: str | None


@dataclass(frozen=True)
class Isolation:
    """Time at which the flight computer isolated a component, and the failure that it names."""

    failure: Failure
    t_s: float

    @property
    def label(self) -> str:
        """Text such as ``D7 stuck_off``, ``gyro g3`` or ``star_tracker``."""
        one = self.failure
        if one.kind:
            return f"{one.name} {one.kind}"
        return one.name if one.name == one.component else f"{one.component} {one.name}"

    def names(self, failure: Failure) -> bool:
        """Return whether the isolated component is the one that failed."""
        return (self.failure.component, self.failure.name) == (failure.component, failure.name)


def collected(plan: Plan) -> Collect | None:
    """Return the function that adds the columns of a fault matrix to a row, ``None`` for other plans."""
    return fault_response if plan.fault_matrix is not None else None


def isolations(flight: Flight) -> list[Isolation]:
    """Return the components that the flight computer isolated, in the order of time."""
    found = [
        Isolation(Failure("thruster", one.thruster, one.kind.replace(" ", "_")), one.t_s)
        for one in flight.isolated_faults
    ]
    lost = [one for one in flight.exclusions if not one.back]
    found += [Isolation(Failure(one.component, one.instrument, None), one.t_s) for one in lost]
    return sorted(found, key=lambda one: one.t_s)


def failures(fault: FaultParams, truth: Scenario) -> list[Failure]:
    """Return the failures to isolate for a fault: its component, every thruster that a dead branch feeds, or
    every beam of a dead radar.

    If the feed of all thrusters is weak, none need be isolated, but to isolate one as degraded is not wrong.
    """
    if fault.component in ("thruster", "branch"):
        return _thrusters(fault, truth)
    if fault.component in INSTRUMENTS:
        failed = failed_instruments(fault, truth.components, truth.sensors.radar.radars)
        return [Failure(component, name, None) for component, name in failed]
    return [Failure(fault.component, fault.acts_on(truth.components), fault.kind)]


def _thrusters(fault: FaultParams, truth: Scenario) -> list[Failure]:
    """Every thruster that a fault makes fail, with its kind of failure."""
    names = failed_thrusters(fault, truth.components, truth.branches)
    return [Failure("thruster", name, about(fault.kind).failure) for name in names]


#: Columns of :func:`fault_response`, in their order.
_COLUMNS = (
    *("fault_s", "first_use_s", "used_s", "regime", "named", "name_right", "kind_right", "isolation_s"),
    *("isolation_from_use_s", "wrongly_named", "sound_named", "peak_attitude_error_deg"),
)


def fault_response(flight: Flight) -> Mapping[str, Any]:
    """Return the response of a flight to faults that begin at one moment.

    ``fault_s``: time of the fault, null if the flight was over before.  ``first_use_s``: time from which all
    failed components have fired, leaked or been read during the fault, null if one was not: nothing can
    reveal it.  ``used_s``: shortest time in use of a failed component.  ``isolation_s`` and
    ``isolation_from_use_s``: time from the fault, and from the first use, to the isolation of the last failed
    component, null if one was not isolated.  ``kind_right``: true if all are isolated with the right kind.
    ``wrongly_named``: isolated components that are sound, had not failed yet, or have another kind of
    failure; ``sound_named``: these without the last group.  ``regime``: air or powered, at the first use, or
    at the fault if a component was not used.  ``peak_attitude_error_deg``: largest error of pitch and yaw
    control between fault and touchdown.
    """
    truth, named = flight.loaded.truth, isolations(flight)
    begun = list(zip(truth.faults, map(float, flight.plant["fault_since"][0]), strict=False))
    failed = [
        (failure, since, since + fault.lasts_s)
        for fault, since in begun
        for failure in failures(fault, truth)
    ]
    true = [
        (one, since) for fault, since in begun for one in (*failures(fault, truth), *_thrusters(fault, truth))
    ]
    wrong = [one for one in named if not _is_right(one, true)]
    end = flight.figures.get("touchdown_s", flight.time_s)
    sound = [one for one in wrong if not any(one.names(f) and one.t_s >= since for f, since in true)]
    row: dict[str, Any] = dict.fromkeys(_COLUMNS) | {"regime": NOT_BEGUN_YET}
    row |= {"name_right": False, "kind_right": False}
    for column, some in (("named", named), ("wrongly_named", wrong), ("sound_named", sound)):
        row[column] = ", ".join(one.label for one in some) or None
    if any(since == NOT_BEGUN or since >= end for _, since, _ in failed):
        return row
    return row | _response(flight, failed, named, end)


def _is_right(isolation: Isolation, true: Iterable[tuple[Failure, float]]) -> bool:
    """Return whether an isolation names a failure that has begun; saturation of all gyros isolates none."""
    return isolation.failure.component == "inertial_unit" or any(
        isolation.failure == failure and isolation.t_s >= since for failure, since in true
    )


def _response(
    flight: Flight, failed: Sequence[tuple[Failure, float, float]], named: Sequence[Isolation], end: float
) -> dict[str, Any]:
    """The columns about failures that have all begun, each given with the times of its begin and end (s)."""
    table, since = flight.telemetry, min(since for _, since, _ in failed)
    t, powered_s = table["t_s"], flight.figures.get("backshell_s", inf)
    step = float(t[1] - t[0]) if len(t) > 1 else 0.0
    used, used_s, isolated, kind_right = -inf, inf, -inf, True
    for failure, began, over in failed:
        uses = t[(t >= began) & (t < min(end, over)) & _in_use(flight, failure)]
        about = [one for one in named if one.names(failure) and one.t_s >= began]
        right = [one for one in about if one.failure == failure]
        used, used_s = max(used, float(uses[0]) if len(uses) else inf), min(used_s, len(uses) * step)
        isolated = max(isolated, next((one.t_s for one in [*right, *about]), inf))
        kind_right &= bool(right)
    after = (t >= since) & (t < end)
    error = np.hypot(table["control.error_pitch_deg"][after], table["control.error_yaw_deg"][after])
    return {
        "fault_s": since,
        "first_use_s": used if used < inf else None,
        "used_s": used_s,
        "regime": AIR if (used if used < inf else since) < powered_s else POWERED,
        "name_right": isolated < inf,
        "kind_right": kind_right,
        "isolation_s": isolated - since if isolated < inf else None,
        "isolation_from_use_s": max(isolated - used, 0.0) if max(isolated, used) < inf else None,
        "peak_attitude_error_deg": float(error.max()) if after.any() else None,
    }


def _in_use(flight: Flight, failure: Failure) -> np.ndarray:
    """Rows of telemetry in which the failed component is used or leaks, shape (rows,), bool."""
    table = flight.telemetry
    if failure.component == "thruster" and failure.kind != _OPEN:
        return table[f"valve.{failure.name}"] != 0
    if failure.component == "rcs":
        return np.any([table[f"valve.{name}"] != 0 for name in flight.scenario.thruster_names], axis=0)
    if failure.component == "beam":
        return table["nav.beams_used"] != 0
    if failure.component == "star_tracker":
        return table["truth.altitude_m"] >= flight.scenario.sensors.star_tracker.lowest_m
    return np.ones(len(table["t_s"]), bool)
