"""A designed powered landing beside the one that the scenario's own law flies: table, figure and files."""

from __future__ import annotations

from math import degrees
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from edl6dof.cli.exit_status import NOT_WITHIN_LIMITS
from edl6dof.config.errors import refusal
from edl6dof.design.convex_step import propagate
from edl6dof.design.powered_start import landing_of, powered_rows, states_of
from edl6dof.design.rigid_landing import (
    TOLERANCE,
    Excess,
    LandingFigures,
    RigidLanding,
    excesses,
    figures_of,
    tilt_of,
)
from edl6dof.design.successive import Converged, land
from edl6dof.report.figure import Axis, Figure, Mark, Panel, Trace
from edl6dof.report.matplotlib_figure import write_figure
from edl6dof.report.palette import GREY
from edl6dof.report.terminal import open_table
from edl6dof.runs.files import atomic_file
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.sim.flight import Flight, fly

#: States of each interval in the table of states and in the figure.
SAMPLES = 10
#: Time (s), states, controls, and angles of the thrust axis from the vertical.
COLUMNS = (
    *("t_s", "mass_kg", "east_m", "north_m", "up_m", "v_east_m_s", "v_north_m_s", "v_up_m_s"),
    *("q_S2L_w", "q_S2L_x", "q_S2L_y", "q_S2L_z", "rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s"),
    *("thrust_n", "torque_x_nm", "torque_y_nm", "torque_z_nm", "tilt_deg"),
)


def design_landing_of(
    loaded: LoadedScenario, place: str, out: Path | None, figure: Path | None, force: bool
) -> int:
    """Fly to ignition, design the landing from there, show and write it; returns the exit status.

    Raises:
        ConfigError: the scenario, called ``place``, lights no engine or cannot turn.
    """
    flight = fly(loaded)
    rows = powered_rows(flight)
    if not len(rows):
        raise refusal(place, f"lights no engine in its flight ({flight.outcome})")
    landing, console = landing_of(flight, rows), Console(highlight=False, soft_wrap=True)
    if not landing.torque.all():
        raise refusal(place, "has thrusters that leave an axis of the lander without torque")
    found = land(landing)
    t, x, u = propagate(landing, found.nodes, SAMPLES)
    designed = figures_of(landing, t, x)
    law = flight.scenario.flight_software.guidance.powered.law
    own_t, own_x = flight.telemetry["t_s"][rows] - flight.telemetry["t_s"][rows[0]], states_of(flight, rows)
    if not found.landed:
        console.print(_refused(flight, landing, found), markup=False)
        return NOT_WITHIN_LIMITS
    console.print(_table(flight.name, law, landing, designed, figures_of(landing, own_t, own_x)))
    console.print(_solution(found), markup=False)
    exceeded = excesses(landing, designed)
    for excess in exceeded:
        console.print(_exceeded(excess), markup=False)
    if out is not None:
        with atomic_file(out, force) as partial:
            write_states(partial, t, x, u)
        print(out)
    if figure is not None:
        with atomic_file(figure, force) as partial:
            write_figure(landing_figure(flight.name, landing, (t, x, u), law, (own_t, own_x)), partial)
        print(figure)
    return 0 if all(excess.tolerated for excess in exceeded) else NOT_WITHIN_LIMITS


def _refused(flight: Flight, landing: RigidLanding, found: Converged) -> str:
    """Why there is no landing."""
    height, away = landing.start[3], (landing.start[1] ** 2 + landing.start[2] ** 2) ** 0.5
    return (
        f"{flight.name}: no landing found within the limits from {height:.0f} m above and {away:.0f} m "
        f"beside the target at {-landing.start[6]:.1f} m/s down: {found.programs} convex programs leave "
        f"{found.defect:.1e} of virtual control; start higher, divert less, or widen the limits"
    )


def _table(
    name: str, law: str, landing: RigidLanding, designed: LandingFigures, own: LandingFigures
) -> Table:
    table = open_table(
        f"{name}: powered landing from ignition", "figure", "unit", "designed>", f"{law}>", "limit>"
    )

    def row(figure: str, unit: str, field: str, limit: str = "", places: int = 1) -> None:
        values = (round(getattr(of, field), places) + 0.0 for of in (designed, own))
        table.add_row(figure, unit, *(f"{value:,.{places}f}" for value in values), limit)

    row("propellant", "kg", "fuel_kg", places=2)
    row("time of flight", "s", "time_s")
    row("largest tilt", "deg", "tilt_deg", f"{degrees(landing.tilt):.1f}", 2)
    row("largest body rate", "deg/s", "rate_deg_s", f"{degrees(landing.rate):.1f}", 2)
    row("least height over the glide slope", "m", "slope_m", "0.0")
    row("distance from the target at the end", "m", "miss_m", places=3)
    row("speed at the end", "m/s", "speed_m_s", places=4)
    row("tilt at the end", "deg", "end_tilt_deg", places=3)
    return table


def _exceeded(excess: Excess) -> str:
    """By how much a limit is exceeded, and whether that is to be expected."""
    by = f"{excess.what}: exceeds its limit by {excess.by:.2g} {excess.unit}"
    most = f"the {100.0 * TOLERANCE:g} % allowed between the points where the design asks for it"
    return f"{by}, within {most}" if excess.tolerated else f"not kept: {by}, more than {most}"


def _solution(found: Converged) -> str:
    if len(found.nodes.durations) > 1:
        burn = f"full thrust for {found.nodes.durations[0]:.2f} s"
    else:
        burn = "throttled from the start"
    return f"{burn}; {found.programs} convex programs in {found.seconds:.1f} s; ends as flown by DOP853"


def write_states(path: Path, t: np.ndarray, x: np.ndarray, u: np.ndarray) -> None:
    """Write states and controls as CSV; axes of rates and torques are S (:mod:`...rigid_landing`)."""
    rows = np.column_stack([t, x[:, :11], np.degrees(x[:, 11:]), u, np.degrees(tilt_of(x))])
    np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=",".join(COLUMNS), comments="")


def landing_figure(
    name: str,
    landing: RigidLanding,
    designed: tuple[np.ndarray, np.ndarray, np.ndarray],
    law: str,
    own: tuple[np.ndarray, np.ndarray],
) -> Figure:
    """Path, thrust, tilt and rate of the designed landing (times, states, controls), beside those that the
    scenario's law flew (times, states).
    """
    t, x, u = designed

    def both(panel: str, unit: str, of: tuple[np.ndarray, np.ndarray], limit: float) -> Panel:
        traces = [Trace(t, of[0], "designed"), Trace(own[0], of[1], law)]
        return Panel(
            Axis("time from ignition (s)"),
            Axis(f"{panel} ({unit})"),
            traces,
            marks=[Mark("y", limit, "limit")],
        )

    rates = tuple(np.degrees(np.linalg.norm(states[:, 11:], axis=1)) for states in (x, own[1]))
    tilts = tuple(np.degrees(tilt_of(states)) for states in (x, own[1]))
    panels = [
        _path(landing, x, law, own[1]),
        Panel(
            Axis("time from ignition (s)"),
            Axis("thrust (N)"),
            [Trace(t, u[:, 0], "designed")],
            marks=[Mark("y", level, "", GREY) for level in landing.thrust],
        ),
        both("tilt", "deg", (tilts[0], tilts[1]), degrees(landing.tilt)),
        both("body rate", "deg/s", (rates[0], rates[1]), degrees(landing.rate)),
    ]
    return Figure("landing", f"{name}: powered landing", panels, columns=2, height=360)


def _path(landing: RigidLanding, x: np.ndarray, law: str, own: np.ndarray) -> Panel:
    """Height over the distance from the target, positive on the side of the start."""
    start = landing.start[1:3] / max(float(np.linalg.norm(landing.start[1:3])), 1e-9)
    traces = [
        Trace(states[:, 1:3] @ start, states[:, 3], who) for states, who in ((x, "designed"), (own, law))
    ]
    return Panel(Axis("towards the start (m)"), Axis("height over the target (m)"), traces, equal=True)
