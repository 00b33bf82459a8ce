"""``edl6dof design landing``."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib.util import find_spec
from math import degrees
from pathlib import Path

from rich.console import Console
from rich.table import Table

from edl6dof.app.exit_status import NOT_WITHIN_LIMITS, UNAVAILABLE
from edl6dof.app.landing_files import landing_figure, write_states
from edl6dof.config.errors import refusal
from edl6dof.design.landing.landing_figures import TOLERANCE, Excess, LandingFigures, excesses, figures_of
from edl6dof.design.landing.powered_start import landing_of, powered_rows, states_of
from edl6dof.design.landing.rigid_body import RigidLanding
from edl6dof.design.landing.successive import Converged, land
from edl6dof.design.landing.transcription import propagate
from edl6dof.interface.roles import POWERED_DECELERATION
from edl6dof.report.terminal import open_table
from edl6dof.runs.files import atomic_file, refuse_existing_file
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight, fly

_DIVERT = "flight_software.guidance.powered.target.divert_m"
_DRAWN = (".png", ".pdf", ".svg")
#: States of each interval in the table of states and in the figure.
SAMPLES = 10


@dataclass(frozen=True)
class LandingOptions:
    """Options of ``edl6dof design landing``."""

    scenario: str
    sets: tuple[str, ...]
    divert_m: float | None
    out: Path | None
    figure: Path | None
    force: bool


def run_design_landing(options: LandingOptions) -> int:
    """Fly to ignition, design the landing from there, show and write it; returns the exit status."""
    _refuse_files(options)
    if find_spec("clarabel") is None:
        message = "design landing needs clarabel, which is not installed; try: pip install 'edl6dof[design]'"
        print(message, file=sys.stderr)
        return UNAVAILABLE
    divert = () if options.divert_m is None else (f"{_DIVERT}={options.divert_m}",)
    loaded = load_scenario(options.scenario, [*options.sets, *divert])
    _refuse_without_powered(options.scenario, loaded.scenario)
    flight = fly(loaded)
    rows = powered_rows(flight)
    if not len(rows):
        raise refusal(options.scenario, f"lights no engine in its flight ({flight.outcome})")
    landing, console = landing_of(flight, rows), Console(highlight=False, soft_wrap=True)
    if not landing.torque.all():
        raise refusal(options.scenario, "has thrusters that leave an axis of the lander without torque")
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
    if options.out is not None:
        with atomic_file(options.out, options.force) as partial:
            write_states(partial, t, x, u)
        print(options.out)
    if options.figure is not None:
        from edl6dof.report.matplotlib_figure import write_figure

        with atomic_file(options.figure, options.force) as partial:
            write_figure(landing_figure(flight.name, landing, (t, x, u), law, (own_t, own_x)), partial)
        print(options.figure)
    return 0 if all(excess.tolerated for excess in exceeded) else NOT_WITHIN_LIMITS


def _refuse_files(options: LandingOptions) -> None:
    for path, suffixes in ((options.out, (".csv",)), (options.figure, _DRAWN)):
        if path is None:
            continue
        if path.suffix not in suffixes:
            raise refusal(path, f"must end in {', '.join(suffixes)}")
        refuse_existing_file(path, options.force)


def _refuse_without_powered(name: str, scenario: Scenario) -> None:
    """Refuse a scenario that brakes by no engine."""
    phases = scenario.mission.phases
    if all(phase.guidance != "powered" or phase.role != POWERED_DECELERATION for phase in phases):
        words = f"guidance: powered and role: {POWERED_DECELERATION}"
        raise refusal(name, f"has no phase with {words}, so there is no powered landing to design")


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
