"""All check cases, and how one is run: a case that raises an error fails, and the others still run."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from edl6dof.report.figure import Figure
from edl6dof.report.matplotlib_figure import matplotlib_figure
from edl6dof.verify.capsule_trim import bridging, capsule_trim, damping, equilibrium_glide, offset_trim
from edl6dof.verify.case import Bench, NotInstalledError, Report
from edl6dof.verify.entries import allen_eggers, heating, point_mass
from edl6dof.verify.free_motion import kepler, rk4_order, symmetric_top, tumbling
from edl6dof.verify.jettison import jettison
from edl6dof.verify.nesc import nesc
from edl6dof.verify.parachute_descent import inflation, pendulum, terminal_velocity
from edl6dof.verify.planet import areoid, gravity_field, seasonal_column, us76_table
from edl6dof.verify.propulsion import impulses, rocket_equation
from edl6dof.verify.rotations_and_frames import frames, rotations
from edl6dof.verify.touchdown import contact


def case_of(body: Callable[[Bench], None]) -> Callable[..., Report]:
    """Return a check case that takes planted overrides and returns its report."""

    def case(planted: Sequence[str] = ()) -> Report:
        bench = Bench(planted)
        body(bench)
        return Report(bench.results, bench.history)

    return case


#: In the order they are shown; a new one is a function in a file of this folder and a name here.
_BODIES = (
    *(rotations, frames, us76_table, gravity_field, areoid, seasonal_column, rk4_order, kepler, tumbling),
    *(symmetric_top, allen_eggers, heating, equilibrium_glide, point_mass, capsule_trim, offset_trim),
    *(damping, bridging, impulses, rocket_equation, jettison, inflation, terminal_velocity, pendulum),
    *(contact, nesc),
)
CASES: dict[str, Callable[..., Report]] = {body.__name__: case_of(body) for body in _BODIES}


def run_case(name: str) -> Report:
    """Run a case by name; without reference data it is skipped, and if it raises an error it has failed."""
    begin = time.perf_counter()
    try:
        report = CASES[name]()
    except NotInstalledError as error:
        return Report(name=name, note=str(error), skipped=True)
    except Exception as error:  # the other cases go on
        report = Report(note=f"{type(error).__name__}: {error}")
    return replace(report, name=name, seconds=time.perf_counter() - begin)


def draw(history: Figure, path: Path) -> None:
    """Write the plot of a case as PNG."""
    matplotlib_figure(history).savefig(path, format="png", dpi=140)
