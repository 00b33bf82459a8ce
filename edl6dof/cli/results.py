"""Commands that show or rewrite what was flown."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from edl6dof.cli.options import load_plugins
from edl6dof.config.errors import refusal

EXPORTS = ("csv", "mat", "nc", "oem", "aem")


def replay(
    runs: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN",
            help="Run folders, shown in one scene; the first may be a campaign's. Or one recording (.rrd).",
        ),
    ],
    web: Annotated[
        bool, typer.Option("--web", help="Show it in the browser, served to this machine only.")
    ] = False,
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write one HTML file that plays offline.")
    ] = None,
    screenshot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a picture (PNG) without opening a window.")
    ] = None,
    at: Annotated[
        float | None, typer.Option(metavar="T", help="Time of the picture, s; the end if not given.")
    ] = None,
    page: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help=(
                "Page in front: Flight, Entry, Parachute, 'Powered descent', Hazards, Control, Navigation, "
                "Thrusters, Tour."
            ),
        ),
    ] = "",
    tour: Annotated[
        bool, typer.Option("--tour", help="Page Tour in front: cameras that follow the stages.")
    ] = False,
    video: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Write a film (MP4) of the page; needs ffmpeg or the extra 'video'."
        ),
    ] = None,
    start: Annotated[
        float | None, typer.Option("--from", metavar="T", help="First time of the film, s.")
    ] = None,
    end: Annotated[float | None, typer.Option("--to", metavar="T", help="Last time of the film, s.")] = None,
    length: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            min=0.1,
            help="How long the film is, s; if not given, as long as the flight, or 60 s.",
        ),
    ] = None,
    fps: Annotated[
        float, typer.Option(metavar="N", min=1.0, max=120.0, help="Its frames per second.")
    ] = 24.0,
    force: Annotated[bool, typer.Option("--force", help="Replace files of yours, too.")] = False,
) -> None:
    """Show the 3D replay of one flight, or of several in one scene.

    Exit status: 0 shown or written, 2 bad input, 69 the viewer, or the encoder of films, does not run here.
    """
    from edl6dof.app.exit_status import refusing_damage

    if tour and page not in ("", "Tour"):
        raise refusal("--tour", f"is the page Tour; --page names {page}")
    if runs[0].is_dir():  # where it is a campaign, its cases are flown again: it keeps no trajectories
        load_plugins(runs[0])
    from edl6dof.app.replay import FilmOptions, ReplayOptions, run_replay

    with refusing_damage(*runs):
        status = run_replay(
            ReplayOptions(
                tuple(runs),
                web,
                html,
                screenshot,
                at,
                page or ("Tour" if tour else ""),
                force,
                video,
                FilmOptions(start, end, length, fps),
            )
        )
    raise typer.Exit(status)


def report(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run or a campaign.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File to write; RUN/report.html if not given.")
    ] = None,
    pdf: Annotated[
        bool,
        typer.Option(
            "--pdf", help=("Write report.pdf instead: outcome, tables, and each figure as a vector page.")
        ),
    ] = False,
    png: Annotated[
        bool, typer.Option("--png", help="Write report/FIGURE.png instead, each figure for print.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace files of yours, too.")] = False,
) -> None:
    """Write the report of a run or a campaign: one page with plots.

    The page opens offline, and its plots can be zoomed.
    """
    from edl6dof.app.exit_status import refusing_damage
    from edl6dof.app.report import run_report

    with refusing_damage(run):
        status = run_report(run, out, pdf, png, force)
    raise typer.Exit(status)


def plot(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder.")],
    channels: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="CHANNEL",
            help="Channels, or patterns such as 'truth.rate_*'; without any, all are listed.",
        ),
    ] = None,
    against: Annotated[str, typer.Option(metavar="CHANNEL", help="Channel of the x axis.")] = "t_s",
    since: Annotated[float | None, typer.Option("--from", metavar="T", help="First time (s).")] = None,
    until: Annotated[float | None, typer.Option("--to", metavar="T", help="Last time (s).")] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help=("File to write: .html, .png, .pdf or .svg; RUN/plots/CHANNEL.html if not given."),
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file of yours, too.")] = False,
) -> None:
    """Plot channels of a run; those of one unit share a panel."""
    from edl6dof.app.exit_status import refusing_damage
    from edl6dof.app.plot import run_plot

    with refusing_damage(run):
        status = run_plot(run, channels or [], against, since, until, out, force)
    raise typer.Exit(status)


def compare(
    first: Annotated[Path, typer.Argument(metavar="RUN1", help="Run folder, or that of a campaign.")],
    second: Annotated[Path, typer.Argument(metavar="RUN2", help="Another of the same kind.")],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help=("Page of two flights; RUN2/compared-with-RUN1.html if not given.")
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file of yours, too.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print JSON instead of tables; of two campaigns only.")
    ] = False,
) -> None:
    """Compare two flights, or two campaigns.

    Of two flights the figures stand side by side, what the scenarios differ in is listed, and every plot
    shows one flight over the other. Two campaigns of the same dispersions are compared in pairs: success, and
    every figure that differs clearly.
    """
    from edl6dof.app.compare import run_compare
    from edl6dof.app.exit_status import refusing_damage

    with refusing_damage(first, second):
        status = run_compare(first, second, out, force, as_json)
    raise typer.Exit(status)


def export(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder.")],
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="FILE", help=("File to write; inside RUN if not given, - for standard output.")
        ),
    ] = None,
    form: Annotated[
        str,
        typer.Option(
            "--format",
            metavar="FORM",
            help=("csv, mat (MATLAB), nc (netCDF), oem or aem (CCSDS orbit, attitude)."),
        ),
    ] = "",
    nesc: Annotated[
        bool, typer.Option("--nesc", help=("In the columns and English units of NASA's NESC check cases."))
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace a file of yours, too.")] = False,
) -> None:
    """Write the telemetry of a run in the form of another program."""
    if nesc == bool(form) or form not in ("", *EXPORTS):
        raise typer.BadParameter(f"name one form: --format {', '.join(EXPORTS)}, or --nesc")
    from edl6dof.app.exit_status import refusing_damage
    from edl6dof.app.export import run_export

    with refusing_damage(run):
        status = run_export(run, form or "nesc", file, force)
    raise typer.Exit(status)
