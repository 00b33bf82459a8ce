"""``edl6dof fly``."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from edl6dof.config.errors import ConfigError, Problem
from edl6dof.post.folder import FolderExists, atomic_folder, refuse_existing
from edl6dof.sim.scenario import LoadedScenario, load_scenario

BAD_INPUT = 2


@dataclass(frozen=True)
class FlyOptions:
    """Options of ``edl6dof fly``."""

    scenario: str | None
    sets: tuple[str, ...]
    out: Path | None
    force: bool
    replay: bool
    quiet: bool
    as_json: bool
    save_state_s: float | None
    start: Path | None


def run_fly(options: FlyOptions) -> int:
    """Fly, write the run folder, show the result; returns the exit status."""
    loaded, state = _load(options)
    target = options.out or Path("runs") / loaded.scenario.name
    try:
        refuse_existing(target, options.force)
    except FolderExists as error:
        print(error, file=sys.stderr)
        return BAD_INPUT

    from edl6dof.jit import is_cached
    from edl6dof.post.results import write_run
    from edl6dof.post.tables import show_flight, verdict
    from edl6dof.sim.flight import fly
    from edl6dof.sim.loop import fly as compiled_loop

    talk = not (options.quiet or options.as_json)
    console = Console(stderr=False, highlight=False)
    if talk and not is_cached(compiled_loop):
        console.print("Compiling the simulator (first flight on this machine; up to a minute, kept for all later flights) ...")
    try:
        with atomic_folder(target, options.force) as folder:
            with _progress(console, talk) as report:
                flight = fly(loaded, start=state, save_at_s=options.save_state_s, progress=report)
            write_run(flight, folder, replay=options.replay)
            if flight.saved is not None:
                flight.saved.save(folder / "state.npz")
    except FolderExists as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except OSError as error:
        print(f"{target}: cannot be written: {error.strerror or error}", file=sys.stderr)
        return BAD_INPUT
    if options.as_json:
        print((target / "summary.json").read_text(encoding="utf-8"), end="")
    elif options.quiet:
        console.print(verdict(flight))
    else:
        show_flight(console, flight)
        files = ", ".join(sorted(path.name for path in target.iterdir()))
        console.print(f"{target}: {files}")
    if options.save_state_s is not None and flight.saved is None:
        print(f"--save-state {options.save_state_s:g}: the flight ended before, at {flight.time_s:.2f} s", file=sys.stderr)
    return 0 if flight.success else 1


def _load(options: FlyOptions) -> tuple[LoadedScenario, object]:
    if options.start is None:
        if options.scenario is None:
            raise ConfigError([Problem("edl6dof fly", 0, 0, "", "name a scenario, or continue a state with --from STATE")])
        return load_scenario(options.scenario, options.sets), None
    from edl6dof.sim.flight import continue_from
    from edl6dof.sim.state import State

    if options.scenario is not None:
        raise ConfigError([Problem("--from", 0, 0, "", "a saved state brings its own scenario; give no other")])
    state = State.load(options.start)
    return continue_from(state, options.sets), state


@contextmanager
def _progress(console: Console, talk: bool) -> Iterator[object]:
    """A progress bar with time, phase, altitude and Mach number."""
    if not talk:
        yield None
        return
    columns = (
        TextColumn("{task.fields[phase]:<22}"),
        BarColumn(),
        TextColumn("t = {task.completed:6.1f} s"),
        TextColumn("{task.fields[altitude]:7.2f} km"),
        TextColumn("Mach {task.fields[mach]:5.2f}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("fly", total=None, phase="", altitude=0.0, mach=0.0)

        def report(t: float, limit: float, phase: str, altitude: float, mach: float) -> None:
            bar.update(task, completed=t, phase=phase, altitude=altitude / 1e3, mach=mach)

        yield report
