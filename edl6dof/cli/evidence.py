"""Commands that compare the simulator with closed forms and with papers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from edl6dof.cli.options import Sets, load_plugins


def verify(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME", help="Check cases; all if none is named.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plots: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Draw each case that has a history, as FOLDER/NAME.png."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace files of yours, too.")] = False,
    golden: Annotated[
        bool, typer.Option("--golden", help="Fly the golden flights instead; every bit must be as shipped.")
    ] = False,
) -> None:
    """Check the simulator against closed forms and published tables.

    Everything is computed on this machine, and conservation laws are checked too. With --golden every
    shipped scenario and a small campaign are flown and compared bit for bit with what this version gave
    when it was made; NAME then names flights.

    Exit status: 0 all within tolerance or identical, 1 not, 2 bad input.
    """
    if golden:
        from edl6dof.app.golden import run_golden

        raise typer.Exit(run_golden(names or [], as_json))
    from edl6dof.app.verify import run_verify

    raise typer.Exit(run_verify(names or [], as_json, plots, force))


def figures(
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO", help="Scenario file, or the name of a shipped one.")
    ],
    sets: Sets = None,
    flights: Annotated[
        int | None, typer.Option("-n", "--flights", metavar="N", help="Flights; 30 if not given.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> None:
    """Mean and spread of a scenario's figures over many flights.

    They differ by a millionth of a metre per second at their start. The digits of one flight are one draw of
    many: what a document quotes is made by this command.

    Exit status: 0 every flight within limits, 1 not, 2 bad input, 130 interrupted.
    """
    load_plugins(scenario)
    from edl6dof.app.figures import run_figures

    raise typer.Exit(run_figures(scenario, tuple(sets or ()), flights, as_json))


def validate(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME", help="Missions, by name or file; all shipped ones if none is named."),
    ] = None,
    flights: Annotated[
        int | None,
        typer.Option("-n", "--flights", metavar="N", help="Dispersed flights of each; 200 if not given."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            "--jobs", "--workers", metavar="N", min=1, max=1024, help="Threads; all cores if not given."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Folder; runs/validation if not given.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing folder.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of the table.")] = False,
) -> None:
    """Compare dispersed flights of missions with what was published.

    A mission is a scenario whose file disperses it and which says what was published of its flight.
    Afterwards, the same flights with a report: edl6dof campaign NAME -n N.

    Exit status: 0 nine in ten flown values within three sigma, 1 not, 2 bad input, 130 interrupted.
    """
    load_plugins(*(names or []))
    from edl6dof.app.validate import ValidateOptions, run_validate

    raise typer.Exit(run_validate(ValidateOptions(tuple(names or ()), flights, workers, out, force, as_json)))


def calibrate(
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO", help="Scenario with a calibration section, such as tianwen1.")
    ],
    sets: Sets = None,
    flights: Annotated[
        int | None,
        typer.Option(
            "-n",
            "--flights",
            metavar="N",
            help="Flights of each of its three designs, as docs/calibration.md calls them.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Folder; runs/calibration-<name> if not given.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing folder.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
) -> None:
    """Fit what is uncertain to what is published of a flight.

    Writes calibrated.yaml, a scenario that extends this one.

    Exit status: 0 every figure explained within two sigma, 1 not, 2 bad input, 130 interrupted.
    """
    load_plugins(scenario)
    from edl6dof.app.calibrate import CalibrateOptions, run_calibrate

    raise typer.Exit(
        run_calibrate(CalibrateOptions(scenario, tuple(sets or ()), flights, out, force, as_json))
    )


def study(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Study; without one, they are listed.")
    ] = None,
    runs: Annotated[
        int | None,
        typer.Option(
            "-n",
            "--runs",
            metavar="N",
            help="Flights; as many as the paper's, or the study's own number, if not given.",
        ),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option("--only", metavar="LAW", help="One law of those that a study compares; repeatable."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Folder; runs/study-<name> if not given.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing folder.")] = False,
    quick: Annotated[bool, typer.Option("--quick", help="Fly few runs, to see that it works.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of the table.")] = False,
) -> None:
    """Repeat a paper's experiment: computed beside published.

    Exit status: 0 every published requirement is kept, 1 not, 2 bad input, 130 interrupted.
    """
    load_plugins()
    from edl6dof.app.study import StudyOptions, run_study

    raise typer.Exit(run_study(StudyOptions(name, runs, tuple(only or ()), out, force, quick, as_json)))
