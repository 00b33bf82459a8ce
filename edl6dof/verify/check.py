"""All check cases, and how one is run: a case that breaks fails and the others go on."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from edl6dof.verify.case import History, NotInstalledError, Outcome, Result
from edl6dof.verify.cases import (
    allen_eggers,
    capsule_pitch,
    equilibrium_glide,
    free_rotation,
    jettison,
    nesc,
    parachute_descent,
    planet,
    point_mass,
    point_motion,
    propulsion,
    rotations_and_frames,
)

#: In the order they are shown; a new one is a function in a file of ``cases`` and a line here.
CASES: dict[str, Callable[..., Outcome]] = {
    "rotations": rotations_and_frames.rotations,
    "frames": rotations_and_frames.frames,
    "us76_table": planet.us76_table,
    "gravity_field": planet.gravity_field,
    "rk4_order": point_motion.rk4_order,
    "kepler": point_motion.kepler,
    "tumbling": free_rotation.tumbling,
    "symmetric_top": free_rotation.symmetric_top,
    "allen_eggers": allen_eggers.run,
    "equilibrium_glide": equilibrium_glide.run,
    "point_mass": point_mass.run,
    "capsule_trim": capsule_pitch.capsule_trim,
    "damping": capsule_pitch.damping,
    "impulses": propulsion.impulses,
    "rocket_equation": propulsion.rocket_equation,
    "jettison": jettison.run,
    "terminal_velocity": parachute_descent.terminal_velocity,
    "pendulum": parachute_descent.pendulum,
    "nesc": nesc.run,
}


@dataclass(frozen=True, repr=False)
class Report:
    """Outcome of one case, or why it has none.

    Attributes:
        note: why it was skipped or broke; empty otherwise.
        skipped: it cannot run on this installation, which fails nothing.
    """

    name: str
    results: Sequence[Result] = ()
    history: History | None = None
    seconds: float = 0.0
    note: str = ""
    skipped: bool = False

    def __repr__(self) -> str:
        outcome = "skipped" if self.skipped else "within tolerance" if self.passed else "FAILED"
        return f"<Report {self.name}: {len(self.results)} comparisons, {outcome}>"

    @property
    def passed(self) -> bool:
        """True if every comparison of the case is within its tolerance."""
        return self.skipped or Outcome(self.results).passed

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON; an error that is not finite becomes null."""
        rows = [
            {
                **vars(one),
                "error": float(one.error) if math.isfinite(one.error) else None,
                "passed": one.passed,
            }
            for one in self.results
        ]
        state = {"passed": self.passed, "skipped": self.skipped, "note": self.note}
        return {"case": self.name, **state, "seconds": round(self.seconds, 3), "results": rows}


def run_case(name: str) -> Report:
    """Run one case by name."""
    begin, outcome, note = time.perf_counter(), Outcome(()), ""
    try:
        outcome = CASES[name]()
    except NotInstalledError as error:
        return Report(name, note=str(error), skipped=True)
    except Exception as error:  # a case that breaks is a failed case, and the table goes on
        note = f"{type(error).__name__}: {error}"
    return Report(name, outcome.results, outcome.history, time.perf_counter() - begin, note)


def draw(history: History, path: Path) -> None:
    """Write a PNG of the curves; what was expected is thin and dashed on top."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 3.8), dpi=140, layout="constrained")
    axes = figure.subplots()
    axes.plot(history.x, history.flown, linewidth=3.0, label="flown")
    axes.plot(history.x, history.expected, "k--", linewidth=1.2, label="expected")
    axes.set(title=history.title, xlabel=history.x_label, ylabel=history.y_label)
    axes.legend()
    figure.savefig(path, format="png")
