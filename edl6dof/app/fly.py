"""``edl6dof fly``."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from edl6dof.api.blocked_imports import blocked_imports
from edl6dof.api.flights import Flight, continued, fly
from edl6dof.api.run_files import REPLAY, draw_replay, write_files, write_numbers
from edl6dof.app.compiling import announce_compiling
from edl6dof.app.replay_beside import artist_beside
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.jit import outside_sources
from edl6dof.manifest import listed
from edl6dof.runs.folder import atomic_folder, default_folder
from edl6dof.scenario.loading import LoadedScenario, load_scenario
from edl6dof.scenario.records import build_records
from edl6dof.sim.checkpoint import State
from edl6dof.sim.compile_ahead import is_compiled
from edl6dof.sim.flight import Progress as FlightProgress


@dataclass(frozen=True)
class FlyOptions:
    """Options of ``edl6dof fly``."""

    scenario: str | None
    sets: tuple[str, ...]
    out: Path | None
    force: bool
    replay: bool
    report: bool
    quiet: bool
    as_json: bool
    save_state_s: float | None
    start: Path | None


def run_fly(options: FlyOptions) -> int:
    """Fly, write the run folder, show the result; returns the exit status."""
    loaded, state = _load(options)
    target = options.out or default_folder(loaded.scenario.name, options.force)
    with atomic_folder(target, "flight", options.force) as folder:
        flight = _fly_into(folder, options, loaded, state)
    if options.report:
        from edl6dof.api.reports import report_of, write_page

        write_page(report_of(target), target / "report.html", False, target)
    _show(flight, target, options)
    if options.save_state_s is not None and flight.saved is None:
        message = (
            f"--save-state {options.save_state_s:g}: no state was saved; the flight ended at "
            f"{flight.time_s:.2f} s"
        )
        print(message, file=sys.stderr)
    return 0 if flight.success else 1


def _fly_into(folder: Path, options: FlyOptions, loaded: LoadedScenario, state: State | None) -> Flight:
    talk = not (options.quiet or options.as_json)
    announce_compiling(talk)
    # a plugin's kernels may hold matrix products
    unused = () if outside_sources else UNUSED_BY_NUMBA
    with blocked_imports(*unused):
        # before the processes part: what both need of it is in memory once
        parts = build_records(loaded) if is_compiled() else None
    with artist_beside(loaded, folder / REPLAY) if options.replay else nullcontext() as artist:
        with _progress(talk) as report, blocked_imports(*unused):
            flight = fly(
                loaded,
                start=state,
                save_at_s=options.save_state_s,
                progress=report,
                parts=parts,
                log=None if artist is None else artist.log.take(),
            )
        if artist is None:
            write_files(flight, folder, options.replay, release=True)
            return flight
        artist.draw(flight)
        write_numbers(flight, folder)
        flight.release_log()
        if not artist.wait():  # this process draws, and says what is wrong
            draw_replay(fly(loaded, start=state), folder, release=True)
    return flight


#: What numba imports to learn whether matrix products can be compiled: a tenth of a second, and no kernel of
#: the package has any.
UNUSED_BY_NUMBA = ("scipy.linalg",)


def _show(flight: Flight, target: Path, options: FlyOptions) -> None:
    from edl6dof.report.terminal import headline, show_flight

    console = Console(highlight=False, soft_wrap=True)
    if options.as_json:
        print((target / "summary.json").read_text(encoding="utf-8"), end="")
    elif options.quiet:
        console.print(headline(flight))
    else:
        show_flight(console, flight)
        console.print(f"{target}: {listed(target)}", markup=False)
        console.print(f"next: edl6dof report {target}, edl6dof replay {target}", markup=False)


def _load(options: FlyOptions) -> tuple[LoadedScenario, State | None]:
    save = options.save_state_s
    if save is not None and not (math.isfinite(save) and save >= 0.0):
        raise _problem("--save-state", f"must be a time in s, 0 or more (got {save:g})")
    if options.start is None:
        if options.scenario is None:
            raise _problem(
                "edl6dof fly", "name a scenario, such as tianwen1, or continue a state with --from STATE"
            )
        return load_scenario(options.scenario, options.sets), None
    if options.scenario is not None:
        raise _problem("--from", "a saved state brings its own scenario; give no other")
    return continued(options.start, options.sets)


def _problem(place: str, message: str) -> ConfigError:
    return ConfigError([Problem(place, 0, 0, "", message)])


@contextmanager
def _progress(talk: bool) -> Iterator[FlightProgress | None]:
    """A progress line with time, phase, altitude and Mach number on stderr, if that is a terminal."""
    console = Console(stderr=True)
    if not (talk and console.is_terminal):
        yield None
        return
    columns = (
        TextColumn("{task.fields[phase]:<22}"),
        BarColumn(bar_width=16),
        TextColumn("t = {task.completed:5.0f} s"),
        TextColumn("{task.fields[altitude]:6.1f} km altitude"),
        TextColumn("Mach {task.fields[mach]:4.1f}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("fly", total=None, phase="", altitude=0.0, mach=0.0)

        def report(t: float, limit: float, phase: str, altitude: float, mach: float) -> None:
            bar.update(task, completed=t, phase=phase, altitude=altitude / 1e3, mach=mach)

        yield report
