"""All check cases, and how one is run: a case that breaks fails and the others go on."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from edl6dof.verify.case import History, NotInstalledError, Outcome, Result

#: In the order they are shown; a new one is a file in ``cases`` and a name here.
NAMES = (
    *("rotations", "frames", "us76_table", "gravity_field", "rk4_order", "kepler"),
    *("tumbling", "symmetric_top", "allen_eggers", "equilibrium_glide", "point_mass"),
    *("capsule_trim", "damping", "impulses", "rocket_equation", "jettison"),
    *("terminal_velocity", "pendulum", "nesc"),
)
CASES: dict[str, Callable[..., Outcome]] = {
    name: import_module(f"edl6dof.verify.cases.{name}").run for name in NAMES
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
