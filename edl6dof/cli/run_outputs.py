"""Commands that show or rewrite results."""

from __future__ import annotations

import sys
from contextlib import suppress
from itertools import takewhile
from pathlib import Path
from typing import Annotated

import typer

from edl6dof.api import functions
from edl6dof.cli.group import NOT_WITHIN_LIMITS, UNAVAILABLE, check_target, refusing_damage
from edl6dof.cli.options import Requirements, argument, flag, option
from edl6dof.config.errors import ConfigError, refusal

EXPORTS = ("csv", "mat", "nc", "oem", "aem", "kml")


def replay(
    runs: Annotated[
        list[Path],
        argument(
            "RUN", "Run folders, shown in one scene; the first may be a campaign's. Or one recording (.rrd)."
        ),
    ],
    web: Annotated[bool, flag("Show it in the browser, served to this machine only.", "--web")] = False,
    html: Annotated[Path | None, option("FILE", "Write one HTML file that plays offline.")] = None,
    screenshot: Annotated[
        Path | None, option("FILE", "Write a picture (PNG) without opening a window.")
    ] = None,
    at: Annotated[float | None, option("T", "Time of the picture, s; the end if not given.")] = None,
    page: Annotated[
        str,
        option(
            "NAME",
            "Page to show first: Campaign, Flight, Entry, Parachute, 'Powered descent', Hazards, Control, "
            "Navigation, Thrusters, Tour.",
        ),
    ] = "",
    case: Annotated[
        int | None,
        option("K", "Case of a campaign to fly again and to follow; the nominal flight if not given."),
    ] = None,
    tour: Annotated[bool, flag("Show page Tour first: cameras that follow the stages.", "--tour")] = False,
    video: Annotated[
        Path | None, option("FILE", "Write a film (MP4) of the flight; needs the extra 'video'.")
    ] = None,
    start: Annotated[float | None, option("T", "First time of the film, s.", "--from")] = None,
    end: Annotated[float | None, option("T", "Last time of the film, s.", "--to")] = None,
    length: Annotated[
        float | None,
        option(
            "S", "Duration of the film at constant pace, s; by default a minute, slow at events.", min=0.1
        ),
    ] = None,
    fps: Annotated[float, option("N", "Frames per second of the film.", min=1.0, max=120.0)] = 30.0,
    force: Annotated[bool, flag("Also replace files that you made or changed.", "--force")] = False,
) -> int:
    """Show the 3D replay of one flight, or of several in one scene.

    Exit status: 0 shown or written, 2 bad input, 69 the viewer, or the encoder of films, does not run here.

    edl6dof replay runs/tianwen1
    edl6dof replay runs/tianwen1 --html flight.html
    edl6dof replay runs/tianwen1 --screenshot entry.png --at 120
    edl6dof replay runs/tianwen1 --video flight.mp4
    edl6dof replay runs/tianwen1_mc --case 17
    """
    if tour and page not in ("", "Tour"):
        raise refusal("--tour", f"is the page Tour; --page names {page}")
    if runs[0].is_dir():  # load a campaign's plugins before the families that they join
        functions.activate(runs[0])
    from edl6dof.replay.failures import NoFilm, ViewerFailed

    with refusing_damage(*runs):
        try:
            written = functions.replay(
                *runs,
                web=web,
                html=html,
                screenshot=screenshot,
                at_s=at,
                page=page or ("Tour" if tour else ""),
                case=case,
                video=video,
                start_s=start,
                end_s=end,
                length_s=length,
                fps=fps,
                force=force,
            )
        except (ViewerFailed, NoFilm) as error:
            print(error, file=sys.stderr)
            return UNAVAILABLE
    for path in written:
        print(path)
    return 0


def report(
    run: Annotated[Path, argument("RUN", "Folder of a run or a campaign.")],
    out: Annotated[Path | None, option("FILE", "File to write; RUN/report.html if not given.")] = None,
    pdf: Annotated[
        bool, flag("Write report.pdf instead: outcome, tables, and each figure as a vector page.", "--pdf")
    ] = False,
    png: Annotated[bool, flag("Write report/FIGURE.png instead, each figure for print.", "--png")] = False,
    force: Annotated[bool, flag("Also replace files that you made or changed.", "--force")] = False,
) -> None:
    """Write the report of a run or a campaign: one page with plots.

    The page opens offline, and its plots can be zoomed.

    edl6dof report runs/tianwen1
    edl6dof report runs/tianwen1_mc --pdf
    """
    with refusing_damage(run):
        for path in functions.report(run, out=out, pdf=pdf, png=png, force=force):
            print(path)


def assure(
    folder: Annotated[Path, argument("FOLDER", "Folder of a campaign.")],
    requirements: Requirements = None,
    out: Annotated[
        Path | None, option("FILE", "Page to write: .html or .pdf; FOLDER/assurance.html if not given.")
    ] = None,
    force: Annotated[bool, flag("Also replace a file that you made or changed.", "--force")] = False,
    as_json: Annotated[bool, flag("Print JSON; write a page only to --out.", "--json")] = False,
) -> int:
    """Judge a campaign by requirements on the share of flights.

    Each requirement is verified, violated or undecided, the latter with the number of flights that would
    verify it. The page for a review board contains the verdicts, the worst cases and the evidence for the
    credibility of the results.

    Exit status: 0 all verified, 1 not, 2 bad input.

    edl6dof assure runs/tianwen1_mc
    edl6dof assure runs/tianwen1_mc requirements.yaml --out board.pdf
    """
    check_target(out, (".html", ".pdf"), force=True)
    target = out or (None if as_json else folder / "assurance.html")
    with refusing_damage(folder):
        found = functions.assure(folder, requirements, out=target, force=force)
        if as_json:
            from edl6dof.config.dump import json_text

            print(json_text(found.data), end="")
        else:
            from edl6dof.report.campaign.assurance import assurance_report
            from edl6dof.report.terminal import show_report

            show_report(assurance_report(found))
            print(f"\n{target}")
    return 0 if found.verified else NOT_WITHIN_LIMITS


def plot(
    run: Annotated[Path, argument("RUN", "Run folder.")],
    words: Annotated[
        list[str] | None,
        argument(
            "RUN|CHANNEL",
            "Further run folders to draw over it, then channels, or patterns such as 'truth.rate_*'; "
            "by default all channels are listed.",
        ),
    ] = None,
    against: Annotated[str, option("CHANNEL", "Channel of the x axis.")] = "t_s",
    since: Annotated[float | None, option("T", "First time (s).", "--from")] = None,
    until: Annotated[float | None, option("T", "Last time (s).", "--to")] = None,
    out: Annotated[
        Path | None,
        option("FILE", "File to write: .html, .png, .pdf or .svg; RUN/plots/CHANNEL.html if not given."),
    ] = None,
    force: Annotated[bool, flag("Also replace a file that you made or changed.", "--force")] = False,
) -> None:
    """Plot channels of flights; equal units share a panel.

    edl6dof plot runs/tianwen1 truth.mach truth.height_m
    edl6dof plot runs/tianwen1 runs/heavy truth.mach
    edl6dof plot runs/tianwen1 'truth.rate_*' --from 60 --to 280
    edl6dof plot runs/tianwen1 truth.height_m --against truth.mach --out x.pdf
    """
    from edl6dof.cli.result_views import list_channels, write_plot

    others = [Path(word) for word in takewhile(_is_folder, words or ())]
    channels = (words or [])[len(others) :]
    with refusing_damage(run, *others):
        if channels:
            print(write_plot([run, *others], channels, against, since, until, out, force))
        else:
            list_channels(run)


def _is_folder(word: str) -> bool:
    """True for a folder, and for a path that cannot be the name of a channel."""
    return "/" in word or Path(word).is_dir()


def compare(
    first: Annotated[Path, argument("RUN1", "Run folder, or that of a campaign.")],
    second: Annotated[Path, argument("RUN2", "Another of the same kind.")],
    more: Annotated[list[Path] | None, typer.Argument(hidden=True)] = None,
    out: Annotated[
        Path | None, option("FILE", "Page of two flights; RUN2/compared-with-RUN1.html if not given.")
    ] = None,
    everything: Annotated[
        bool, flag("Print every figure, event and difference of the scenarios; of two flights only.", "--all")
    ] = False,
    force: Annotated[bool, flag("Also replace a file that you made or changed.", "--force")] = False,
    as_json: Annotated[bool, flag("Print JSON instead of tables; of two campaigns only.", "--json")] = False,
) -> None:
    """Compare two flights, or two campaigns.

    For two flights, the result is the figures with the largest differences beyond the variation from flight
    to flight (ten neighbours of the first are flown), and the differences of the scenarios. A page contains
    every figure, and plots with both flights. Two campaigns of the same dispersions are compared in pairs:
    success, and every figure with a significant difference.

    edl6dof compare runs/tianwen1 runs/heavy
    edl6dof compare runs/a_mc runs/b_mc --json
    """
    if more:
        folders = " ".join(map(str, (first, second, *more)))
        words = f"two are compared; to draw the curves of all: edl6dof plot {folders} CHANNEL"
        raise refusal("edl6dof compare", words)
    with suppress(ConfigError):  # plugins of the first flight, whose neighbours are flown
        functions.activate(first / "scenario.yaml")
    from edl6dof.cli.result_views import compare_campaigns, compare_flights

    with refusing_damage(first, second):
        campaigns = [(folder / "campaign.json").is_file() for folder in (first, second)]
        if all(campaigns):
            if out is not None:
                raise refusal("--out", "is the page of two flights; a comparison of campaigns is printed")
            compare_campaigns(first, second, as_json)
            return
        if any(campaigns):
            one, two = (second, first) if campaigns[1] else (first, second)
            raise refusal(two, f"is no campaign, and {one} is one; compare two flights, or two campaigns")
        if as_json:
            raise refusal("--json", "is of two campaigns; two flights are compared in a page")
        compare_flights(first, second, out, force, everything)


def export(
    run: Annotated[Path, argument("RUN", "Run folder.")],
    file: Annotated[
        Path | None, argument("FILE", "File to write; inside RUN if not given, - for standard output.")
    ] = None,
    form: Annotated[
        str,
        option(
            "FORM",
            "csv, mat (MATLAB), nc (netCDF), oem or aem (CCSDS orbit, attitude), kml (on a globe).",
            "--format",
        ),
    ] = "",
    nesc: Annotated[
        bool, flag("Use the columns and English units of NASA's NESC check cases.", "--nesc")
    ] = False,
    force: Annotated[bool, flag("Also replace a file that you made or changed.", "--force")] = False,
) -> None:
    """Write the telemetry of a run in the format of another program.

    edl6dof export runs/tianwen1 --format csv
    edl6dof export runs/tianwen1 - --nesc
    """
    if nesc == bool(form) or form not in ("", *EXPORTS):
        raise typer.BadParameter(f"name one form: --format {', '.join(EXPORTS)}, or --nesc")
    from edl6dof.config.wording import counted
    from edl6dof.export.forms import FILES, export_text, write_export

    form = form or "nesc"
    with refusing_damage(run):
        if file == Path("-"):
            sys.stdout.write(export_text(run, form))
            return
        target = file or run / FILES[form]
        print(f"{target}: {counted(write_export(run, form, target, force), 'row')}")
