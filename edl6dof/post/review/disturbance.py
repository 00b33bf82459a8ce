"""Disturbance torque and force: what acted, and what the flight software estimated."""

from __future__ import annotations

from collections.abc import Iterator

from edl6dof.post.report.figure import BLUE, VERMILION, Figure
from edl6dof.post.review.parts import Curve, has_signal, over_time, stacked
from edl6dof.post.run import Run


def figures(run: Run) -> Iterator[Figure]:
    """Figures of the section; the estimates only where the run has them."""
    rows = run.between(until="touchdown")
    if not any(has_signal(run, f"truth.disturbance_{axis}_nm") for axis in "xyz"):
        return
    panels = []
    for axis, name in zip("xyz", ("roll", "pitch", "yaw"), strict=True):
        curves = [
            Curve(f"truth.disturbance_{axis}_nm", "true", colour=BLUE),
            Curve(f"estimate.torque_{axis}_nm", "estimated", colour=VERMILION),
        ]
        panels.append(over_time(run, f"{name} (N m)", curves, rows))
    yield stacked("disturbance_torque", "Disturbance torque", panels, "Moment of everything but the thrusters, in body axes.", 160)
