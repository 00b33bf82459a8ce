"""Which instruments the flight computer took out of use, beside what was truly wrong with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from edl6dof.fsw.navigation.exclusions import ACCELEROMETERS, BEAMS, GYROS, INERTIAL_UNIT, STAR_TRACKER
from edl6dof.vehicle.faults.component import INSTRUMENTS, Component, Components
from edl6dof.vehicle.faults.fault import FaultParams
from edl6dof.vehicle.plant import NOT_BEGUN

#: Number of the first instrument of each kind among all that navigation may take out of use, last kind first.
_FIRST: dict[Component, int] = {
    "inertial_unit": INERTIAL_UNIT,
    "star_tracker": STAR_TRACKER,
    "beam": BEAMS,
    "accelerometer": ACCELEROMETERS,
    "gyro": GYROS,
}


@dataclass(frozen=True)
class Exclusion:
    """An instrument that went out of use, or came back.

    Attributes:
        component: kind of instrument; the inertial unit for all gyros at the end of their range.
        instrument: its name.
        back: whether it came back.
        t_s: when.
    """

    component: Component
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
    """What went out of use and came back, in the order of time."""
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


def exclusion_figures(
    found: Sequence[Exclusion], faults: Sequence[FaultParams], components: Components, plant: np.void
) -> dict[str, float]:
    """Number of sound instruments excluded, and time from the first fault of an instrument that was found to
    its exclusion if there was one.
    """
    since = {
        (fault.component, fault.acts_on(components)): float(begun)
        for fault, begun in zip(faults, plant["fault_since"], strict=False)
        if fault.component in INSTRUMENTS and begun != NOT_BEGUN
    }
    out = [one for one in found if not one.back]
    right = [one for one in out if one.t_s >= since.get((one.component, one.instrument), np.inf)]
    # that all gyros saturate isolates none of them
    wrong = [one for one in out if one not in right and one.component != "inertial_unit"]
    figures = {"instrument_false_alarms": float(len(wrong))}
    if right:
        figures["time_to_exclude_s"] = right[0].t_s - since[right[0].component, right[0].instrument]
    return figures
