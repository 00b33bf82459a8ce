"""``edl6dof replay``: show one flight or several, or a whole campaign, in the viewer, the browser, a file,
a picture or a film.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from edl6dof.api.blocked_imports import lean_arrow
from edl6dof.app.exit_status import UNAVAILABLE
from edl6dof.config.errors import refusal
from edl6dof.config.wording import nearest
from edl6dof.runs.files import atomic_file, refuse_existing_file
from edl6dof.runs.run import Run
from edl6dof.telemetry.landing_map import LandingMap

if TYPE_CHECKING:
    from edl6dof.replay.film import Cut
    from edl6dof.scenario.schema import Scenario

RECORDING = "replay.rrd"
#: Which flight of a campaign is followed where none is named, and why.
NOMINAL = (
    "the nominal flight, in which nothing is dispersed and nothing fails: the cases are spread about it. It "
    "is none of them; to follow another flight, name its run folder after the campaign's."
)


class FilmOptions(NamedTuple):
    """What a film shows: first and last time of the flight, its own length, s, and frames per second."""

    first_s: float | None = None
    last_s: float | None = None
    length_s: float | None = None
    fps: float = 24.0


@dataclass(frozen=True)
class ReplayOptions:
    """Options of ``edl6dof replay``."""

    runs: tuple[Path, ...]
    web: bool
    html: Path | None
    screenshot: Path | None
    at_s: float | None
    page: str
    force: bool
    video: Path | None = None
    film: FilmOptions = FilmOptions()


class FlownRun:
    """A run folder as a flight that can be replayed."""

    def __init__(self, folder: Path) -> None:
        self._run = Run(folder)
        self.name, self.outcome = self._run.name, str(self._run.summary["outcome"])
        self.success = bool(self._run.summary["success"])

    @cached_property
    def scenario(self) -> Scenario:
        """The resolved scenario, as far as the package itself knows it."""
        from edl6dof.scenario.viewed import viewed_scenario  # here: what a flight has drawn needs it no more

        return viewed_scenario(self._run.scenario_text, str(self._run.folder / "scenario.yaml")).scenario

    @property
    def phase_names(self) -> list[str]:
        """Names of the mission phases."""
        return self._run.phase_names

    @property
    def events(self) -> Sequence[Mapping[str, Any]]:
        """The timeline."""
        return self._run.events

    @property
    def landing_map(self) -> LandingMap | None:
        """What the lander saw of the ground and chose on it."""
        return self._run.landing_map

    @property
    def telemetry(self) -> Mapping[str, np.ndarray]:
        """Columns by name."""
        return self._run


def run_replay(options: ReplayOptions) -> int:
    """Do what the options ask for, and say what was written; returns the exit status."""
    from edl6dof.replay.film import NoFilm
    from edl6dof.replay.program import ViewerFailed

    try:
        for path in show_replay(options):
            print(path)
    except (ViewerFailed, NoFilm) as error:
        print(error, file=sys.stderr)
        return UNAVAILABLE
    return 0


def show_replay(options: ReplayOptions) -> list[Path]:
    """Do what the options ask for; returns what was written.

    Raises:
        ConfigError: the options do not fit together, or name no replay.
        ViewerFailed, NoFilm: the viewer, or the encoder of films, does not run here.
    """
    from edl6dof.replay.film import encoder
    from edl6dof.replay.views.layout import TITLES

    targets = [path for path in (options.html, options.screenshot, options.video) if path is not None]
    for path in targets:
        refuse_existing_file(path, options.force, options.runs[0])
    if options.at_s is not None and options.screenshot is None:
        raise refusal("--at", "is the time of a picture; name its file with --screenshot FILE")
    if options.video is not None and options.video.suffix.lower() != ".mp4":
        raise refusal(options.video, "is no name of a film; films are written as .mp4")
    if options.video is None and options.film != FilmOptions():
        raise refusal("--from, --to, --length, --fps", "are of a film; name its file with --video FILE")
    if options.page and options.runs[0].is_file():
        raise refusal("--page, --tour", "need the folder of a run; a recording opens as it was arranged")
    if options.page not in ("", *TITLES):
        near = nearest(options.page, TITLES)
        hint = f"; did you mean {near!r}?" if near else ""
        raise refusal("--page", f"no page {options.page!r}{hint} (there are: {', '.join(TITLES)})")
    for run in options.runs:
        if not run.exists():
            raise refusal(run, "no such replay; name the folder of a run, or its recording")
    if options.video is not None:
        encoder()  # or the flight would be drawn in vain
    with _ended_by_signals(), _recording(options) as recording:
        _show(recording, options)
    return targets


def _show(recording: Path, options: ReplayOptions) -> None:
    """Write what was asked for, or show the recording until the viewer is closed."""
    from edl6dof.replay import film, page, server, viewer

    title = f"edl6dof replay: {', '.join(_labels(options.runs))}"
    if options.screenshot is not None:
        with atomic_file(options.screenshot, options.force, options.runs[0]) as partial:
            viewer.screenshot(recording, partial, _time(recording, "--at", options.at_s))
    if options.video is not None:
        cut = _cut(recording, options.film)
        with atomic_file(options.video, options.force, options.runs[0]) as partial, _told() as told:
            film.film(recording, partial, cut, told)
    if options.html is not None:
        with atomic_file(options.html, options.force, options.runs[0]) as partial:
            partial.write_bytes(page.page(recording, title))
    if options.screenshot is None and options.html is None and options.video is None:
        if options.web:
            server.serve(page.page(recording, title))
        else:
            viewer.show(recording)


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end the work as Ctrl-C does, so that nothing is left behind: no viewer, no
    temporary file.
    """

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    names = [name for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in (getattr(signal, name) for name in names)}
    defaults = [
        number for number, action in before.items() if action is signal.SIG_DFL
    ]  # nohup ignores SIGHUP
    for number in defaults:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number in defaults:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def _recording(options: ReplayOptions) -> Iterator[Path]:
    """The recording that the flight wrote where that will do, else a new one for the time being.

    A campaign comes first; the flights after it, or its nominal one, fly among its trajectories.
    """
    alone = options.runs[0]
    if len(options.runs) == 1 and alone.is_file():
        yield alone
        return
    if len(options.runs) == 1 and (alone / RECORDING).is_file() and not options.page:
        yield Run(alone).file(RECORDING)
        return
    from edl6dof.app.ensemble import campaign_plan, is_campaign, trajectories
    from edl6dof.replay.recording import history, write_replay
    from edl6dof.replay.scene.ensemble import Ensemble

    plan = campaign_plan(alone) if is_campaign(alone) else None
    flights = [history(FlownRun(folder)) for folder in options.runs[1 if plan else 0 :]]
    if not flights and plan is not None:
        from edl6dof.sim.flight import fly

        flights = [history(fly(plan.loaded))]
    if not all(len(flight.t) for flight in flights):
        raise refusal(alone, "no row of the telemetry can be drawn")
    labels = _labels(options.runs[1 if plan else 0 :])
    ensemble = None
    if plan is not None:
        followed = f"{labels[0]}, the first run named after the campaign." if labels else NOMINAL
        labels, ensemble = labels or ["nominal flight"], Ensemble(trajectories(plan), followed)
    elif len(flights) == 1:
        labels = []
    with TemporaryDirectory(prefix="edl6dof-") as folder:
        write_replay(flights, Path(folder) / RECORDING, labels, options.page or "Flight", ensemble)
        yield Path(folder) / RECORDING


def _labels(runs: Sequence[Path]) -> list[str]:
    """Folder names; with their parents where they are the same."""
    names = [run.resolve().name for run in runs]
    return names if len(set(names)) == len(names) else ["/".join(run.resolve().parts[-2:]) for run in runs]


def _time(recording: Path, option: str, asked_s: float | None) -> float:
    """A time of the recording, s: what was asked for, or its end.

    Raises:
        ConfigError: the recording does not reach so far.
    """
    from edl6dof.replay.recording import recorded_span

    with lean_arrow():
        first, last = recorded_span(recording)
    if asked_s is None:
        return last
    if not first <= asked_s <= last:
        raise refusal(
            option, f"{asked_s:g} s is not in the recording: give a time from {first:.2f} to {last:.2f} s"
        )
    return asked_s


def _cut(recording: Path, asked: FilmOptions) -> Cut:
    """What the film shows: the whole flight, in no more than a minute, where nothing else was asked for."""
    from edl6dof.replay.film import LENGTH_S, Cut
    from edl6dof.replay.recording import recorded_span

    first = recorded_span(recording)[0] if asked.first_s is None else asked.first_s
    first, last = _time(recording, "--from", first), _time(recording, "--to", asked.last_s)
    if first >= last:
        raise refusal("--to", f"{last:g} s is not after the film's first time, {first:g} s")
    return Cut(first, last, asked.length_s or min(last - first, LENGTH_S), asked.fps)


@contextmanager
def _told() -> Iterator[Callable[[int, int], None]]:
    """Show on a terminal how many of how many frames are drawn."""
    console = Console(stderr=True)
    columns = (TextColumn("frames"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("frames", total=None)
        yield lambda done, of: progress.update(task, completed=done, total=of)
