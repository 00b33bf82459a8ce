"""What the functions do that ``import edl6dof`` offers, with everything they need."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from edl6dof.api.campaign_flight import EngineChoice
from edl6dof.api.campaigns import CampaignResult, Progress, flown, fly_campaign, listed, open_campaign
from edl6dof.api.flights import Flight, RecordedFlight, continued, fly
from edl6dof.api.overrides import Overrides, texts
from edl6dof.scenario.loading import load_scenario

if TYPE_CHECKING:
    from edl6dof.calibration.findings import Findings
    from edl6dof.verify.check import Report

__all__ = [
    "CampaignResult",
    "EngineChoice",
    "Flight",
    "RecordedFlight",
    "calibrate",
    "continued",
    "faults",
    "fly",
    "fly_campaign",
    "open_run",
    "refly",
    "replay",
    "report",
    "verify",
]


def open_run(folder: str | Path) -> RecordedFlight | CampaignResult:
    """Open what lies in a folder: a flight, or a campaign."""
    if (Path(folder) / "campaign.json").is_file():
        return open_campaign(folder)
    return RecordedFlight(Path(folder))


def faults(
    scenario: str | Path,
    overrides: Overrides,
    *,
    sensors: bool,
    kinds: str | Iterable[str],
    components: str | Iterable[str],
    pairs: bool,
    at: str | float | Iterable[str | float] | None,
    phases: str | Iterable[str],
    after_s: float | None,
    vehicles: int | None,
    seed: int | None,
    workers: int | None,
    out: str | Path | None,
    force: bool,
    progress: Progress | None,
) -> CampaignResult:
    """Fly a matrix of faults; see :func:`edl6dof.faults`."""
    from edl6dof.app.faults.choice import matrix_of
    from edl6dof.app.faults.command import Wanted
    from edl6dof.campaign.fault_kinds import matrix_plan

    sets, moments = texts(overrides), None if at is None else listed(at)
    wanted = Wanted(sensors, listed(kinds), listed(components), pairs, listed(phases), after_s, moments)
    matrix = matrix_of(wanted, load_scenario(scenario, sets))
    plan = matrix_plan(str(scenario), matrix, sets, vehicles, seed)
    engine = EngineChoice(workers=workers)
    engine.check()
    return flown(plan, engine, None, out, force, progress)


def refly(
    campaign: str | Path | CampaignResult, case: int, out: str | Path | None, replay: bool, force: bool
) -> Flight:
    """Fly one case of a campaign again; see :func:`edl6dof.refly`."""
    result = campaign if isinstance(campaign, CampaignResult) else open_campaign(campaign)
    flight = result.refly(case)
    if out is not None:
        flight.save(out, replay=replay, force=force)
    return flight


def report(
    run: str | Path | Flight | RecordedFlight | CampaignResult,
    out: str | Path | None,
    pdf: bool,
    png: bool,
    force: bool,
) -> list[Path]:
    """Write a report; see :func:`edl6dof.report`."""
    from edl6dof.api.reports import write_report
    from edl6dof.runs.needing import needing_channels

    target, folder = None if out is None else Path(out), folder_of(run)
    with needing_channels(folder):
        return list(write_report(folder, target, pdf, png, force))


def replay(
    runs: Sequence[str | Path | Flight | RecordedFlight | CampaignResult],
    *,
    web: bool,
    html: str | Path | None,
    screenshot: str | Path | None,
    at_s: float | None,
    page: str,
    video: str | Path | None,
    start_s: float | None,
    end_s: float | None,
    length_s: float | None,
    fps: float,
    force: bool,
) -> list[Path]:
    """Show a replay, or write it; see :func:`edl6dof.replay`."""
    from edl6dof.app.replay import FilmOptions, ReplayOptions, show_replay
    from edl6dof.runs.needing import needing_channels

    folders = tuple(map(folder_of, runs))
    page_file, picture, film = (None if path is None else Path(path) for path in (html, screenshot, video))
    cut = FilmOptions(start_s, end_s, length_s, fps)
    with needing_channels(*folders):
        return show_replay(ReplayOptions(folders, web, page_file, picture, at_s, page, force, film, cut))


def folder_of(run: str | Path | Flight | RecordedFlight | CampaignResult) -> Path:
    """The folder of what was flown.

    Raises:
        ValueError: it has none.
        TypeError: it is nothing that was flown.
    """
    if isinstance(run, str | Path):
        return Path(run)
    if not isinstance(run, Flight | RecordedFlight | CampaignResult):
        raise TypeError(f"a run is its folder, or what edl6dof.open_run returned (got {run!r})")
    if run.folder is None:
        kind = "campaign" if isinstance(run, CampaignResult) else "flight"
        raise ValueError(f"this {kind} is in memory only; fly it with out=FOLDER")
    return run.folder


def calibrate(
    scenario: str | Path,
    overrides: Overrides,
    flights: int | None,
    out: str | Path | None,
    force: bool,
    progress: Callable[[int, int], None] | None,
) -> Findings:
    """Fit uncertain parameters; see :func:`edl6dof.calibrate`."""
    from edl6dof.api.calibrations import found_by, write_findings
    from edl6dof.calibration.problem import load_calibration
    from edl6dof.runs.folder import atomic_folder

    name, sets = str(scenario), texts(overrides)
    calibration = load_calibration(name, sets, flights)
    if out is None:
        return found_by(calibration, name, progress)
    with atomic_folder(Path(out), "calibration", force) as folder:
        found = found_by(calibration, name, progress)
        write_findings(found, folder, name, sets, flights)
    return found


def verify(names: Sequence[str]) -> list[Report]:
    """Run check cases; see :func:`edl6dof.verify`."""
    from edl6dof.config.wording import nearest
    from edl6dof.verify.check import CASES, run_case

    for name in names:
        if name not in CASES:
            near = nearest(name, CASES)
            raise ValueError(f"no check case {name!r}" + (f"; did you mean {near!r}?" if near else ""))
    return [run_case(name) for name in names or CASES]
