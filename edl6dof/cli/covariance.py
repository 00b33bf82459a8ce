"""The command that forms covariance from a few dozen flights."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from edl6dof.cli.options import Sets, load_plugins


def covariance(
    campaign: Annotated[
        str,
        typer.Argument(
            metavar="CAMPAIGN",
            help=(
                "Campaign file or name, tianwen1_mc if not given; or the folder of a finished campaign, to "
                "be held against it."
            ),
        ),
    ] = "tianwen1_mc",
    at: Annotated[
        str,
        typer.Option(
            metavar="EVENT",
            help="entry (its peaks), parachute, trim_wing, backshell or touchdown.",
        ),
    ] = "parachute",
    sets: Sets = None,
    pairs: Annotated[
        int,
        typer.Option(
            metavar="N", min=8, max=4096, help="Pairs of flights; more where there are more dispersions."
        ),
    ] = 24,
    each: Annotated[
        bool, typer.Option("--each", help="Step each dispersion alone, too: where is it linear, where not.")
    ] = False,
    seed: Annotated[
        int | None, typer.Option(metavar="N", min=0, help="Seed of the steps; the campaign's if not given.")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, max=1024, help="Threads; as many as there are cores if not given."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write the error budget (.csv) or the ellipse (.png, .pdf, .svg)."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Spread of an event, and what each dispersion gives to it.

    Every dispersion is a standard deviation high in half of the flights and low in their mirror images, all
    at once; a twentieth of the flights of a campaign gives its ellipse and its error budget.

    Exit status: 0 formed, 2 bad input or nothing could be written, 130 interrupted.
    """
    load_plugins(campaign)
    from edl6dof.app.covariance import CovarianceOptions, run_covariance

    options = CovarianceOptions(campaign, at, tuple(sets or ()), pairs, each, seed, workers, out, force)
    raise typer.Exit(run_covariance(options))
