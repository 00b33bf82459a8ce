"""What the flight computer found out about its thrusters, beside what was truly wrong with them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from edl6dof.fsw.diagnosis.diagnose import KIND_NAMES
from edl6dof.vehicle.faults import THRUSTER_KINDS, FaultParams
from edl6dof.vehicle.plant import NOT_BEGUN


@dataclass(frozen=True)
class Finding:
    """One verdict of the diagnosis: a thruster taken out of use.

    Attributes:
        thruster: its name.
        kind: how it failed: stuck off, stuck on, degraded.
        confidence: posterior probability, 0 to 1.
        loss: fraction of its thrust lost (0 for stuck on).
        t_s: when.
    """

    thruster: str
    kind: str
    confidence: float
    loss: float
    t_s: float

    @property
    def label(self) -> str:
        """``D7 stuck off, confidence 0.9998``; never rounded up to certainty."""
        shown = np.floor(self.confidence * 1e4) / 1e4
        return f"{self.thruster} {self.kind}, confidence {shown:.4f}"


def findings(fsw: np.void, thrusters: Sequence[str]) -> list[Finding]:
    """Verdicts in the order of time."""
    diagnosis = fsw["diagnosis"]
    return [
        Finding(
            thrusters[slot["thruster"]],
            KIND_NAMES[int(slot["kind"])],
            *(float(slot[name]) for name in ("confidence", "loss", "t")),
        )
        for slot in diagnosis["isolated"][: diagnosis["n_isolated"]]
    ]


def diagnosis_figures(
    found: Sequence[Finding], faults: Sequence[FaultParams], plant: np.void
) -> dict[str, float]:
    """Number of sound thrusters condemned, and time from the first thruster fault to its verdict if there was
    one.
    """
    since = {
        fault.thruster: float(begun)
        for fault, begun in zip(faults, plant["fault_since"], strict=False)
        if fault.kind in THRUSTER_KINDS and begun != NOT_BEGUN
    }
    guilty = [one for one in found if one.t_s >= since.get(one.thruster, np.inf)]
    figures = {"false_alarms": float(len(found) - len(guilty))}
    if guilty:
        figures["time_to_detect_s"] = guilty[0].t_s - since[guilty[0].thruster]
    return figures
