"""Attitude: air angles, body rates, and the error that the controller works on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.report.figure import BLUE, GREY, VERMILION, Figure
from edl6dof.report.flight.parts import Curve, has_signal, over_time, stacked
from edl6dof.runs.run import Run


def figures(run: Run) -> Iterator[Figure]:
    """Figures of the section, without the phase planes; none for a point mass, which has no attitude."""
    if not any(has_signal(run, f"truth.rate_{axis}_deg_s") for axis in "pqr"):
        return
    whole = np.ones(len(run.t), bool)
    flown = run.between(until="touchdown")
    if has_signal(run, "truth.dynamic_pressure_pa"):
        yield air_angles(run)
    rates = [
        over_time(run, f"{name} (deg/s)", [Curve(f"truth.rate_{axis}_deg_s", colour=BLUE)], flown)
        for axis, name in zip("pqr", ("roll rate p", "pitch rate q", "yaw rate r"), strict=True)
    ]
    yield stacked("rates", "Body rates", rates, "Inertial rates in body axes.", 150)
    if any(has_signal(run, f"control.error_{axis}_deg") for axis in ("roll", "pitch", "yaw")):
        errors = [
            over_time(run, f"{axis} (deg)", [Curve(f"control.error_{axis}_deg", colour=VERMILION)], whole)
            for axis in ("roll", "pitch", "yaw")
        ]
        caption = (
            "Goal minus actual, as each phase's controller defines it; during the lift phase the roll "
            "channel is the bank error."
        )
        yield stacked("attitude_error", "Attitude error used by the controller", errors, caption, 150)


def air_angles(run: Run) -> Figure:
    """Angle of attack and sideslip, true and navigated, while there is a capsule to speak of."""
    rows = run.between(until="backshell") & (run["truth.dynamic_pressure_pa"] > 1.0)
    panels = [
        over_time(run, "angle of attack (deg)", _angle(run, "alpha"), rows),
        over_time(run, "sideslip (deg)", _angle(run, "beta"), rows),
        over_time(run, "total angle (deg)", [Curve("truth.total_alpha_deg", colour=BLUE)], rows),
    ]
    caption = "Shown while dynamic pressure is above 1 Pa."
    if run.phase_names:
        caption = f"The flight computer knows no wind, hence the difference. {caption}"
    return stacked("air_angles", "Angles to the air", panels, caption, 160)


def _angle(run: Run, angle: str) -> list[Curve]:
    """The true angle, and the navigated one of a flight with a flight computer."""
    navigated = Curve(f"nav.{angle}_deg", "navigated", colour=GREY, dash="dash")
    return [navigated] * bool(run.phase_names) + [Curve(f"truth.{angle}_deg", "true", colour=BLUE)]
