"""The command line.  Heavy imports happen inside the commands, so that ``--help`` is quick."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup


class Commands(TyperGroup):
    """All commands: bad input ends with status 2 and one line for each problem, Ctrl-C with 130, never with a
    traceback.
    """

    def invoke(self, ctx: Any) -> object:
        """Run the command that was asked for."""
        from edl6dof.app import ending
        from edl6dof.config.errors import ConfigError

        try:
            return super().invoke(ctx)
        except ConfigError as error:
            print(error, file=sys.stderr)
            raise typer.Exit(ending.BAD_INPUT) from None
        except KeyboardInterrupt:
            print("interrupted; nothing was written", file=sys.stderr)
            raise typer.Exit(ending.INTERRUPTED) from None
        except BrokenPipeError:
            sys.stdout = open(os.devnull, "w")  # noqa: SIM115  what is still in the buffer has nowhere to go
            raise typer.Exit(ending.BROKEN_PIPE) from None


EXIT_STATUS = """Exit status: 0 done, and within all limits; 1 not within limits; 2 bad input; 69 something is
missing on this machine; 70 a defect of the program; 130 interrupted."""

app = typer.Typer(
    cls=Commands,
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    epilog=EXIT_STATUS,
)

EXPORTS = ("csv", "mat", "nc", "oem", "aem")


def _show_version(wanted: bool) -> None:
    if wanted:
        from edl6dof import __version__

        print(f"edl6dof {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Print name and version.")
    ] = False,
) -> None:
    """Six-degree-of-freedom Mars entry, descent and landing."""


Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="PATH=VALUE", help=("Change one parameter (edl6dof params lists them); repeatable.")
    ),
]

Trust = Annotated[
    bool,
    typer.Option(
        "--trust",
        help=("Load the plugins that a received run or campaign names: their code runs with your rights."),
    ),
]


@app.command()
def fly(
    scenario: Annotated[
        str | None, typer.Argument(metavar="SCENARIO", help="Scenario file, or the name of a shipped one.")
    ] = None,
    sets: Sets = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Run folder; runs/<name> if not given.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing run folder.")] = False,
    replay: Annotated[bool, typer.Option("--replay/--no-replay", help="Write the 3D replay.")] = True,
    report: Annotated[bool, typer.Option("--report", help="Write the report too.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print the verdict only.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the summary as JSON instead of tables.")
    ] = False,
    save_state: Annotated[
        float | None, typer.Option(metavar="T", help="Keep the state at time T (s) as state.npz.")
    ] = None,
    start: Annotated[
        Path | None, typer.Option("--from", metavar="STATE", help="Continue a saved state.")
    ] = None,
    trust: Trust = False,
) -> None:
    """Fly one scenario and write its run folder.

    Exit status: 0 landed within limits (or flown to the end, where mission.goal is time), 1 not, 2 bad input,
    130 interrupted.
    """
    with _uncollected():
        _load_plugins(scenario, trust=trust)
        from edl6dof.app.fly import FlyOptions, run_fly

        options = FlyOptions(
            scenario, tuple(sets or ()), out, force, replay, report, quiet, as_json, save_state, start
        )
        raise typer.Exit(run_fly(options))


@app.command()
def check(
    files: Annotated[list[str], typer.Argument(metavar="SCENARIO", help="Scenario files or names.")],
    sets: Sets = None,
    trust: Trust = False,
) -> None:
    """Check scenario files; name each mistake with file, line and key."""
    _load_plugins(*files, trust=trust)
    from edl6dof.app.inspect import run_check

    raise typer.Exit(run_check(files, tuple(sets or ())))


@app.command()
def params(
    path: Annotated[
        str,
        typer.Argument(
            metavar="PATH", help=("Dotted path to begin at, such as vehicle.parachute, or part of a name.")
        ),
    ] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List parameters: default, unit, bounds, meaning, status."""
    _load_plugins()
    from edl6dof.app.params import run_params

    raise typer.Exit(run_params(path, as_json))


@app.command()
def schema() -> None:
    """JSON schema of scenario files, for editors."""
    _load_plugins()
    from edl6dof.app.inspect import run_schema

    raise typer.Exit(run_schema())


@app.command()
def replay(
    runs: Annotated[
        list[Path],
        typer.Argument(metavar="RUN", help=("Run folders, in one scene; the first may be a campaign's.")),
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
            help=("Page in front: Flight, Entry, Parachute, 'Powered descent', Control, Thrusters."),
        ),
    ] = "",
    force: Annotated[bool, typer.Option("--force", help="Replace existing files.")] = False,
    trust: Trust = False,
) -> None:
    """Show the 3D replay of one flight, or of several in one scene.

    Exit status: 0 shown or written, 2 bad input, 69 the viewer does not run here.
    """
    from edl6dof.app.ending import refusing_damage

    if runs[0].is_dir():  # where it is a campaign, its cases are flown again: it keeps no trajectories
        _load_plugins(runs[0], trust=trust)
    from edl6dof.app.replay import ReplayOptions, run_replay

    with refusing_damage(*runs):
        status = run_replay(ReplayOptions(tuple(runs), web, html, screenshot, at, page, force))
    raise typer.Exit(status)


@app.command()
def report(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run or a campaign.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File to write; RUN/report.html if not given.")
    ] = None,
    pdf: Annotated[
        bool,
        typer.Option(
            "--pdf", help=("Write report.pdf instead: verdict, tables, and each figure as a vector page.")
        ),
    ] = False,
    png: Annotated[
        bool, typer.Option("--png", help="Write report/FIGURE.png instead, each figure for print.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace existing files.")] = False,
) -> None:
    """Write the report of a run or a campaign: one page with plots.

    The page opens offline, and its plots can be zoomed.
    """
    from edl6dof.app.ending import refusing_damage
    from edl6dof.app.report import run_report

    with refusing_damage(run):
        status = run_report(run, out, pdf, png, force)
    raise typer.Exit(status)


@app.command()
def plot(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder.")],
    channels: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="CHANNEL", help=("Channels, or patterns such as 'truth.rate_*'; all are listed if none.")
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
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Plot channels of a run; those of one unit share a panel."""
    from edl6dof.app.ending import refusing_damage
    from edl6dof.app.plot import run_plot

    with refusing_damage(run):
        status = run_plot(run, channels or [], against, since, until, out, force)
    raise typer.Exit(status)


@app.command()
def compare(
    first: Annotated[Path, typer.Argument(metavar="RUN1", help="Run folder.")],
    second: Annotated[Path, typer.Argument(metavar="RUN2", help="Run folder.")],
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help=("Page to write; RUN2/compared-with-RUN1.html if not given.")),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Compare two flights: figures, scenarios, every plot.

    Figures stand side by side, what the scenarios differ in is listed, and every plot shows one flight over
    the other.
    """
    from edl6dof.app.compare import run_compare
    from edl6dof.app.ending import refusing_damage

    with refusing_damage(first, second):
        status = run_compare(first, second, out, force)
    raise typer.Exit(status)


@app.command()
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
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Write the telemetry of a run in the form of another program."""
    if nesc == bool(form) or form not in ("", *EXPORTS):
        raise typer.BadParameter(f"name one form: --format {', '.join(EXPORTS)}, or --nesc")
    from edl6dof.app.ending import refusing_damage
    from edl6dof.app.export import run_export

    with refusing_damage(run):
        status = run_export(run, form or "nesc", file, force)
    raise typer.Exit(status)


@app.command()
def verify(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME", help="Check cases; all if none is named.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plots: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write a PNG for each case that has a history.")
    ] = None,
) -> None:
    """Check the simulator against closed forms and published tables.

    Everything is computed on this machine, and conservation laws are checked too.

    Exit status: 0 all within tolerance, 1 not, 2 bad input.
    """
    from edl6dof.app.verify import run_verify

    raise typer.Exit(run_verify(names or [], as_json, plots))


@app.command()
def study(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Study; without one, they are listed.")
    ] = None,
    runs: Annotated[
        int | None,
        typer.Option("-n", "--runs", metavar="N", help="Flights; as many as published if not given."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Folder; runs/study-<name> if not given.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing folder.")] = False,
    quick: Annotated[bool, typer.Option("--quick", help="Fly few runs, to see that it works.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of the table.")] = False,
) -> None:
    """Repeat a paper's experiment: computed beside published.

    Exit status: 0 every published bound is kept, 1 not, 2 bad input, 130 interrupted.
    """
    _load_plugins()
    from edl6dof.app.study import StudyOptions, run_study

    raise typer.Exit(run_study(StudyOptions(name, runs, out, force, quick, as_json)))


@app.command()
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
        str | None, typer.Option(metavar="TEXT", help="Stop early, such as 'p_success +- 0.5%'.")
    ] = None,
    compare: Annotated[
        tuple[Path, Path] | None,
        typer.Option("--compare", metavar="A B", help="Compare two finished campaigns instead."),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print the success probability only.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    trust: Trust = False,
) -> None:
    """Fly many dispersed flights, or a grid of them.

    Afterwards: edl6dof report FOLDER, edl6dof refly FOLDER CASE.

    Exit status: 0 finished, 2 bad input or nothing could be written, 130 interrupted.
    """
    if compare is None:
        _load_plugins(scenario, trust=trust)
    from edl6dof.app.campaign import CampaignOptions, run_campaign, run_compare

    if compare is not None:
        raise typer.Exit(run_compare(*compare, as_json))
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
    )
    raise typer.Exit(run_campaign(options))


@app.command()
def refly(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder of a campaign.")],
    case: Annotated[int, typer.Argument(metavar="CASE", help="Number of the case, as the report names it.")],
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help=("Run folder; runs/<name>_case<number> if not given.")),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing run folder.")] = False,
    replay: Annotated[bool, typer.Option("--replay/--no-replay", help="Write the 3D replay.")] = True,
    trust: Trust = False,
) -> None:
    """Fly one case of a campaign again, with all its telemetry.

    Exit status: 0 identical to its row, 1 not, 2 bad input.
    """
    if folder.is_dir():
        _load_plugins(folder, trust=trust)
    from edl6dof.app.campaign import run_refly

    raise typer.Exit(run_refly(folder, case, out, force, replay))


@app.command()
def faults(
    scenario: Annotated[
        str, typer.Argument(metavar="SCENARIO", help="Scenario file, or the name of a shipped one.")
    ] = "tianwen1",
    kinds: Annotated[
        str, typer.Option(metavar="LIST", help=("Kinds, with commas: stuck_off, stuck_on, degraded, or all."))
    ] = "stuck_off",
    phases: Annotated[
        str,
        typer.Option(
            metavar="LIST", help=("Phases, with commas; if not given, one of each kind of control.")
        ),
    ] = "",
    thrusters: Annotated[
        str, typer.Option(metavar="LIST", help="Thrusters, with commas; all if not given.")
    ] = "",
    after: Annotated[
        float, typer.Option(metavar="S", help="Time from the start of the phase to the fault.")
    ] = 1.0,
    sets: Sets = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Folder; runs/faults-<scenario> if not given.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing folder.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of the matrix.")] = False,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, max=1024, help="Threads; as many as there are cores if not given."),
    ] = None,
    trust: Trust = False,
) -> None:
    """Fail every thruster in every phase, one flight each.

    The matrix tells which flights survive, which faults are found out, and how fast.

    Exit status: 0 all landed within limits, 1 not, 2 bad input, 130 interrupted.
    """
    _load_plugins(scenario, trust=trust)
    from edl6dof.app.faults import FaultOptions, run_faults

    options = FaultOptions(
        scenario, kinds, phases, thrusters, after, tuple(sets or ()), out, force, as_json, workers
    )
    raise typer.Exit(run_faults(options))


@app.command()
def version() -> None:
    """Print the version."""
    from edl6dof import __version__

    print(__version__)


def _load_plugins(*operands: str | Path | None, trust: bool = False) -> None:
    """Load the plugins of what is to be flown and of the environment, before anything is imported that they
    must join.
    """
    from edl6dof.config.plugin_scan import files_from_environment, files_naming_plugins

    given = [operand for operand in operands if operand is not None]
    if files_from_environment() or any(file for operand in given for file in files_naming_plugins(operand)):
        from edl6dof.plugins import activate

        activate(given, trust)


@contextmanager
def _uncollected() -> Iterator[None]:
    """Without Python's search for cycles of garbage, which for one flight finds a few megabytes in a twelfth
    of its time.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def main() -> None:
    """Entry point; what no command has foreseen is a defect of the program, and has an exit status of its
    own.
    """
    try:
        app(prog_name="edl6dof")
    except Exception:
        import traceback

        from edl6dof.app.ending import DEFECT

        traceback.print_exc()
        print(
            (
                "edl6dof: this is a defect of the program, not of what you gave it; please report it with "
                "these lines"
            ),
            file=sys.stderr,
        )
        sys.exit(DEFECT)
