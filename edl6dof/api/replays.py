"""The 3D replay of flights, or of a campaign: in the viewer, the browser, a file, a picture or a film."""

from __future__ import annotations

import signal
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from edl6dof.api.campaign import is_campaign, refly_case
from edl6dof.api.flight import REPLAY, RecordedFlight
from edl6dof.api.progress import count_runs
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.run import resumed_plan
from edl6dof.campaign.store import Store
from edl6dof.config.errors import refusal
from edl6dof.config.wording import unknown
from edl6dof.replay import browser, viewer
from edl6dof.replay.film.encoder import encoder
from edl6dof.replay.film.film import film
from edl6dof.replay.film.pace import Cut
from edl6dof.replay.film.stage import require_graphics
from edl6dof.replay.film.titles import COLUMNS as FILMED
from edl6dof.replay.history import Flown, History, thin, vector
from edl6dof.replay.pages import CAMPAIGN, TITLES, TOUR
from edl6dof.replay.recording import history, recorded_span, write_replay
from edl6dof.replay.scene.ensemble import Ensemble, Trajectory, Worst
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.document import printed, significant
from edl6dof.runs.files import atomic_file, distinct_names, refuse_existing_file
from edl6dof.runs.run import Run
from edl6dof.sim.flight import Flight, fly

#: Flight of a campaign that is followed if none is named.
NOMINAL = "in which nothing is dispersed and nothing fails; it is none of the cases."
#: Cases of a campaign that are drawn with the worst, for more would hide each other, and rows of each, Hz.
MOST_CASES, RATE_HZ = 2000, 0.5
#: Worst cases that are marked.
MOST_WORST = 6
#: Frames of a film per second by default.
FPS = 30.0


class Wanted(NamedTuple):
    """Arguments of :func:`edl6dof.replay`: the files to write first, ``None`` for none."""

    html: Path | None
    screenshot: Path | None
    video: Path | None
    web: bool
    at_s: float | None
    page: str
    case: int | None
    start_s: float | None
    end_s: float | None
    length_s: float | None
    fps: float
    force: bool


def show_replay(runs: Sequence[Path], wanted: Wanted) -> list[Path]:
    """Show a replay or write it; return the paths written.

    Raises:
        ConfigError: the options exclude each other, or name no replay.
        ViewerFailed, NoFilm: the viewer, or the encoder of films, does not run on this machine.
    """
    targets = [path for path in (wanted.html, wanted.screenshot, wanted.video) if path is not None]
    for path in targets:
        refuse_existing_file(path, wanted.force, runs[0])
    _check(runs, wanted)
    with ended_by_signals():
        if wanted.video is not None:
            _write_film(runs, wanted.video, wanted)
        if targets != [wanted.video]:
            _show(runs, wanted)
    return targets


def _check(runs: Sequence[Path], wanted: Wanted) -> None:
    """Refuse arguments that exclude each other, or name no replay."""
    video, page = wanted.video, wanted.page
    if wanted.at_s is not None and wanted.screenshot is None:
        raise refusal("--at", "is the time of a picture; name its file with --screenshot FILE")
    of_film = (wanted.start_s, wanted.end_s, wanted.length_s, wanted.fps)
    if video is None and of_film != (None, None, None, FPS):
        raise refusal("--from, --to, --length, --fps", "are of a film; name its file with --video FILE")
    if video is not None and video.suffix.lower() != ".mp4":
        raise refusal(video, "is no name of a film; films are written as .mp4")
    if page and runs[0].is_file():
        raise refusal("--page, --tour", "need the folder of a run; a recording opens as it was arranged")
    if page not in ("", *TITLES):
        raise refusal("--page", unknown("page", page, TITLES))
    for run in runs:
        if not run.exists():
            raise refusal(run, "no such replay; name the folder of a run, or its recording")
    if video is not None and page:
        raise refusal("--page, --tour", "are of the viewer; a film has shots of its own")


def _show(runs: Sequence[Path], wanted: Wanted) -> None:
    """Show a recording, or write the page and the picture of it."""
    html, screenshot, force = wanted.html, wanted.screenshot, wanted.force
    bare = html is None and screenshot is not None and wanted.page == TOUR
    with _recording(runs, wanted.page, wanted.case, bare) as recording:
        title = f"edl6dof replay: {', '.join(distinct_names(runs))}"
        if screenshot is not None:
            with atomic_file(screenshot, force, runs[0]) as partial:
                viewer.screenshot(recording, partial, _time(recorded_span(recording), "--at", wanted.at_s))
        if html is not None:
            with atomic_file(html, force, runs[0]) as partial:
                partial.write_bytes(browser.page(recording, title))
        if html is None and screenshot is None:
            if wanted.web:
                browser.serve(browser.page(recording, title))
            else:
                viewer.show(recording)


def _write_film(runs: Sequence[Path], file: Path, wanted: Wanted) -> None:
    """Write the film of one flight: of a run, of a case of a campaign, or of its nominal flight."""
    encoder()  # both before the flight is read
    require_graphics()
    flight = _filmed(runs, wanted.case)
    cut = _cut(flight, wanted)
    with atomic_file(file, wanted.force, runs[0]) as partial, count_runs("frames") as progress:
        film(flight, partial, cut, progress)


def _filmed(runs: Sequence[Path], case: int | None) -> History:
    alone, *others = runs
    if others or alone.is_file():
        raise refusal("--video", "shows one flight; name the folder of one run or campaign")
    plan = _plan(alone, case)
    flight: Flown = RecordedFlight(alone) if plan is None else _flown_again(alone, plan, case)[1]
    found = History(flight, FILMED)
    if not len(found.t):
        raise refusal(alone, "no row of the telemetry can be drawn")
    return found


def _cut(flight: History, wanted: Wanted) -> Cut:
    """Return the part of the flight to film, by default all of it."""
    span = float(flight.t[0]), float(flight.t[-1])
    first = _time(span, "--from", span[0] if wanted.start_s is None else wanted.start_s)
    last = _time(span, "--to", wanted.end_s)
    if first >= last:
        raise refusal("--to", f"{last:g} s is not after the film's first time, {first:g} s")
    return Cut(first, last, wanted.length_s, wanted.fps)


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end the work like Ctrl-C, without a viewer or a temporary file left over."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    numbers = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    defaults = [one for one in numbers if signal.getsignal(one) is signal.SIG_DFL]  # nohup ignores SIGHUP
    for number in defaults:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number in defaults:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def _recording(
    runs: Sequence[Path], page: str, case: int | None = None, bare: bool = False
) -> Iterator[Path]:
    """Provide the recording of the flight if it is sufficient, otherwise a new temporary one; if ``bare``,
    without the viewer's controls.

    A campaign comes first; one of its cases, the flights after it, or its nominal flight are shown among its
    trajectories.
    """
    alone = runs[0]
    plan = _plan(alone, case)
    if len(runs) == 1 and alone.is_file():
        yield alone
        return
    if len(runs) == 1 and (alone / REPLAY).is_file() and not (page or bare):
        yield Run(alone).file(REPLAY)
        return
    named = runs[1 if plan else 0 :]
    labels, flights = distinct_names(named), [history(RecordedFlight(folder)) for folder in named]
    words, ensemble = "the first run named after the campaign.", None
    if plan is not None:
        if case is not None or not named:
            label, flight, words = _flown_again(alone, plan, case)
            labels, flights = [label, *labels], [history(flight), *flights]
        ensemble = _ensemble(alone, plan, f"{labels[0]}, {words}")
    elif len(flights) == 1:
        labels = []
    if not all(len(flight.t) for flight in flights):
        raise refusal(alone, "no row of the telemetry can be drawn")
    with TemporaryDirectory(prefix="edl6dof-") as folder:
        front = CAMPAIGN if words is NOMINAL else "Flight"
        write_replay(flights, Path(folder) / REPLAY, labels, page or front, ensemble, bare)
        yield Path(folder) / REPLAY


def _plan(folder: Path, case: int | None) -> Plan | None:
    """Return the plan of a campaign; ``None`` for a run, of which no case can be named."""
    plan = resumed_plan(Store(folder)) if is_campaign(folder) else None
    if case is not None and plan is None:
        raise refusal("--case", f"needs the folder of a campaign, named first (got {folder})")
    return plan


def _flown_again(folder: Path, plan: Plan, case: int | None) -> tuple[str, Flown, str]:
    """Fly a case of a campaign again, or the nominal flight; return name, flight and a text about it.

    Raises:
        ConfigError: there is no such case.
    """
    if case is None:
        return "nominal", fly(plan.loaded), NOMINAL
    flight = refly_case(plan, Store(folder).table(), folder, case)
    differs = ", ".join(flight.differences)
    words = f"differs from its row in {differs}" if differs else "identical to its row"
    return f"case {case}", flight, f"flown again, {words}."


def _ensemble(folder: Path, plan: Plan, followed: str) -> Ensemble:
    """Return the cases of a campaign for the replay; ``followed``: text on the flight that is followed."""
    results = Results(folder)
    worst = worst_cases(results)
    drawn = {*results.cases[:MOST_CASES].tolist(), *(one.case for one in worst)}
    return Ensemble(trajectories(plan, drawn), worst, followed)


def _time(span: tuple[float, float], option: str, asked_s: float | None) -> float:
    """Return the requested time within a span (s), or by default its end; refuse one outside it."""
    first, last = span
    if asked_s is None:
        return last
    if not first <= asked_s <= last:
        words = f"{asked_s:g} s is not in the recording: give a time from {first:.2f} to {last:.2f} s"
        raise refusal(option, words)
    return asked_s


def worst_cases(results: Results) -> list[Worst]:
    """Return the cases nearest to a limit or farthest beyond it, at most one for each limit."""
    found = []
    for figure, limit in results.limits:
        for row in results.nearest(figure, 1).tolist():
            value, unit = float(results[figure.name][row]), printed(figure.unit.label)
            shown, bound = (f"{significant(one)} {unit}".rstrip() for one in (value, limit))
            used = figure.used(value, limit)
            found.append(Worst(int(results.cases[row]), figure.meaning, shown, bound, used))
    return sorted(found, key=lambda one: -one.used)[:MOST_WORST]


def trajectories(plan: Plan, cases: Collection[int]) -> list[Trajectory]:
    """Fly cases of a campaign again for their trajectories, in order; a case that could not fly has none.

    A campaign keeps one row of each case, and every case repeats exactly.
    """
    again = (case for case in plan.cases(0, max(cases, default=-1) + 1) if case.index in cases)
    found = []
    with count_runs("cases flown again") as progress:
        for done, row in enumerate(fly_rows(plan.loaded, again, collect=_places), start=1):
            progress(done, len(cases))
            if "places" in row:
                cause = "" if row["success"] else str(row["cause"])
                landed = bool(np.isfinite(row.get("landing_east_m", np.nan)))
                found.append(Trajectory(row["case"], row["places"], cause, landed))
    return found


def _places(flight: Flight) -> Mapping[str, Any]:
    """Positions in landing-site axes every two seconds, copied: the next case reuses the telemetry."""
    rows = thin(np.array(flight.telemetry["t_s"]), RATE_HZ)
    return {"places": vector(flight.telemetry, "truth.site", "east north up", "_m")[rows].astype(np.float32)}
