"""Commands about one scenario: fly it, check it, begin one of your own, and what may stand in it."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from edl6dof.cli.options import Sets, load_plugins


def fly(
    scenario: Annotated[
        str | None,
        typer.Argument(
            metavar="SCENARIO",
            help="Scenario file, or the name of a shipped one (edl6dof scenarios); none with --from.",
        ),
    ] = None,
    sets: Sets = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Run folder; runs/<name>, or the next number, if not given."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing run folder.")] = False,
    replay: Annotated[bool, typer.Option("--replay/--no-replay", help="Write the 3D replay.")] = True,
    report: Annotated[bool, typer.Option("--report", help="Write the report too.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print the outcome only.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the summary as JSON instead of tables.")
    ] = False,
    save_state: Annotated[
        float | None,
        typer.Option(metavar="T", help="Keep the state at time T (s) in the run folder, as state.npz."),
    ] = None,
    start: Annotated[
        Path | None,
        typer.Option("--from", metavar="STATE", help="Go on from a saved state, which brings its scenario."),
    ] = None,
) -> None:
    """Fly one scenario and write its run folder.

    Exit status: 0 landed within limits (or flown to the end, where mission.goal is time), 1 not, 2 bad input,
    130 interrupted.
    """
    with _uncollected():
        load_plugins(scenario)
        from edl6dof.app.fly import FlyOptions, run_fly

        options = FlyOptions(
            scenario, tuple(sets or ()), out, force, replay, report, quiet, as_json, save_state, start
        )
        raise typer.Exit(run_fly(options))


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


def check(
    files: Annotated[list[str], typer.Argument(metavar="SCENARIO", help="Scenario files or names.")],
    sets: Sets = None,
) -> None:
    """Check scenario files: each mistake by file, line and key.

    Nothing is flown.

    Exit status: 0 no mistake, 2 mistakes.
    """
    load_plugins(*files)
    from edl6dof.app.inspect import run_check

    raise typer.Exit(run_check(files, tuple(sets or ())))


def trust(
    files: Annotated[
        list[str], typer.Argument(metavar="FILE", help="Plugins (.py), or scenarios that name plugins.")
    ],
    yes: Annotated[bool, typer.Option("--yes", help="Accept without asking.")] = False,
) -> None:
    """Show the source of plugins and accept it.

    It may then run on this account, until it changes.

    Exit status: 0 accepted, 1 not accepted, 2 bad input.
    """
    from edl6dof.app.trust import run_trust

    raise typer.Exit(run_trust(files, yes))


def serve(
    scenario: Annotated[str, typer.Argument(metavar="SCENARIO", help="Scenario file or name.")],
    sets: Sets = None,
    port: Annotated[
        int, typer.Option(metavar="N", min=0, max=65535, help="Port to listen on; any that is free if 0.")
    ] = 0,
) -> None:
    """Serve flights to programs, over a socket of this machine.

    The first line printed is address and port; docs/serve.md has the protocol. Ctrl-C ends it.

    Exit status: 0 ended by Ctrl-C, 2 bad input, 69 msgpack is not installed.
    """
    load_plugins(scenario)
    from edl6dof.app.serve import run_serve

    raise typer.Exit(run_serve(scenario, tuple(sets or ()), port))


def scenarios(
    scenario: Annotated[
        str | None,
        typer.Argument(
            metavar="SCENARIO", help="Scenario whose file is printed; all are listed if not given."
        ),
    ] = None,
) -> None:
    """List the shipped scenarios, or print the file of one."""
    from edl6dof.app.scenarios import run_scenarios

    raise typer.Exit(run_scenarios(scenario))


def params(
    path: Annotated[
        str,
        typer.Argument(
            metavar="PATH", help=("Dotted path to begin at, such as vehicle.parachutes, or part of a name.")
        ),
    ] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List parameters: default, unit, bounds, meaning, status."""
    load_plugins()
    from edl6dof.app.params import run_params

    raise typer.Exit(run_params(path, as_json))


def schema(
    scenario: Annotated[
        str | None,
        typer.Argument(metavar="SCENARIO", help="Scenario whose plugins the files may choose from."),
    ] = None,
    of: Annotated[
        str, typer.Option("--of", metavar="KIND", help="scenario (campaigns, too), vehicle or planet.")
    ] = "scenario",
) -> None:
    """JSON schema of scenario, vehicle or planet files."""
    load_plugins(scenario)
    from edl6dof.app.inspect import run_schema

    raise typer.Exit(run_schema(of))
