"""Commands for one scenario, which fly, check, show or serve it; and for the machine code and the version."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from shutil import rmtree
from tempfile import TemporaryDirectory
from typing import Annotated

from edl6dof.api.functions import activate
from edl6dof.cli.group import UNAVAILABLE
from edl6dof.cli.options import Scenario, Sets, argument, flag, option
from edl6dof.config.errors import refusal


def fly(
    scenario: Annotated[
        str | None,
        argument(
            "SCENARIO", "Scenario file, or the name of a shipped one (edl6dof scenarios); none with --from."
        ),
    ] = None,
    sets: Sets = None,
    out: Annotated[
        Path | None, option("FOLDER", "Run folder; runs/<name>, or the next number, if not given.")
    ] = None,
    force: Annotated[bool, flag("Replace an existing run folder.", "--force")] = False,
    replay: Annotated[bool, flag("Write the 3D replay.", "--replay/--no-replay")] = True,
    report: Annotated[bool, flag("Write the report too.", "--report")] = False,
    verbose: Annotated[
        bool, flag("Print limits, timeline, published flight and navigation, too.", "--verbose", "-v")
    ] = False,
    quiet: Annotated[bool, flag("Print the outcome only.", "--quiet", "-q")] = False,
    as_json: Annotated[bool, flag("Print the summary as JSON instead.", "--json")] = False,
    save_state: Annotated[
        float | None, option("T", "Save the state at time T (s) in the run folder, as state.npz.")
    ] = None,
    start: Annotated[
        Path | None, option("STATE", "Continue from a saved state, which contains its scenario.", "--from")
    ] = None,
    live: Annotated[bool, flag("Show the flight in the viewer while it is flown.", "--live")] = False,
    pace: Annotated[float, option("X", "Speed of --live, a multiple of real time.", min=0.01)] = 4.0,
) -> int:
    """Fly one scenario and write its run folder.

    Exit status: 0 landed within limits (or flown to the end, where mission.goal is time), 1 not, 2 bad input,
    69 the viewer does not run here, 130 interrupted.

    edl6dof fly tianwen1
    edl6dof fly tianwen1 -v
    edl6dof fly tianwen1 --out runs/heavy --set vehicle.mass.entry_kg=1350
    edl6dof fly tianwen1 --out runs/first --save-state 300
    edl6dof fly --from runs/first/state.npz --out runs/second
    """
    if save_state is not None and not (math.isfinite(save_state) and save_state >= 0.0):
        raise refusal("--save-state", f"must be a time in s, 0 or more (got {save_state:g})")
    if start is not None and scenario is not None:
        raise refusal("--from", "a saved state brings its own scenario; give no other")
    if live and (start is not None or save_state is not None):
        raise refusal("--live", "shows a whole flight; leave out --from and --save-state")
    activate(scenario)
    changes = tuple(sets or ())
    from rich.console import Console

    from edl6dof.api.flight import Flight, flown_into
    from edl6dof.api.functions import report as write_report
    from edl6dof.api.progress import flight_progress
    from edl6dof.manifest import listed
    from edl6dof.replay.failures import ViewerFailed
    from edl6dof.report.terminal import headline, show_flight
    from edl6dof.runs.files import default_folder
    from edl6dof.scenario.loading import load_scenario
    from edl6dof.sim import flight as sim
    from edl6dof.sim.checkpoint import State

    if scenario is None and start is None:
        words = "name a scenario, such as tianwen1, or continue a state with --from STATE"
        raise refusal("edl6dof fly", words)
    state = None if start is None else State.load(start)
    loaded = sim.continue_from(state, changes) if state else load_scenario(str(scenario), changes)
    target = out or default_folder(loaded.scenario.name, force)
    talk = not (quiet or as_json)

    def flown() -> Flight:
        if live:
            from edl6dof.api.live import fly_live

            return fly_live(loaded, pace)
        with flight_progress(talk) as progress:
            return Flight.of(sim.fly(loaded, start=state, save_at_s=save_state, progress=progress))

    try:
        flight = flown_into(target, flown, replay=replay, force=force, release=True)
    except ViewerFailed as error:
        print(error, file=sys.stderr)
        return UNAVAILABLE
    if report:
        write_report(target)
    console = Console(highlight=False, soft_wrap=True)
    if as_json:
        print((target / "summary.json").read_text(encoding="utf-8"), end="")
    elif quiet:
        console.print(headline(flight))
    else:
        show_flight(console, flight, verbose)
        console.print(f"{target}: {listed(target)}", markup=False)
        console.print(f"next: edl6dof report {target}, edl6dof replay {target}", markup=False)
    if save_state is not None and flight.saved is None:
        words = f"no state was saved; the flight ended at {flight.time_s:.2f} s"
        print(f"--save-state {save_state:g}: {words}", file=sys.stderr)
    return 0 if flight.success else 1


def check(
    files: Annotated[list[str], argument("SCENARIO", "Scenario files or names.")], sets: Sets = None
) -> int:
    """Check scenario files; report mistakes with file, line and key.

    Nothing is flown.

    Exit status: 0 no mistake, 2 mistakes.

    edl6dof check my.yaml
    edl6dof check my.yaml my_mc.yaml --set seed=3
    """
    activate(*files)
    from edl6dof.cli.inspection import check_files

    return check_files(files, sets or ())


def trust(
    files: Annotated[list[str], argument("FILE", "Plugins (.py), or scenarios that name plugins.")],
    yes: Annotated[bool, flag("Accept without asking.", "--yes")] = False,
) -> int:
    """Show the source of plugins and accept it.

    It may then run on this account, until it changes.

    Exit status: 0 accepted, 1 not accepted, 2 bad input.

    edl6dof trust my_law.py
    edl6dof trust received/scenario.yaml
    """
    from edl6dof.cli.inspection import trust_plugins

    return trust_plugins(files, yes)


def serve(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file or name.")],
    sets: Sets = None,
    port: Annotated[int, option("N", "Port to listen on; any that is free if 0.", min=0, max=65535)] = 0,
) -> int:
    """Serve flights to programs, over a socket of this machine.

    The first line printed is address and port; docs/serve.md has the protocol. Ctrl-C ends it.

    Exit status: 0 ended by Ctrl-C, 2 bad input, 69 msgpack is not installed.

    edl6dof serve tianwen1
    edl6dof serve tianwen1_mc --port 4242
    """
    activate(scenario)
    from edl6dof.serve.flight_server import HOST, FlightServer
    from edl6dof.serve.session import Session

    def begin() -> Session:
        return Session(scenario, sets or ())

    begin().answer({"do": "step"})  # check the scenario and compile the loop before the first client
    try:
        server = FlightServer(begin, port)
    except ImportError as error:
        print(error, file=sys.stderr)
        return UNAVAILABLE
    with server, suppress(KeyboardInterrupt), TemporaryDirectory(prefix="edl6dof-serve-") as folder:
        file = Path(folder) / "token"  # in a folder that was made for this user alone
        file.write_text(server.token, encoding="ascii")
        print(f"{HOST}:{server.port}\ntoken file: {file}", flush=True)
        print("Ctrl-C stops it; only this user, on this machine, can connect", flush=True)
        server.serve_forever()
    return 0


def scenarios(
    scenario: Annotated[
        str | None, argument("SCENARIO", "Scenario whose file is printed; by default all are listed.")
    ] = None,
) -> None:
    """List the shipped scenarios, or print the file of one.

    edl6dof scenarios
    edl6dof scenarios tianwen1 > mine.yaml
    """
    from edl6dof.cli.inspection import list_scenarios
    from edl6dof.config.document.locate import resolve_scenario

    if scenario is None:
        list_scenarios()
    else:
        sys.stdout.write(resolve_scenario(scenario).read_text(encoding="utf-8"))


def show(
    scenario: Scenario,
    path: Annotated[
        str, argument("PATH", "Dotted path to begin at, such as vehicle.mass, or part of a name.")
    ] = "",
    sets: Sets = None,
    diff: Annotated[
        str | None, option("OTHER", "Print only what another scenario has otherwise, and where.", "--diff")
    ] = None,
    as_json: Annotated[bool, flag("Print JSON.", "--json")] = False,
    vehicle: Annotated[
        bool, flag("Draw the vehicle, and print the authority of its thrusters, instead.", "--vehicle")
    ] = False,
    out: Annotated[Path, option("FILE", "Picture of the vehicle: .svg, .png or .pdf.", "--out", "-o")] = Path(
        "vehicle.svg"
    ),
    force: Annotated[bool, flag("Replace an existing picture.", "--force")] = False,
) -> None:
    """Values of a scenario: unit, bounds, meaning, file and line.

    Parameters of its plugins are among them.

    edl6dof show tianwen1 vehicle.parachutes.main
    edl6dof show tianwen1 --diff tianwen1_hazards
    edl6dof show tianwen1 --vehicle -o tianwen1.svg
    edl6dof show tianwen1 --set vehicle.mass.entry_kg=1350 --diff tianwen1
    """
    activate(scenario, diff)
    from edl6dof.cli.inspection import show_differences, show_values, show_vehicle

    if vehicle and (path or diff is not None):
        raise refusal("--vehicle", "draws the whole vehicle; give neither PATH nor --diff")
    if vehicle:
        show_vehicle(scenario, sets or (), out, force, as_json)
    elif diff is not None:
        show_differences((scenario, diff), path, sets or (), as_json)
    else:
        show_values(scenario, path, sets or (), as_json)


def params(
    path: Annotated[
        str, argument("PATH", "Dotted path to begin at, such as vehicle.parachutes, or part of a name.")
    ] = "",
    as_json: Annotated[bool, flag("Print JSON.", "--json")] = False,
) -> None:
    """List parameters: default, unit, bounds, meaning, status.

    edl6dof params vehicle.parachutes
    edl6dof params bank_rate
    """
    activate()
    from edl6dof.cli.inspection import show_params

    show_params(path, as_json)


def schema(
    scenario: Annotated[str | None, argument("SCENARIO", "Scenario whose plugins the files may use.")] = None,
    of: Annotated[str, option("KIND", "scenario (campaigns, too), vehicle or planet.", "--of")] = "scenario",
) -> None:
    """Print the JSON schema of scenario, vehicle or planet files.

    edl6dof schema > edl6dof.schema.json
    """
    activate(scenario)
    from edl6dof.api.schema_files import SCHEMAS

    if of not in SCHEMAS:
        raise refusal("--of", f"must be one of {', '.join(SCHEMAS)} (got {of!r})")
    print(json.dumps(SCHEMAS[of](), indent=1))


def cache(
    clear: Annotated[bool, flag("Remove the code of this installation.", "--clear")] = False,
    everything: Annotated[
        bool, flag("With --clear: that of other installations and versions, too.", "--all")
    ] = False,
) -> None:
    """Show the machine code on this machine, or clear it.

    It is compiled by the first flight of an installation, and named by a hash of its sources: it is never
    stale. Code that was not used for 30 days is removed automatically.

    edl6dof cache
    edl6dof cache --clear
    """
    from edl6dof.config.wording import counted
    from edl6dof.kernels.cache import folder

    if everything and not clear:
        raise refusal("--all", "is of --clear")
    if (own := folder()) is None:
        print("none is kept")
        return
    others = [one for one in own.parent.iterdir() if one.is_dir() and one != own]
    print(f"{own.parent}\n  this installation: {_size([own])}\n  others: {_size(others)}")
    if clear:
        removed = [own, *others] if everything else [own]
        for place in removed:
            rmtree(place, ignore_errors=True)
        print(f"removed: {counted(len(removed), 'folder')}")


def _size(places: Sequence[Path]) -> str:
    sizes = [file.stat().st_size for place in places for file in place.iterdir() if file.is_file()]
    return f"{sum(sizes) / 1e6:.1f} MB in {len(sizes):,} files"


def version() -> None:
    """Print the version.

    edl6dof version
    """
    from edl6dof import __version__

    print(__version__)
