"""All check cases, and how one is run: a case that raises an error fails, and the others still run."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.report.matplotlib_figure import matplotlib_figure
from edl6dof.verify import (
    capsule_trim,
    entries,
    free_motion,
    jettison,
    nesc,
    parachute_descent,
    planet,
    propulsion,
    rotations_and_frames,
    touchdown,
)
from edl6dof.verify.case import History, NotInstalledError, Report

#: In the order they are shown; a new one is a function in a file of this folder and a line here.
CASES: dict[str, Callable[..., Report]] = {
    "rotations": rotations_and_frames.rotations,
    "frames": rotations_and_frames.frames,
    "us76_table": planet.us76_table,
    "gravity_field": planet.gravity_field,
    "areoid": planet.areoid,
    "seasonal_column": planet.seasonal_column,
    "rk4_order": free_motion.rk4_order,
    "kepler": free_motion.kepler,
    "tumbling": free_motion.tumbling,
    "symmetric_top": free_motion.symmetric_top,
    "allen_eggers": entries.allen_eggers,
    "heating": entries.heating,
    "equilibrium_glide": capsule_trim.equilibrium_glide,
    "point_mass": entries.point_mass,
    "capsule_trim": capsule_trim.capsule_trim,
    "offset_trim": capsule_trim.offset_trim,
    "damping": capsule_trim.damping,
    "bridging": capsule_trim.bridging,
    "impulses": propulsion.impulses,
    "rocket_equation": propulsion.rocket_equation,
    "jettison": jettison.run,
    "inflation": parachute_descent.inflation,
    "terminal_velocity": parachute_descent.terminal_velocity,
    "pendulum": parachute_descent.pendulum,
    "contact": touchdown.contact,
    "nesc": nesc.run,
}


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


def draw(history: History, path: Path) -> None:
    """Write a PNG of the curves; what was expected is thin and dashed on top."""
    flown = Trace(history.x, history.flown, "flown", width=3.0)
    expected = Trace(history.x, history.expected, "expected", dash="dash", width=1.2, border=True)
    panel = Panel(Axis(history.x_label), Axis(history.y_label), [flown, expected])
    matplotlib_figure(Figure("history", history.title, [panel])).savefig(path, format="png", dpi=140)
