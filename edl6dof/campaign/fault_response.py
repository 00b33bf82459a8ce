"""What faults did to a flight, and what the flight computer made of them: columns of a row of a fault
matrix.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.rows import Collect
from edl6dof.metrics.diagnosis import failed_thrusters
from edl6dof.sim.flight import Flight
from edl6dof.vehicle.faults.component import Component
from edl6dof.vehicle.faults.fault import FaultParams
from edl6dof.vehicle.plant import NOT_BEGUN

#: Until the backshell is released, and from then on.
AIR, POWERED = "air", "powered"


@dataclass(frozen=True)
class Verdict:
    """A component that the flight computer took out of use.

    Attributes:
        component: kind of component.
        name: its name.
        kind: what is said to be wrong with it, as a kind of fault; of instruments nothing is said.
        t_s: when.
    """

    component: Component
    name: str
    kind: str | None
    t_s: float

    @property
    def label(self) -> str:
        """``D7 stuck_off``, ``g3``."""
        return f"{self.name} {self.kind}" if self.kind else self.name


@dataclass(frozen=True)
class _Finding:
    """One fault that began: when, its first use from then on if there was any, and the verdict on it."""

    since: float
    first_use: float | None
    used_s: float
    verdict: Verdict | None
    kind_right: bool


def collected(plan: Plan) -> Collect | None:
    """What the rows of a plan say beyond the figures of every flight."""
    return fault_response if plan.fault_matrix is not None else None


#: What thrusters are to be called that fail with the feed of several.
_KINDS_OF_SEVERAL = {"branch_dead": "stuck_off", "weak_thrusters": "degraded"}


def verdicts(flight: Flight) -> list[Verdict]:
    """Whom the flight computer named, in the order of time; that all gyros saturate is a verdict on none."""
    found = [Verdict("thruster", one.thruster, one.kind.replace(" ", "_"), one.t_s)
             for one in flight.isolated_faults]  # fmt: skip
    found += [Verdict(one.component, one.instrument, None, one.t_s)
              for one in flight.exclusions if not one.back]  # fmt: skip
    return sorted(found, key=lambda one: one.t_s)


def fault_response(flight: Flight) -> Mapping[str, Any]:
    """What happened to a flight with faults that begin at one moment.

    ``fault_s``: time of the fault, null if the flight was over before.  ``first_use_s``: time from which all
    that failed has fired, leaked or been read since the fault, null if some was not: nobody can know of it.
    ``used_s``: for how long, of the one that was used least.  ``verdict_s`` and ``verdict_from_use_s``: time
    from the fault, and from the first use, to the verdict on the last of them, null if one was not named.
    ``kind_right``: all named with the right kind.  ``wrongly_named``: sound components, those named before
    they failed, and those named with a wrong kind.  ``regime``: air or powered, at the first use, or
    else at the fault.  ``peak_attitude_error_deg``: largest error of pitch and yaw control between fault and
    touchdown.
    """
    named, faults = verdicts(flight), flight.loaded.truth.faults
    begun = flight.plant["fault_since"][0][: len(faults)]
    end = flight.metrics.get("touchdown_s", flight.time_s)
    found = [
        _finding(flight, fault, float(since), end, named)
        for fault, since in zip(faults, begun, strict=True)
        if since != NOT_BEGUN and since < end
    ]
    wrong = [one for one in named if not _is_right(one, flight, begun)]
    row: dict[str, Any] = {
        "fault_s": None,
        "first_use_s": None,
        "used_s": None,
        "regime": None,
        "named": ", ".join(one.label for one in named) or None,
        "name_right": False,
        "kind_right": False,
        "verdict_s": None,
        "verdict_from_use_s": None,
        "wrongly_named": ", ".join(one.label for one in wrong) or None,
        "peak_attitude_error_deg": None,
    }
    return row | _findings(flight, found, end) if len(found) == len(faults) else row


def _findings(flight: Flight, found: Sequence[_Finding], end: float) -> dict[str, Any]:
    """The columns about faults that have all begun."""
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


def _finding(
    flight: Flight, fault: FaultParams, since: float, end: float, named: Sequence[Verdict]
) -> _Finding:
    t = flight.telemetry["t_s"]
    used = (t >= since) & (t < end) & _in_use(flight, fault)
    first = float(t[used][0]) if used.any() else None
    about = [one for one in named if _is_about(one, flight, fault) and one.t_s >= since]
    right = [one for one in about if _has_kind(one, fault)]
    verdict = next(iter([*right, *about]), None)
    return _Finding(since, first, float(used.sum()) * _step(t), verdict, bool(right))


def _step(t: np.ndarray) -> float:
    """Time between rows of telemetry, s."""
    return float(t[1] - t[0]) if len(t) > 1 else 0.0


def _is_right(verdict: Verdict, flight: Flight, begun: np.ndarray) -> bool:
    """Whether a verdict names what has failed, with the kind of its fault; saturated gyros blame none."""
    return verdict.component == "inertial_unit" or any(
        _is_about(verdict, flight, fault) and _has_kind(verdict, fault) and verdict.t_s >= since
        for fault, since in zip(flight.loaded.truth.faults, begun, strict=True)
    )


def _is_about(verdict: Verdict, flight: Flight, fault: FaultParams) -> bool:
    """Whether a verdict names what fails by a fault, or one of the thrusters that fail by it."""
    truth = flight.loaded.truth
    if verdict.component == "thruster":
        return verdict.name in failed_thrusters(fault, truth.components, truth.branches)
    return (verdict.component, verdict.name) == (fault.component, fault.acts_on(truth.components))


def _has_kind(verdict: Verdict, fault: FaultParams) -> bool:
    """Whether a verdict tells the kind of a fault, if it tells any."""
    return verdict.kind in (None, _KINDS_OF_SEVERAL.get(fault.kind, fault.kind))


def _in_use(flight: Flight, fault: FaultParams) -> np.ndarray:
    """Rows of telemetry in which what fails is used or leaks, shape (rows,), bool."""
    table = flight.telemetry
    truth = flight.loaded.truth
    failing = failed_thrusters(fault, truth.components, truth.branches)
    if failing and fault.kind != "stuck_on":
        return np.any([table[f"valve.{name}"] != 0 for name in failing], axis=0)
    if fault.component == "beam":
        return table["nav.beams_used"] != 0
    if fault.component == "star_tracker":
        return table["truth.altitude_m"] >= flight.scenario.sensors.star_tracker.lowest_m
    return np.ones(len(table["t_s"]), bool)
