"""What faults did to a flight, and what the flight computer made of them: columns of a row of a fault
matrix.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.rows import Collect
from edl6dof.metrics.diagnosis import failed_thrusters, kind_of_failure
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.vehicle.faults.component import INSTRUMENTS, Component
from edl6dof.vehicle.faults.fault import FaultParams
from edl6dof.vehicle.plant import NOT_BEGUN

#: Until the backshell is released, and from then on; of a fault that did not begin before touchdown.
AIR, POWERED, NOT_BEGUN_YET = "air", "powered", "not begun"


@dataclass(frozen=True)
class Failure:
    """A component that fails, and what a right verdict says of it: nothing but its name of an instrument."""

    component: Component
    name: str
    kind: str | None


@dataclass(frozen=True)
class Verdict:
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
        """Whether it is about the component that failed."""
        return (self.failure.component, self.failure.name) == (failure.component, failure.name)


@dataclass(frozen=True)
class _Finding:
    """One failure that began: when, its first use from then on if there was any, and the verdict on it."""

    since: float
    first_use: float | None
    used_s: float
    verdict: Verdict | None
    kind_right: bool


def collected(plan: Plan) -> Collect | None:
    """What the rows of a plan say beyond the figures of every flight."""
    return fault_response if plan.fault_matrix is not None else None


def verdicts(flight: Flight) -> list[Verdict]:
    """Whom the flight computer named, in the order of time."""
    found = [
        Verdict(Failure("thruster", one.thruster, one.kind.replace(" ", "_")), one.t_s)
        for one in flight.isolated_faults
    ]
    found += [
        Verdict(Failure(one.component, one.instrument, None), one.t_s)
        for one in flight.exclusions
        if not one.back
    ]
    return sorted(found, key=lambda one: one.t_s)


def failures(fault: FaultParams, truth: Scenario) -> list[Failure]:
    """What is to be named where a fault happens: its component; of a dead branch, every thruster behind it.

    That the feed of all thrusters is weak is nobody's verdict; calling one of them degraded is not wrong.
    """
    if fault.component == "branch":
        return _thrusters(fault, truth)
    said = None if fault.component in INSTRUMENTS else fault.kind
    return [Failure(fault.component, fault.acts_on(truth.components), said)]


def _thrusters(fault: FaultParams, truth: Scenario) -> list[Failure]:
    """Every thruster that a fault makes fail."""
    kind = kind_of_failure(fault).replace(" ", "_")
    names = failed_thrusters(fault, truth.components, truth.branches)
    return [Failure("thruster", name, kind) for name in names]


def fault_response(flight: Flight) -> Mapping[str, Any]:
    """What happened to a flight with faults that begin at one moment.

    ``fault_s``: time of the fault, null if the flight was over before.  ``first_use_s``: time from which all
    that failed has fired, leaked or been read since the fault, null if some was not: nobody can know of it.
    ``used_s``: for how long, of the one that was used least.  ``verdict_s`` and ``verdict_from_use_s``: time
    from the fault, and from the first use, to the verdict on the last of them, null if one was not named.
    ``kind_right``: all named with the right kind.  ``wrongly_named``: sound components, those named before
    they failed, and those named with a wrong kind; ``sound_named`` without the last.  ``regime``: air or
    powered, at the first use, or else at the fault, if that began.  ``peak_attitude_error_deg``: largest
    error of pitch and yaw control between fault and touchdown.
    """
    truth, named = flight.loaded.truth, verdicts(flight)
    begun = list(zip(truth.faults, map(float, flight.plant["fault_since"][0]), strict=False))
    failed = [(failure, fault, since) for fault, since in begun for failure in failures(fault, truth)]
    true = [
        (one, since) for fault, since in begun for one in (*failures(fault, truth), *_thrusters(fault, truth))
    ]
    wrong = [one for one in named if not _is_right(one, true)]
    end = flight.metrics.get("touchdown_s", flight.time_s)
    row: dict[str, Any] = {
        "fault_s": None,
        "first_use_s": None,
        "used_s": None,
        "regime": NOT_BEGUN_YET,
        "named": _list(named),
        "name_right": False,
        "kind_right": False,
        "verdict_s": None,
        "verdict_from_use_s": None,
        "wrongly_named": _list(wrong),
        "sound_named": _list(one for one in wrong if not _has_failed(one, true)),
        "peak_attitude_error_deg": None,
    }
    if any(since == NOT_BEGUN or since >= end for _, _, since in failed):
        return row
    return row | _findings(flight, [_finding(flight, *one, end, named) for one in failed], end)


def _list(verdicts: Iterable[Verdict]) -> str | None:
    return ", ".join(one.label for one in verdicts) or None


def _is_right(verdict: Verdict, true: Iterable[tuple[Failure, float]]) -> bool:
    """Whether a verdict says what has failed by then; that all gyros saturate accuses none of them."""
    return verdict.failure.component == "inertial_unit" or any(
        verdict.failure == failure and verdict.t_s >= since for failure, since in true
    )


def _has_failed(verdict: Verdict, true: Iterable[tuple[Failure, float]]) -> bool:
    """Whether a verdict is about a component that has failed by then, in whatever way."""
    return any(verdict.names(failure) and verdict.t_s >= since for failure, since in true)


def _finding(
    flight: Flight, failure: Failure, fault: FaultParams, since: float, end: float, named: Sequence[Verdict]
) -> _Finding:
    t = flight.telemetry["t_s"]
    used = (t >= since) & (t < end) & _in_use(flight, failure, fault)
    first = float(t[used][0]) if used.any() else None
    about = [one for one in named if one.names(failure) and one.t_s >= since]
    right = [one for one in about if one.failure == failure]
    verdict = next(iter([*right, *about]), None)
    return _Finding(since, first, float(used.sum()) * _step(t), verdict, bool(right))


def _step(t: np.ndarray) -> float:
    """Time between rows of telemetry, s."""
    return float(t[1] - t[0]) if len(t) > 1 else 0.0


def _findings(flight: Flight, found: Sequence[_Finding], end: float) -> dict[str, Any]:
    """The columns about failures that have all begun."""
    since = min(one.since for one in found)
    uses = [one.first_use for one in found if one.first_use is not None]
    used = max(uses) if len(uses) == len(found) else None
    given = [one.verdict.t_s for one in found if one.verdict is not None]
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
        "verdict_s": None if last is None else last - since,
        "verdict_from_use_s": None if last is None or used is None else max(last - used, 0.0),
        "peak_attitude_error_deg": float(error.max()) if after.any() else None,
    }


def _in_use(flight: Flight, failure: Failure, fault: FaultParams) -> np.ndarray:
    """Rows of telemetry in which what fails is used or leaks, shape (rows,), bool."""
    table = flight.telemetry
    if failure.component == "thruster" and fault.kind != "stuck_on":
        return table[f"valve.{failure.name}"] != 0
    if failure.component == "rcs":
        return np.any([table[f"valve.{name}"] != 0 for name in flight.scenario.thruster_names], axis=0)
    if failure.component == "beam":
        return table["nav.beams_used"] != 0
    if failure.component == "star_tracker":
        return table["truth.altitude_m"] >= flight.scenario.sensors.star_tracker.lowest_m
    return np.ones(len(table["t_s"]), bool)
