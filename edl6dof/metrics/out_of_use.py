"""Thrusters and instruments that the flight computer took out of use, compared with their true faults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from edl6dof.fsw.diagnosis.diagnose import KIND_NAMES
from edl6dof.fsw.navigation.exclusions import ACCELEROMETERS, BEAMS, GYROS, INERTIAL_UNIT, STAR_TRACKER
from edl6dof.vehicle.faults.component import INSTRUMENTS, Component, Components
from edl6dof.vehicle.faults.fault import FaultParams, about
from edl6dof.vehicle.plant import NOT_BEGUN


@dataclass(frozen=True)
class IsolatedFault:
    """A thruster fault that the flight computer isolated; only a degraded thruster stays in use."""

    thruster: str
    kind: str  # stuck off, stuck on, degraded
    confidence: float  # posterior probability, 0 to 1
    loss: float  # fraction of its thrust lost (0 for stuck on)
    t_s: float

    @property
    def label(self) -> str:
        """``D7 stuck off, confidence 0.9998``, rounded down."""
        shown = np.floor(self.confidence * 1e4) / 1e4
        return f"{self.thruster} {self.kind}, confidence {shown:.4f}"


def isolated_faults(fsw: np.void, thrusters: Sequence[str]) -> list[IsolatedFault]:
    """Isolated faults in the order of time."""
    diagnosis = fsw["diagnosis"]
    return [
        IsolatedFault(
            thrusters[slot["thruster"]],
            KIND_NAMES[int(slot["kind"])],
            *(float(slot[name]) for name in ("confidence", "loss", "t")),
        )
        for slot in diagnosis["isolated"][: diagnosis["n_isolated"]]
    ]


def failed_thrusters(
    fault: FaultParams, components: Components, branches: Mapping[str, Sequence[str]]
) -> Sequence[str]:
    """Names of the thrusters that a fault makes fail: one, those of a branch, all, or none."""
    if fault.component == "branch":
        return branches[fault.acts_on(components)]
    if fault.component == "rcs":
        return components["thruster"]
    return [fault.acts_on(components)] if fault.component == "thruster" else []


def diagnosis_figures(
    isolated: Sequence[IsolatedFault],
    faults: Sequence[FaultParams],
    components: Components,
    branches: Mapping[str, Sequence[str]],
    plant: np.void,
) -> dict[str, float]:
    """Return the numbers of false alarms (isolations of a healthy thruster or with a wrong kind of fault) and
    of failed thrusters that were not isolated, and the time (s) from the first thruster fault to the right
    isolation, if there was one. ``branches``: thrusters of each propellant branch.
    """
    since: dict[tuple[str, str], float] = {}
    for fault, t in _begun(faults, plant):
        for name in failed_thrusters(fault, components, branches):
            what = name, str(about(fault.kind).failure).replace("_", " ")
            since[what] = min(t, since.get(what, np.inf))
    right = [one for one in isolated if one.t_s >= since.get((one.thruster, one.kind), np.inf)]
    figures = {"false_alarms": float(len(isolated) - len(right))}
    if since:
        found = {(one.thruster, one.kind) for one in right}
        figures["missed_isolations"] = float(len(since.keys() - found))
    if right:
        figures["time_to_detect_s"] = right[0].t_s - since[right[0].thruster, right[0].kind]
    return figures


def _begun(faults: Sequence[FaultParams], plant: np.void) -> list[tuple[FaultParams, float]]:
    """Faults that have begun, and their times (s)."""
    times = zip(faults, plant["fault_since"].tolist(), strict=False)
    return [(fault, t) for fault, t in times if t != NOT_BEGUN]


#: Index of the first instrument of each kind among all that navigation may take out of use, last kind first.
_FIRST: dict[Component, int] = {
    "inertial_unit": INERTIAL_UNIT,
    "star_tracker": STAR_TRACKER,
    "beam": BEAMS,
    "accelerometer": ACCELEROMETERS,
    "gyro": GYROS,
}


@dataclass(frozen=True)
class Exclusion:
    """An instrument that went out of use, or came back."""

    component: Component  # inertial_unit if all gyros are at the end of their range
    instrument: str
    back: bool
    t_s: float

    @property
    def label(self) -> str:
        """``gyro g3 excluded``, ``beam b2 back in use``, ``gyros saturated``."""
        if self.component == "inertial_unit":
            return "gyros read again" if self.back else "gyros saturated"
        kind = self.component.replace("_", " ")
        name = kind if self.instrument == self.component else f"{kind} {self.instrument}"
        return f"{name} {'back in use' if self.back else 'excluded'}"


def exclusions(fsw: np.void, components: Components) -> list[Exclusion]:
    """Instruments that went out of use and came back, in the order of time."""
    log = fsw["navigation"]["exclusions"]
    found = []
    for change in log["changes"][: log["n_changes"]]:
        kind = next(kind for kind, first in _FIRST.items() if change["number"] >= first)
        name = components[kind][int(change["number"]) - _FIRST[kind]]
        found.append(Exclusion(kind, name, bool(change["back"]), float(change["t"])))
    meters = fsw["diagnosis"]["flow"]
    found += [
        Exclusion("flow_meter", name, False, float(t))
        for name, failed, t in zip(
            components["branch"], meters["meter_failed"], meters["failed_at"], strict=False
        )
        if failed
    ]
    return sorted(found, key=lambda one: one.t_s)


def failed_instruments(
    fault: FaultParams, components: Components, radars: Mapping[str, Sequence[str]]
) -> list[tuple[Component, str]]:
    """Kinds and names of the instruments that a fault makes fail: one, all beams of a radar, or none;
    ``radars``: beams of each radar.
    """
    name = fault.acts_on(components)
    if fault.component == "radar":
        return [("beam", beam) for beam in radars[name]]
    return [(fault.component, name)] if fault.component in INSTRUMENTS else []


def exclusion_figures(
    found: Sequence[Exclusion],
    faults: Sequence[FaultParams],
    components: Components,
    radars: Mapping[str, Sequence[str]],
    plant: np.void,
) -> dict[str, float]:
    """Return the number of healthy instruments excluded, and the time (s) from the first instrument fault
    that was found to its exclusion, if there was one; ``radars``: beams of each radar.
    """
    since = {
        one: t for fault, t in _begun(faults, plant) for one in failed_instruments(fault, components, radars)
    }
    out = [one for one in found if not one.back]
    right = [one for one in out if one.t_s >= since.get((one.component, one.instrument), np.inf)]
    # saturation of all gyros isolates none of them
    wrong = [one for one in out if one not in right and one.component != "inertial_unit"]
    figures = {"instrument_false_alarms": float(len(wrong))}
    if right:
        figures["time_to_exclude_s"] = right[0].t_s - since[right[0].component, right[0].instrument]
    return figures
