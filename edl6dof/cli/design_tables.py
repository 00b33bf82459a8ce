"""Results of the design commands: tables, figures and files of a designed entry or landing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import degrees
from pathlib import Path
from typing import get_args

import numpy as np
from rich.console import Console
from rich.table import Table

from edl6dof.cli.group import NOT_WITHIN_LIMITS, write_file
from edl6dof.config.errors import refusal
from edl6dof.design.aim import Aim
from edl6dof.design.entry_profile import Design, Goal, Plan
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
from edl6dof.design.successive import Converged, land, propagate
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.figure import Axis, Figure, Mark, Panel, Trace
from edl6dof.report.matplotlib_figure import write_figure
from edl6dof.report.palette import GREY
from edl6dof.report.terminal import open_table
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight, fly


def goal_of(maximise: str | None, minimise: str | None) -> Goal:
    """Return the goal of the design that the options select."""
    given = {"--maximise": maximise, "--minimise": minimise}
    if None not in given.values():
        raise refusal("--minimise", "and --maximise cannot both be given")
    known = dict(zip(given, get_args(Goal), strict=True))
    for option, value in given.items():
        if value is not None and value != known[option]:
            raise refusal(option, f"must be {known[option]!r} (got {value!r})")
    return "dispersion" if minimise else "parachute_altitude"


def show_aim(old: Scenario, new: Scenario, found: Aim, flights: Sequence[Flight]) -> None:
    """Print the entry point, the planned end and the flights with guidance at the old and the new site."""
    console = Console(highlight=False, soft_wrap=True)
    north, east = new.terrain.site_latitude_deg, new.terrain.site_longitude_deg
    site = f"{abs(north):g} {'SN'[north >= 0.0]}, {east:g} E"
    table = open_table(f"{old.name} at {site}", "figure", "unit", "own site>", "new site>")
    both = (old, new)
    for label, unit, values, places in (
        ("entry latitude", "deg", [s.initial.latitude_deg for s in both], 4),
        ("entry longitude", "deg", [s.initial.longitude_deg for s in both], 4),
        ("site elevation", "m", [s.terrain.site_elevation_m for s in both], 0),
        ("planned end beyond the aim point", "m", [end[0] for end in found.ends], 0),
        ("planned end right of it", "m", [end[1] for end in found.ends], 0),
    ):
        table.add_row(label, unit, *(f"{round(value, places) + 0.0:,.{places}f}" for value in values))
    for name in ("parachute_miss_m", "landing_distance_m"):
        values = [flight.figures.get(name, np.nan) for flight in flights]
        if np.isfinite(values).all():
            table.add_row(figure_of_merit(name).meaning, "m", *(f"{value:,.0f}" for value in values))
    console.print(table)
    for words, flight in zip(("own site", "new site"), flights, strict=True):
        console.print(f"{words}: {flight.outcome}", markup=False)
    if not found.reached:
        console.print(f"not reached after {found.entries} planned entries: change initial.azimuth_deg")


def show(name: str, found: Design) -> None:
    """Print profile, figures and limits that are not met."""
    console = Console(highlight=False, soft_wrap=True)
    console.print(_profile(name, found))
    console.print(_figures(found))
    for broken in found.broken:
        print(f"not met: {_REMEDIES[broken]}")


def _profile(name: str, found: Design) -> Table:
    table = open_table(f"{name}: bank profile", "speed m/s>", "planned deg>", "designed deg>")
    for bank, (speed, designed) in zip(found.planned_deg, found.after.points, strict=True):
        table.add_row(f"{speed:.0f}", f"{bank:.1f}", f"{designed:.1f}")
    return table


def _figures(found: Design) -> Table:
    limits = found.limits
    table = open_table("Plan, open loop", "figure", "unit", "planned>", "designed>", "limit>")

    def row(figure: str, unit: str, of: Callable[[Plan], float], limit: str = "", places: int = 0) -> None:
        values = (round(of(plan), places) + 0.0 for plan in (found.before, found.after))
        table.add_row(figure, unit, *(f"{value:,.{places}f}" for value in values), limit)

    row("altitude of the parachute", "m", lambda p: p.altitude_m)
    row("downrange miss", "m", lambda p: p.beyond_m)
    row("crossrange miss", "m", lambda p: p.aside_m, f"{limits.aside_m:,.0f}")
    row("largest load", "g0", lambda p: p.load_g0, f"{limits.load_g0:.1f}", 2)
    row("largest heat rate", "W/cm2", lambda p: p.heat_rate_w_cm2, f"{limits.heat_rate_w_cm2:.0f}", 1)
    pressure = f"{limits.dynamic_pressure_pa:,.0f}"
    row("largest dynamic pressure", "Pa", lambda p: p.dynamic_pressure_pa, pressure)
    row("least distance to the bank limits", "deg", lambda p: p.reserve_deg, f"{limits.reserve_deg:g}", 1)
    slope = f"{limits.bank_slope_deg_s:g}"
    row("fastest change of the profile", "deg/s", lambda p: p.bank_slope_deg_s, slope, 2)
    row("miss by 1 sigma of density", "m", lambda p: p.misses_m[0])
    row("miss by 1 sigma of lift", "m", lambda p: p.misses_m[1])
    row("miss by 1 sigma of entry angle", "m", lambda p: p.misses_m[2])
    row("1 sigma of the miss without guidance", "m", lambda p: p.dispersion_m)
    return table


_LIMITS = "flight_software.guidance.entry.limits"
#: Advice for each limit that a designed plan may violate.
_REMEDIES = {
    "load": f"load: enter at a flatter angle, or raise {_LIMITS}.load_g0",
    "heat rate": f"heat rate: enter at a flatter angle, or raise {_LIMITS}.heat_rate_w_cm2",
    "dynamic pressure": f"dynamic pressure: enter at a flatter angle, or raise {_LIMITS}.dynamic_pressure_pa",
    "bank slope": "change of the bank angle: fewer --points",
    "reserve": "reserve: move the landing site or the entry state along the track, or lower --reserve",
    "crossrange": "crossrange: narrow the corridor of the bank reversals",
    "aim point": "aim point: out of reach within the reserve; move the landing site or the entry state along "
    "the track, or lower --reserve",
}


#: States of each interval in the table of states and in the figure.
SAMPLES = 10
#: Columns of the table of states: time, states, controls, and tilt of the thrust axis.
COLUMNS = (
    *("t_s", "mass_kg", "east_m", "north_m", "up_m", "v_east_m_s", "v_north_m_s", "v_up_m_s"),
    *("q_S2L_w", "q_S2L_x", "q_S2L_y", "q_S2L_z", "rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s"),
    *("thrust_n", "torque_x_nm", "torque_y_nm", "torque_z_nm", "tilt_deg"),
)


def design_landing_of(
    loaded: LoadedScenario, place: str, out: Path | None, figure: Path | None, force: bool
) -> int:
    """Fly a scenario to ignition, design the landing, print and write it; return the exit status."""
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
        print(_refused(flight, landing, found))
        return NOT_WITHIN_LIMITS
    console.print(_table(flight.name, law, landing, designed, figures_of(landing, own_t, own_x)))
    print(_solution(found))
    exceeded = excesses(landing, designed)
    for excess in exceeded:
        print(_exceeded(excess))
    write_file(out, force, partial(write_states, t, x, u))
    if figure is not None:
        drawn = landing_figure(flight.name, landing, (t, x, u), law, (own_t, own_x))
        write_file(figure, force, partial(write_figure, drawn))
    return 0 if all(excess.tolerated for excess in exceeded) else NOT_WITHIN_LIMITS


def _refused(flight: Flight, landing: RigidLanding, found: Converged) -> str:
    height, away = landing.start[3], (landing.start[1] ** 2 + landing.start[2] ** 2) ** 0.5
    return (
        f"{flight.name}: no landing found within the limits from {height:.0f} m above and {away:.0f} m "
        f"beside the target at {-landing.start[6]:.1f} m/s down: {found.programs} convex programs leave "
        f"{found.defect:.1e} of virtual control; start higher, divert less, or widen the limits"
    )


def _table(
    name: str, law: str, landing: RigidLanding, designed: LandingFigures, own: LandingFigures
) -> Table:
    heads = ("figure", "unit", "designed>", f"{law}>", "limit>")
    table = open_table(f"{name}: powered landing from ignition", *heads)

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
    by = f"{excess.what}: exceeds its limit by {excess.by:.2g} {excess.unit}"
    most = f"the {100.0 * TOLERANCE:g} % allowed between the points where the design asks for it"
    return f"{by}, within {most}" if excess.tolerated else f"not met: {by}, more than {most}"


def _solution(found: Converged) -> str:
    switches = len(found.nodes.durations) > 1
    burn = f"full thrust for {found.nodes.durations[0]:.2f} s" if switches else "throttled from the start"
    return f"{burn}; {found.programs} convex programs in {found.seconds:.1f} s; ends as flown by DOP853"


def write_states(t: np.ndarray, x: np.ndarray, u: np.ndarray, path: Path) -> None:
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
    """Draw path, thrust, tilt and rate of the ``designed`` landing (times, states, controls) and of the
    flight with the scenario's ``law``.
    """
    t, x, u = designed

    time = Axis("time from ignition (s)")

    def both(axis: str, of: Callable[[np.ndarray], np.ndarray], limit: float) -> Panel:
        """Angles or rates (rad, rad/s) that follow from the states, and their limit, drawn in degrees."""
        traces = [Trace(t, np.degrees(of(x)), "designed"), Trace(own[0], np.degrees(of(own[1])), law)]
        return Panel(time, Axis(axis), traces, marks=[Mark("y", degrees(limit), "limit")])

    levels = [Mark("y", level, "", GREY) for level in landing.thrust]
    panels = [
        _path(landing, x, law, own[1]),
        Panel(time, Axis("thrust (N)"), [Trace(t, u[:, 0], "designed")], marks=levels),
        both("tilt (deg)", tilt_of, landing.tilt),
        both("body rate (deg/s)", lambda states: np.linalg.norm(states[:, 11:], axis=1), landing.rate),
    ]
    return Figure("landing", f"{name}: powered landing", panels, columns=2, height=360)


def _path(landing: RigidLanding, x: np.ndarray, law: str, own: np.ndarray) -> Panel:
    """Height over the distance from the target, positive on the side of the start."""
    start = landing.start[1:3] / max(float(np.linalg.norm(landing.start[1:3])), 1e-9)
    flown = ((x, "designed"), (own, law))
    traces = [Trace(states[:, 1:3] @ start, states[:, 3], name) for states, name in flown]
    return Panel(Axis("towards the start (m)"), Axis("height over the target (m)"), traces, equal=True)
