"""All check cases, and how one is run: a case that breaks fails and the others go on."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from edl6dof.verify.outcome import History, NotInstalledError, Oracle, Outcome, Result

#: In the order they are shown; a new one is a file in ``cases`` and a name here.
NAMES = (
    *("rotations", "frames", "us76_table", "gravity_field", "rk4_order", "kepler"),
    *("tumbling", "symmetric_top", "allen_eggers", "equilibrium_glide", "point_mass"),
    *("capsule_trim", "damping", "impulses", "rocket_equation", "jettison"),
    *("terminal_velocity", "pendulum", "nesc"),
)
CASES: dict[str, Oracle] = {name: import_module(f"edl6dof.verify.cases.{name}").run for name in NAMES}


@dataclass(frozen=True, repr=False)
class Report:
    """What became of one case.

    Attributes:
        note: why it was skipped or broke; empty otherwise.
        skipped: it cannot run on this installation, which fails nothing.
    """

    name: str
    results: tuple[Result, ...]
    history: History | None
    seconds: float
    note: str = ""
    skipped: bool = False

    def __repr__(self) -> str:
        outcome = "skipped" if self.skipped else "within tolerance" if self.passed else "FAILED"
        return f"<Report {self.name}: {len(self.results)} comparisons, {outcome}>"

    @property
    def passed(self) -> bool:
        """Whether every comparison of the case is within its tolerance."""
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
    begin = time.perf_counter()
    try:
        outcome = CASES[name]()
    except NotInstalledError as error:
        return Report(name, (), None, 0.0, str(error), skipped=True)
    except Exception as error:  # a case that breaks is a failed case, and the table goes on
        return Report(name, (), None, time.perf_counter() - begin, f"{type(error).__name__}: {error}")
    return Report(name, outcome.results, outcome.history, time.perf_counter() - begin)


def draw(history: History, path: Path) -> None:
    """Write a PNG of the curves; what was expected is thin and dashed on top."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 3.8), dpi=140, layout="constrained")
    axes = figure.subplots()
    for name, values in history.curves.items():
        style = "k--" if name.endswith("expected") else "-"
        axes.plot(history.x, values, style, linewidth=1.2 if style == "k--" else 3.0, label=name)
    axes.set(title=history.title, xlabel=history.x_label, ylabel=history.y_label)
    axes.legend()
    figure.savefig(path, format="png")
