"""Commands that fly many flights of one scenario."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from edl6dof.cli.options import Sets, load_plugins
from edl6dof.config.errors import refusal


def campaign(
    scenario: Annotated[
        str | None,
        typer.Argument(
            metavar="CAMPAIGN", help=("Campaign file or name; with --resume, the folder of a campaign.")
        ),
    ] = None,
    sets: Sets = None,
    cases: Annotated[
        int | None,
        typer.Option("-n", "--cases", metavar="N", min=1, help="Flights (at each point of a sweep)."),
    ] = None,
    seed: Annotated[int | None, typer.Option(metavar="N", min=0, help="Seed of the dispersions.")] = None,
    sampling: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help=(
                "monte_carlo, latin_hypercube, sobol, or sobol_indices: N rows of the design that tells "
                "which dispersion drives what, alone and with others."
            ),
        ),
    ] = None,
    engine: Annotated[str, typer.Option(metavar="NAME", help="threads (this machine) or dask.")] = "threads",
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler, such as tcp://127.0.0.1:8786.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=1, max=1024, help=("Threads, or worker processes; all cores if not given.")
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Folder; runs/<name> if not given.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing campaign.")] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a campaign that was interrupted.")
    ] = False,
    until: Annotated[
        str | None, typer.Option(metavar="CONDITION", help="Stop early, such as 'p_success +- 0.5%'.")
    ] = None,
    compare: Annotated[
        tuple[Path, Path] | None,
        typer.Option("--compare", metavar="A B", hidden=True),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print the success probability only.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Fly many dispersed flights, or a grid of them.

    Afterwards: edl6dof report FOLDER, edl6dof refly FOLDER CASE.

    Exit status: 0 finished, 2 bad input or nothing could be written, 130 interrupted.
    """
    if compare is not None:
        raise refusal("--compare", f"is a command now: edl6dof compare {compare[0]} {compare[1]}")
    load_plugins(scenario)
    from edl6dof.app.campaign import CampaignOptions, run_campaign

    options = CampaignOptions(
        scenario,
        tuple(sets or ()),
        cases,
        seed,
        engine,
        cluster,
        workers,
        out,
        force,
        resume,
        until,
        quiet,
        as_json,
        sampling=sampling,
    )
    raise typer.Exit(run_campaign(options))


def refly(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder of a campaign.")],
    case: Annotated[int, typer.Argument(metavar="CASE", help="Number of the case, as the report names it.")],
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help=("Run folder; runs/<name>_case<number> if not given.")),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing run folder.")] = False,
    replay: Annotated[bool, typer.Option("--replay/--no-replay", help="Write the 3D replay.")] = True,
) -> None:
    """Fly one case of a campaign again, with all its telemetry.

    Exit status: 0 identical to its row, 1 not, 2 bad input.
    """
    if folder.is_dir():
        load_plugins(folder)
    from edl6dof.app.campaign import run_refly

    raise typer.Exit(run_refly(folder, case, out, force, replay))


def faults(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="SCENARIO",
            help="Scenario file or name, tianwen1 if not given; with --resume also the folder of a matrix.",
        ),
    ] = "tianwen1",
    sensors: Annotated[
        bool,
        typer.Option(
            "--sensors", help="Fail instruments instead: every axis, beam, star tracker and flow meter."
        ),
    ] = False,
    kinds: Annotated[
        str,
        typer.Option(
            metavar="LIST",
            help=(
                "Kinds of fault, with commas, or all: those of thrusters; stuck_off if not given, with "
                "--sensors all of instruments."
            ),
        ),
    ] = "",
    components: Annotated[
        str,
        typer.Option(
            metavar="LIST", help="What fails, such as D7,P1, with commas; all that can fail so if not given."
        ),
    ] = "",
    pairs: Annotated[
        bool, typer.Option("--pairs", help="Fail every two of them together instead of each alone.")
    ] = False,
    at: Annotated[
        str | None,
        typer.Option(
            metavar="LIST",
            help=(
                "When: times in s, 'every 10 s' of the nominal flight, or its events, such as "
                "bank_reversal, trim_wing, mortar, ignition, with commas."
            ),
        ),
    ] = None,
    phases: Annotated[
        str,
        typer.Option(
            metavar="LIST",
            help=(
                "When instead: phases, with commas; if not given, one of each kind of control, with "
                "--sensors every one."
            ),
        ),
    ] = "",
    after: Annotated[
        float | None,
        typer.Option(metavar="S", help="Time from the start of the phase to the fault; 1 s if not given."),
    ] = None,
    sets: Sets = None,
    vehicles: Annotated[
        int | None,
        typer.Option(
            "-n",
            "--vehicles",
            metavar="N",
            min=1,
            help="Dispersed vehicles for each fault, as a campaign draws them; the nominal one if not given.",
        ),
    ] = None,
    seed: Annotated[int | None, typer.Option(metavar="N", min=0, help="Seed of the dispersions.")] = None,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, max=1024, help="Threads; as many as there are cores if not given."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Folder; runs/faults-<scenario> if not given.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing matrix.")] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a matrix that was interrupted.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> None:
    """Fail every thruster at every moment, one flight each.

    Kinds of fault of engines, surfaces and parachutes fail each of these; --sensors fails every instrument.

    The folder holds a row for each flight, report.html a map of them: which land, who is named, how fast.
    Afterwards: edl6dof refly FOLDER CASE.

    Exit status: 0 all within limits, 1 not, 2 bad input, 130 interrupted.
    """
    load_plugins(scenario)
    from edl6dof.app.campaign import CampaignOptions
    from edl6dof.app.faults.command import Wanted, run_faults

    wanted = Wanted(sensors, kinds, components, pairs, phases, after, at)
    flown_as = CampaignOptions(
        scenario,
        tuple(sets or ()),
        cases=vehicles,
        seed=seed,
        engine="threads",
        cluster=None,
        workers=workers,
        out=out,
        force=force,
        resume=resume,
        until=None,
        quiet=False,
        as_json=as_json,
        command="faults",
    )
    raise typer.Exit(run_faults(wanted, flown_as))
