"""The command that designs a part of a mission on the ground."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from edl6dof.cli.examples import examples
from edl6dof.cli.group import Command
from edl6dof.cli.options import Sets, load_plugins

design = typer.Typer(
    no_args_is_help=True,
    help="Design a part of a mission: its entry or landing.",
)


@design.command("entry", cls=Command, epilog=examples("entry"))
def design_entry(
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO", help="Scenario file, or the name of a shipped one.")
    ],
    sets: Sets = None,
    maximise: Annotated[
        str | None, typer.Option(metavar="WHAT", help="parachute_altitude; the default.")
    ] = None,
    minimise: Annotated[
        str | None,
        typer.Option(metavar="WHAT", help="dispersion: of the open loop, by density, L/D and entry angle."),
    ] = None,
    points: Annotated[
        int, typer.Option(metavar="N", min=2, max=16, help="Speeds at which the bank angle is free.")
    ] = 6,
    reserve: Annotated[
        float,
        typer.Option(metavar="DEG", min=0.0, max=60.0, help="How far the plan stays from the bank limits."),
    ] = 10.0,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Write a scenario (.yaml) that extends this one; with --set, all of it."
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Optimise the bank profile of the planned entry.

    It is shown beside the one of the scenario. Load, heat rate and dynamic pressure keep to
    flight_software.guidance.entry.limits, the bank angles to their limits less the reserve, and the profile
    to a quarter of the bank rate.

    Exit status: 0 within all limits, 1 not, 2 bad input, 130 interrupted.
    """
    load_plugins(scenario)
    from edl6dof.app.design_entry import DesignOptions, run_design_entry

    options = DesignOptions(scenario, tuple(sets or ()), maximise, minimise, points, reserve, out, force)
    raise typer.Exit(run_design_entry(options))


@design.command("landing", cls=Command, epilog=examples("landing"))
def design_landing(
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO", help="Scenario file, or the name of a shipped one.")
    ],
    sets: Sets = None,
    divert_m: Annotated[
        float | None,
        typer.Option(
            metavar="M",
            min=0.0,
            help="Divert against the drift, in the place of the scenario's target.divert_m.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write states and controls (.csv).")
    ] = None,
    figure: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw them beside the scenario's own (.png, .pdf, .svg)."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Design the powered landing of least propellant.

    It is that of the rigid lander, from the true state of the scenario's own flight where the engine lights
    to rest at its powered target, by successive convexification; shown beside what the scenario's own law
    flies. Needs clarabel: pip install 'edl6dof[design]'.

    Exit status: 0 designed, 1 no landing within the limits or one that breaks them on its way, 2 bad input,
    69 clarabel is missing, 130 interrupted.
    """
    load_plugins(scenario)
    from edl6dof.app.design_landing import LandingOptions, run_design_landing

    options = LandingOptions(scenario, tuple(sets or ()), divert_m, out, figure, force)
    raise typer.Exit(run_design_landing(options))
