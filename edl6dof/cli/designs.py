"""The command that designs a part of a mission on the ground."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from edl6dof.api.functions import activate
from edl6dof.cli.group import (
    NOT_WITHIN_LIMITS,
    UNAVAILABLE,
    Command,
    Sets,
    argument,
    check_target,
    examples,
    flag,
    option,
)
from edl6dof.config.errors import refusal

design = typer.Typer(
    no_args_is_help=True,
    help="Design a part of a mission: its entry or landing.",
)


@design.command("entry", cls=Command, epilog=examples("design entry"))
def design_entry(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")],
    sets: Sets = None,
    maximise: Annotated[str | None, option("WHAT", "parachute_altitude; the default.")] = None,
    minimise: Annotated[
        str | None, option("WHAT", "dispersion: of the open loop, by density, L/D and entry angle.")
    ] = None,
    points: Annotated[int, option("N", "Speeds at which the bank angle is free.", min=2, max=16)] = 6,
    reserve: Annotated[
        float, option("DEG", "Distance of the plan from the bank limits.", min=0.0, max=60.0)
    ] = 10.0,
    out: Annotated[
        Path | None, option("FILE", "Write a scenario (.yaml) that extends this one; with --set, all of it.")
    ] = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> int:
    """Optimise the bank profile of the planned entry.

    The result is compared with the profile of the scenario. Load, heat rate and dynamic pressure stay within
    flight_software.guidance.entry.limits, the bank angles within their limits less the reserve, and the
    profile changes by at most a quarter of the bank rate.

    Exit status: 0 within all limits, 1 not, 2 bad input, 130 interrupted.
    """
    activate(scenario)
    from edl6dof.cli.design_tables import designed_text, goal_of, show
    from edl6dof.design.entry_profile import design_entry as optimise
    from edl6dof.runs.files import atomic_file
    from edl6dof.scenario.loading import load_scenario

    goal = goal_of(maximise, minimise)
    check_target(out, (".yaml", ".yml"), force)
    loaded = load_scenario(scenario, sets or ())
    if all(phase.guidance != "entry" for phase in loaded.scenario.mission.phases):
        raise refusal(scenario, "has no phase with guidance: entry, so there is no entry to design")
    entry = loaded.scenario.flight_software.guidance.entry
    if entry.bank_min_deg + reserve >= entry.bank_max_deg - reserve:
        raise refusal(
            "--reserve",
            f"{reserve:g} leaves nothing between bank_min_deg {entry.bank_min_deg:g} and "
            f"bank_max_deg {entry.bank_max_deg:g}",
        )
    found = optimise(loaded.scenario, goal, points, reserve)
    show(loaded.scenario.name, found)
    if out is not None:
        with atomic_file(out, force) as partial:
            partial.write_text(designed_text(scenario, bool(sets), loaded, found), encoding="utf-8")
        print(out)
    return NOT_WITHIN_LIMITS if found.broken else 0


@design.command("landing", cls=Command, epilog=examples("design landing"))
def design_landing(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")],
    sets: Sets = None,
    divert_m: Annotated[
        float | None,
        option("M", "Divert against the drift; replaces the scenario's target.divert_m.", min=0.0),
    ] = None,
    out: Annotated[Path | None, option("FILE", "Write states and controls (.csv).")] = None,
    figure: Annotated[
        Path | None, option("FILE", "Plot the result with the scenario's own flight (.png, .pdf, .svg).")
    ] = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> int:
    """Design the powered landing with the least propellant.

    Successive convexification optimises the landing of the rigid lander, from the true state of the
    scenario's own flight at engine ignition to rest at its powered target. The result is compared with the
    flight of the scenario's own law. Needs cvxpy: pip install 'edl6dof[design]'.

    Exit status: 0 designed, 1 no landing within the limits or one that exceeds them on its way, 2 bad input,
    69 cvxpy is missing, 130 interrupted.
    """
    activate(scenario)
    check_target(out, (".csv",), force)
    check_target(figure, (".png", ".pdf", ".svg"), force)
    if find_spec("cvxpy") is None:
        message = "design landing needs cvxpy, which is not installed; try: pip install 'edl6dof[design]'"
        print(message, file=sys.stderr)
        return UNAVAILABLE
    from edl6dof.cli.design_tables import design_landing_of
    from edl6dof.interface.roles import POWERED_DECELERATION
    from edl6dof.scenario.loading import load_scenario

    divert = () if divert_m is None else (f"flight_software.guidance.powered.target.divert_m={divert_m}",)
    loaded = load_scenario(scenario, [*(sets or ()), *divert])
    phases = loaded.scenario.mission.phases
    if all(phase.guidance != "powered" or phase.role != POWERED_DECELERATION for phase in phases):
        words = f"guidance: powered and role: {POWERED_DECELERATION}"
        raise refusal(scenario, f"has no phase with {words}, so there is no powered landing to design")
    return design_landing_of(loaded, scenario, out, figure, force)
