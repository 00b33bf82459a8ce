"""Effects of faults on a flight, and the response of the flight computer: columns of a row of a fault
matrix.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import Collect
from edl6dof.interface.effectors import ThrusterFailure
from edl6dof.metrics.out_of_use import failed_thrusters
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.vehicle.faults.component import INSTRUMENTS, Component
from edl6dof.vehicle.faults.fault import FaultParams, about
from edl6dof.vehicle.plant import NOT_BEGUN

#: Until the backshell is released, and from then on; of a fault that did not begin before touchdown.
AIR, POWERED, NOT_BEGUN_YET = "air", "powered", "not begun"
#: The failure of a thruster that shows without a command.
_OPEN: ThrusterFailure = "stuck_on"


@dataclass(frozen=True)
class Failure:
    """A failed component, and the kind that a correct isolation names (``None`` for an instrument)."""

    component: Component
    name: str
    kind: str | None


@dataclass(frozen=True)
class Isolation:
    """A component that the flight computer took out of use, and why, in the same words; ``t_s``: when."""

    failure: Failure
    t_s: float

    @property
    def label(self) -> str:
        """``D7 stuck_off``, ``gyro g3``, ``star_tracker``."""
        one = self.failure
        if one.kind:
            return f"{one.name} {one.kind}"
        return one.name if one.name == one.component else f"{one.component} {one.name}"

    def names(self, failure: Failure) -> bool:
        """Return whether it is about the component that failed."""
        return (self.failure.component, self.failure.name) == (failure.component, failure.name)


@dataclass(frozen=True)
class _Response:
    """One failure that began: when, its first use from then on if there was any, and its isolation."""

    since: float
    first_use: float | None
    used_s: float
    isolation: Isolation | None
    kind_right: bool


def collected(plan: Plan) -> Collect | None:
    """Return the columns of a plan's rows beyond the figures of every flight."""
    return fault_response if plan.fault_matrix is not None else None


def isolations(flight: Flight) -> list[Isolation]:
    """Return the components that the flight computer isolated, in the order of time."""
    found = [
        (Failure("thruster", one.thruster, one.kind.replace(" ", "_")), one.t_s)
        for one in flight.isolated_faults
    ]
    lost = [one for one in flight.exclusions if not one.back]
    found += [(Failure(one.component, one.instrument, None), one.t_s) for one in lost]
    return sorted((Isolation(*one) for one in found), key=lambda one: one.t_s)


def failures(fault: FaultParams, truth: Scenario) -> list[Failure]:
    """Return what is to be isolated for a fault: its component; of a dead branch, every thruster behind it.

    A weak feed of all thrusters is isolated in none of them; to call one degraded is not wrong.
    """
    if fault.component in ("thruster", "branch"):
        return _thrusters(fault, truth)
    said = None if fault.component in INSTRUMENTS else fault.kind
    return [Failure(fault.component, fault.acts_on(truth.components), said)]


def _thrusters(fault: FaultParams, truth: Scenario) -> list[Failure]:
    """Every thruster that a fault makes fail."""
    names = failed_thrusters(fault, truth.components, truth.branches)
    return [Failure("thruster", name, about(fault.kind).failure) for name in names]


#: Columns of :func:`fault_response`, in their order.
_COLUMNS = (
    *("fault_s", "first_use_s", "used_s", "regime", "named", "name_right", "kind_right", "isolation_s"),
    *("isolation_from_use_s", "wrongly_named", "sound_named", "peak_attitude_error_deg"),
)


def fault_response(flight: Flight) -> Mapping[str, Any]:
    """Return what happened to a flight with faults that begin at one moment.

    ``fault_s``: time of the fault, null if the flight was over before.  ``first_use_s``: time from which all
    that failed has fired, leaked or been read since the fault, null if some was not, since nothing can reveal
    it. ``used_s``: for how long, of the one that was used least.  ``isolation_s`` and
    ``isolation_from_use_s``: time from the fault, and from the first use, to the isolation of the last of
    them, null if one was not named. ``kind_right``: all named with the right kind.  ``wrongly_named``: sound
    components, those named before they failed, and those named with a wrong kind; ``sound_named`` without the
    last.  ``regime``: air or powered, at the first use, or else at the fault, if that began.
    ``peak_attitude_error_deg``: largest error of pitch and yaw control between fault and touchdown.
    """
    truth, named = flight.loaded.truth, isolations(flight)
    begun = list(zip(truth.faults, map(float, flight.plant["fault_since"][0]), strict=False))
    failed = [(failure, since) for fault, since in begun for failure in failures(fault, truth)]
    true = [
        (one, since) for fault, since in begun for one in (*failures(fault, truth), *_thrusters(fault, truth))
    ]
    wrong = [one for one in named if not _is_right(one, true)]
    end = flight.metrics.get("touchdown_s", flight.time_s)
    sound = [one for one in wrong if not _has_failed(one, true)]
    row: dict[str, Any] = dict.fromkeys(_COLUMNS) | {"regime": NOT_BEGUN_YET}
    row |= {"name_right": False, "kind_right": False}
    for column, some in (("named", named), ("wrongly_named", wrong), ("sound_named", sound)):
        row[column] = ", ".join(one.label for one in some) or None
    if any(since == NOT_BEGUN or since >= end for _, since in failed):
        return row
    return row | _columns(flight, [_response(flight, *one, end, named) for one in failed], end)


def _is_right(isolation: Isolation, true: Iterable[tuple[Failure, float]]) -> bool:
    """Return whether an isolation says what has failed; that all gyros saturate isolates none."""
    return isolation.failure.component == "inertial_unit" or any(
        isolation.failure == failure and isolation.t_s >= since for failure, since in true
    )


def _has_failed(isolation: Isolation, true: Iterable[tuple[Failure, float]]) -> bool:
    """Return whether an isolation is about a component that has failed by then, in whatever way."""
    return any(isolation.names(failure) and isolation.t_s >= since for failure, since in true)


def _response(
    flight: Flight, failure: Failure, since: float, end: float, named: Sequence[Isolation]
) -> _Response:
    t = flight.telemetry["t_s"]
    used = (t >= since) & (t < end) & _in_use(flight, failure)
    first = float(t[used][0]) if used.any() else None
    about = [one for one in named if one.names(failure) and one.t_s >= since]
    right = [one for one in about if one.failure == failure]
    isolation = next(iter([*right, *about]), None)
    step = float(t[1] - t[0]) if len(t) > 1 else 0.0
    return _Response(since, first, float(used.sum()) * step, isolation, bool(right))


def _columns(flight: Flight, found: Sequence[_Response], end: float) -> dict[str, Any]:
    """The columns about failures that have all begun."""
    since = min(one.since for one in found)
    uses = [one.first_use for one in found if one.first_use is not None]
    used = max(uses) if len(uses) == len(found) else None
    given = [one.isolation.t_s for one in found if one.isolation is not None]
    last = max(given) if len(given) == len(found) else None
    table = flight.telemetry
    after = (table["t_s"] >= since) & (table["t_s"] < end)
    error = np.hypot(table["control.error_pitch_deg"][after], table["control.error_yaw_deg"][after])
    powered_s = flight.metrics.get("backshell_s", np.inf)
    return {
        "fault_s": since,
        "first_use_s": used,
        "used_s": min(one.used_s for one in found),
        "regime": AIR if (since if used is None else used) < powered_s else POWERED,
        "name_right": last is not None,
        "kind_right": all(one.kind_right for one in found),
        "isolation_s": None if last is None else last - since,
        "isolation_from_use_s": None if last is None or used is None else max(last - used, 0.0),
        "peak_attitude_error_deg": float(error.max()) if after.any() else None,
    }


def _in_use(flight: Flight, failure: Failure) -> np.ndarray:
    """Rows of telemetry in which what fails is used or leaks, shape (rows,), bool."""
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
