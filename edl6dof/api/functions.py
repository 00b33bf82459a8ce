"""The functions of ``import edl6dof``, which the command line calls, too.

They are fast to import: the simulator is loaded when a function is called, after the plugins that its flight
software needs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from itertools import count
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Any

from edl6dof.api.arguments import Overrides, listed, named, naming_arguments, texts

if TYPE_CHECKING:
    from edl6dof.api.campaign import CampaignResult, Progress
    from edl6dof.api.flight import Flight, RecordedFlight
    from edl6dof.api.scenario import Scenario
    from edl6dof.calibration.findings import Findings
    from edl6dof.campaign.margins import AxisMargins
    from edl6dof.campaign.rare import Progress as RareProgress
    from edl6dof.campaign.rare import RareFailure
    from edl6dof.report.campaign.assurance import Assurance
    from edl6dof.scenario.loaded import LoadedScenario
    from edl6dof.sim.checkpoint import State
    from edl6dof.sim.flight import Progress as FlightProgress
    from edl6dof.verify.case import Report


def activate(*operands: str | Path | LoadedScenario | None) -> None:
    """Load the plugins of the scenario and those named in the environment."""
    from edl6dof.plugins import activate

    activate([one for one in operands if isinstance(one, str | Path)])


@naming_arguments()
def load(name_or_path: str | Path | LoadedScenario, overrides: Overrides = ()) -> Scenario:
    """Read and validate a scenario file, or a shipped scenario by name.

    Args:
        name_or_path: ``"scenarios/tianwen1.yaml"`` or ``"tianwen1"``; or a loaded scenario, which is read
            again with its own changes and then these.
        overrides: texts ``"dotted.path=value"``; or a mapping of dotted paths, or nested as in a file.

    Raises:
        ConfigError: lists every problem found with file, line and key, and suggests a correction.
        TypeError: an argument is of a wrong kind.
    """
    from edl6dof.api.scenario import Scenario

    return Scenario(name_or_path, overrides)


@naming_arguments(save_state="save_at_s")
def fly(
    scenario: LoadedScenario | str | Path | None = None,
    overrides: Overrides = (),
    *,
    out: str | Path | None = None,
    replay: bool = True,
    force: bool = False,
    start: State | str | Path | None = None,
    save_at_s: float | None = None,
    progress: FlightProgress | None = None,
) -> Flight:
    """Fly a scenario and return the flight, as ``edl6dof fly`` does.

    Args:
        scenario: file, name of a shipped one, or the result of :func:`load`; none with ``start``.
        overrides: changes as for :func:`load`.
        out: folder to write, as the command does; by default nothing is written.
        replay: True to write the 3D replay.
        force: True to replace an existing run.
        start: saved state, or its file, from which to continue; it contains its scenario.
        save_at_s: time at which to save a state, s.
        progress: called every few seconds of flight; see :func:`edl6dof.sim.flight.fly`.

    Raises:
        ConfigError: the scenario is wrong, or ``out`` cannot be written.
        TypeError: an argument is of a wrong kind.
    """
    if start is None and scenario is None:
        raise TypeError("name a scenario, such as 'tianwen1', or go on from a saved state with start=")
    activate(scenario if isinstance(scenario, str | Path) else None)
    from edl6dof.api.flight import fly_loaded
    from edl6dof.scenario.loaded import LoadedScenario
    from edl6dof.sim import flight as sim
    from edl6dof.sim.checkpoint import State

    state = State.load(Path(start)) if isinstance(start, str | Path) else start
    if scenario is None and state is not None:
        loaded = sim.continue_from(state, texts(overrides))
    elif isinstance(scenario, LoadedScenario) and not overrides:
        loaded = scenario
    elif scenario is not None:
        loaded = load(scenario, overrides)
    options = {"start": state, "save_at_s": save_at_s, "progress": progress}
    return fly_loaded(loaded, out, replay=replay, force=force, **options)


@naming_arguments()
def open_run(folder: str | Path) -> RecordedFlight | CampaignResult:
    """Open the folder of a flight or of a campaign, and return its result from the files.

    Args:
        folder: folder of a run or a campaign.

    Raises:
        ConfigError: the folder is neither, or a file is missing or damaged.
    """
    if (Path(folder) / "campaign.json").is_file():
        activate(folder)
        from edl6dof.api.campaign import open_campaign

        return open_campaign(Path(folder))
    from edl6dof.api.flight import RecordedFlight

    return RecordedFlight(Path(folder))


@naming_arguments()
def report(
    run: str | Path | Flight | RecordedFlight | CampaignResult,
    *,
    out: str | Path | None = None,
    pdf: bool = False,
    png: bool = False,
    force: bool = False,
) -> list[Path]:
    """Write the report of a run or a campaign, as ``edl6dof report`` does; return the paths written.

    Args:
        run: folder, or the result of :func:`open_run`, or of :func:`fly` with ``out``.
        out: file to write; by default ``report.html`` in the folder.
        pdf: write one PDF for papers instead.
        png: write a picture of each figure for papers instead.
        force: True to replace existing files.

    Raises:
        ConfigError: the folder contains no results to report, or a file must not be replaced.
    """
    from edl6dof.api.reports import write_report
    from edl6dof.runs.files import needing_channels

    folder = _folder_of(run)
    with needing_channels(folder):
        return write_report(folder, None if out is None else Path(out), pdf, png, force)


@naming_arguments()
def assure(
    campaign: str | Path | CampaignResult,
    requirements: str | Path | None = None,
    *,
    out: str | Path | None = None,
    force: bool = False,
) -> Assurance:
    """Judge a campaign by requirements on the share of flights, as ``edl6dof assure`` does.

    Args:
        campaign: folder of a complete campaign, or the result of one that has a folder.
        requirements: file of requirements; by default every limit of the scenario is one.
        out: page to write, HTML or, if its name ends in ``.pdf``, PDF; by default nothing is written.
        force: True to replace an existing file.

    Raises:
        ConfigError: the campaign is incomplete or no random sample, the requirements are wrong, or the file
            must not be replaced.
        ValueError: the campaign is in memory only.
    """
    from edl6dof.api.reports import write_page
    from edl6dof.report.campaign.assurance import assess, assurance_report

    folder = _folder_of(campaign)
    found = assess(folder, None if requirements is None else Path(requirements))
    if out is not None:
        write_page(assurance_report(found), Path(out), force, folder)
    return found


@naming_arguments(size="n")
def rare(
    scenario: str | Path | Scenario,
    requirement: str,
    overrides: Overrides = (),
    *,
    out: str | Path,
    requirements: str | Path | None = None,
    size: int = 155,
    populations: int = 4,
    seed: int | None = None,
    workers: int | None = None,
    force: bool = False,
    resume: bool = False,
    progress: RareProgress | None = None,
) -> RareFailure:
    """Compute the probability that a flight violates a requirement, as ``edl6dof rare`` does.

    Args:
        scenario: campaign file or name; its dispersions are varied.
        requirement: name of the requirement.
        overrides: changes of the scenario, as for :func:`load`.
        out: folder of the flights, from which they can be resumed.
        requirements: file of requirements; by default every limit of the scenario is one, named by its
            figure.
        size: number of flights of each level of a population.
        populations: number of populations, with common levels and first flights of their own.
        seed: seed of the populations; by default that of the campaign.
        workers: number of threads; by default all cores.
        force: True to replace an existing folder of this kind.
        resume: True to resume an interrupted simulation.
        progress: called with the number of flights flown so far.

    Raises:
        ConfigError: the campaign or the requirement is wrong, or the folder must not be replaced.
    """
    name, sets = named(scenario, overrides)
    activate(name)
    from edl6dof.campaign import rare
    from edl6dof.campaign.assurance import limits_as_requirements, load_requirements
    from edl6dof.campaign.design.plan import load_plan
    from edl6dof.metrics.figures import DECLARED

    plan = load_plan(name, sets, seed=seed)
    if requirements is None:
        known = limits_as_requirements(plan.loaded.scenario.limits.model_dump())
    else:
        known = load_requirements(Path(requirements), DECLARED)
    request = rare.Request(plan, rare.chosen(known, requirement), size, populations)
    store = rare.RareStore(Path(out))
    return rare.fly(request, store, workers=workers, resume=resume, force=force, progress=progress)


@naming_arguments(n="vehicles", measured="measure")
def margins(
    scenario: str | Path | Scenario,
    overrides: Overrides = (),
    *,
    phases: Sequence[str] = (),
    moments: int = 3,
    vehicles: int = 0,
    seed: int | None = None,
    measure: bool = False,
    progress: Progress | None = None,
) -> list[AxisMargins]:
    """Compute margins and limit cycles of the attitude loops, as ``edl6dof margins`` does; return a row for
    each phase that is flown and each axis.

    Args:
        scenario: scenario file or name; with ``vehicles`` a campaign.
        overrides: changes of the scenario, as for :func:`load`.
        phases: names of the phases; by default all with attitude control.
        moments: number of moments of each phase.
        vehicles: number of dispersed vehicles, instead of the scenario itself.
        seed: seed of the dispersions; by default that of the campaign.
        measure: True to measure margins as well, by pushes of a frozen flight.
        progress: called with the number of moments analysed, and with their number.

    Raises:
        ConfigError: the scenario has no attitude control, no such phase, or no dispersions.
    """
    name, sets = named(scenario, overrides)
    activate(name)
    from edl6dof.campaign import margins as analysis
    from edl6dof.campaign.design.plan import load_plan
    from edl6dof.scenario.loading import load_scenario

    request = analysis.Request(tuple(phases), moments, vehicles, measure)
    plan = load_plan(name, sets, seed=seed) if vehicles else None
    return analysis.analyse(plan.loaded if plan else load_scenario(name, sets), request, plan, progress)


@naming_arguments(**{"at": "at_s", "from": "start_s", "to": "end_s", "length": "length_s", "tour": "page"})
def replay(
    *runs: str | Path | Flight | RecordedFlight | CampaignResult,
    web: bool = False,
    html: str | Path | None = None,
    screenshot: str | Path | None = None,
    at_s: float | None = None,
    page: str = "",
    case: int | None = None,
    video: str | Path | None = None,
    start_s: float | None = None,
    end_s: float | None = None,
    length_s: float | None = None,
    fps: float = 30.0,
    force: bool = False,
) -> list[Path]:
    """Show the 3D replay of runs, or write it, as ``edl6dof replay`` does; return the paths written.

    Args:
        runs: folders, or results of :func:`open_run`, or of :func:`fly` with ``out``; the first may be a
            campaign.
        web: show it in the browser.
        html: page to write instead.
        screenshot: picture (PNG) to write instead.
        at_s: time of the picture, s.
        page: page to show first.
        case: number of the case of a campaign to fly again and to follow.
        video: film (MP4) to write instead.
        start_s: first time of the film, s.
        end_s: last time of the film, s.
        length_s: duration of the film at constant pace, s; by default about 60 s at most, in real time around
            the events.
        fps: frames per second of the film.
        force: True to replace existing files.

    Raises:
        ConfigError: there is no such replay, or the options exclude each other.
        TypeError: no run is named.
    """
    if not runs:
        raise TypeError("name a run, such as 'runs/tianwen1'")
    folders = [_folder_of(run) for run in runs]
    if folders[0].is_dir():  # where it is a campaign, its cases are flown again: it keeps no trajectories
        activate(folders[0])
    from edl6dof.api.replays import Wanted, show_replay
    from edl6dof.runs.files import needing_channels

    html, screenshot, video = (None if path is None else Path(path) for path in (html, screenshot, video))
    wanted = Wanted(
        *(html, screenshot, video),
        web=web,
        at_s=at_s,
        page=page,
        case=case,
        start_s=start_s,
        end_s=end_s,
        length_s=length_s,
        fps=fps,
        force=force,
    )
    with needing_channels(*folders):
        return show_replay(folders, wanted)


def _folder_of(run: str | Path | Flight | RecordedFlight | CampaignResult) -> Path:
    """Return the folder of a flight or a campaign.

    Raises:
        ValueError: the result has no folder.
        TypeError: the argument is not a flight or a campaign.
    """
    if isinstance(run, str | Path):
        return Path(run)
    from edl6dof.api.campaign import CampaignResult
    from edl6dof.api.flight import Flight, RecordedFlight

    if not isinstance(run, Flight | RecordedFlight | CampaignResult):
        raise TypeError(f"a run is its folder, or what edl6dof.open_run returned (got {run!r})")
    if run.folder is None:
        kind = "campaign" if isinstance(run, CampaignResult) else "flight"
        raise ValueError(f"this {kind} is in memory only; fly it with out=FOLDER")
    return run.folder


@naming_arguments()
def campaign(
    scenario: str | Path | Scenario,
    overrides: Overrides = (),
    *,
    cases: int | None = None,
    seed: int | None = None,
    sampling: str | None = None,
    until: str | None = None,
    engine: str = "threads",
    workers: int | None = None,
    cluster: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    resume: bool = False,
    progress: Progress | None = None,
) -> CampaignResult:
    """Fly many dispersed flights, or a grid of them, as ``edl6dof campaign`` does.

    Args:
        scenario: campaign file or name; with ``resume`` also the folder of a campaign.
        overrides: changes of the scenario, as for :func:`load`.
        cases: number of flights (at each point of a sweep); replaces that of the file.
        seed: seed of the dispersions.
        sampling: ``monte_carlo``, ``latin_hypercube``, ``sobol`` or ``sobol_indices``.
        until: condition for an early stop, such as ``"p_success +- 0.5%"``.
        engine: ``threads`` or ``dask``.
        workers: number of threads or processes; by default all cores.
        cluster: address of a Dask scheduler.
        out: folder of the campaign, from which it can be resumed; by default it is in memory only.
        force: True to replace an existing campaign.
        resume: True to resume an interrupted campaign.
        progress: called with the number of cases flown and the total number.

    Raises:
        ConfigError: the campaign is wrong, or its folder must not be replaced.
    """
    name, sets = named(scenario, overrides)
    activate(name)
    from edl6dof.api.campaign import campaign_job, chosen_engine

    drawn, flying = (cases, seed, sampling), chosen_engine(engine, workers, cluster)
    job = campaign_job(name, sets, drawn, flying, until, out=out, force=force, resume=resume)
    return job.result(progress, in_memory=out is None and not resume)


@naming_arguments(after="after_s")
def faults(
    scenario: str | Path | Scenario = "tianwen1",
    overrides: Overrides = (),
    *,
    sensors: bool = False,
    kinds: str | Iterable[str] = (),
    components: str | Iterable[str] = (),
    pairs: bool = False,
    at: str | float | Iterable[str | float] | None = None,
    phases: str | Iterable[str] = (),
    after_s: float | None = None,
    settings: Mapping[str, Any] | None = None,
    vehicles: int | None = None,
    seed: int | None = None,
    workers: int | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> CampaignResult:
    """Fly one fault in each flight, for every component and moment, as ``edl6dof faults`` does.

    Args:
        scenario: file, or name of a shipped one.
        overrides: changes of the scenario, as for :func:`load`.
        sensors: True for faults of instruments instead of thrusters.
        kinds: kinds of fault, or ``"all"``.
        components: components that fail; by default all that can have the fault.
        pairs: True to let every pair of them fail together.
        at: moments: times in s, ``"every 10 s"``, or events of the nominal flight.
        phases: phases at whose start the faults begin, instead of ``at``.
        after_s: time from the start of the phase to the fault, s.
        settings: other keys of each fault, such as ``{"duration_s": 20.0}``.
        vehicles: number of dispersed vehicles for each fault; by default the nominal one.
        seed: seed of their dispersions.
        workers: number of threads; by default all cores.
        out: folder, as for :func:`campaign`.
        force: True to replace an existing campaign.
        progress: called with the number of cases flown and the total number.

    Raises:
        ConfigError: lists all problems of the request.
    """
    name, sets = named(scenario, overrides)
    activate(name)
    from edl6dof.api.campaign import chosen_engine, faults_job
    from edl6dof.campaign.fault_choice import FaultRequest

    what, where, when = listed(kinds), listed(components), listed(phases)
    moments, keys = None if at is None else listed(at), dumps(settings or {})
    request = FaultRequest(
        *(sensors, what, where, pairs), phases=when, after_s=after_s, at=moments, settings=keys
    )
    engine = chosen_engine(workers=workers)
    job = faults_job(name, sets, request, (vehicles, seed), engine, out=out, force=force)
    return job.result(progress, in_memory=out is None)


@naming_arguments()
def refly(
    campaign: str | Path | CampaignResult,
    case: int,
    *,
    out: str | Path | None = None,
    replay: bool = True,
    force: bool = False,
) -> Flight:
    """Fly one case of a campaign again with all its telemetry, as ``edl6dof refly`` does.

    Args:
        campaign: folder or result of a campaign.
        case: number of the case.
        out: folder to write, as for :func:`fly`.
        replay: True to write the 3D replay.
        force: True to replace an existing run.

    Returns:
        The flight; its ``differences`` list the columns that do not equal its row, bit for bit.

    Raises:
        ConfigError: there is no such case.
    """
    if isinstance(campaign, str | Path):
        activate(campaign)
    from edl6dof.api.campaign import CampaignResult, open_campaign
    from edl6dof.api.flight import flown_into

    result = campaign if isinstance(campaign, CampaignResult) else open_campaign(Path(campaign))
    if out is None:
        return result.refly(case)
    return flown_into(Path(out), lambda: result.refly(case), replay=replay, force=force)


@naming_arguments()
def calibrate(
    scenario: str | Path | Scenario,
    overrides: Overrides = (),
    *,
    flights: int | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> Findings:
    """Fit the uncertain parameters of a scenario to its published figures, as ``edl6dof calibrate`` does.

    Args:
        scenario: file or name, with a ``calibration`` section.
        overrides: changes of the scenario, as for :func:`load`.
        flights: number of flights of each design; replaces that of the file.
        out: folder for the results; by default nothing is written.
        force: True to replace an existing folder.
        progress: called with the number of flights flown and the total number.

    Raises:
        ConfigError: the section is wrong, or too few flights reach the figures.
    """
    name, sets = named(scenario, overrides)
    activate(name)
    from edl6dof.calibration.findings import find
    from edl6dof.calibration.fit import DESIGNS, TooFew
    from edl6dof.calibration.problem import load_calibration
    from edl6dof.campaign.ensemble import FLIGHTS
    from edl6dof.config.errors import refusal
    from edl6dof.runs.files import atomic_folder

    calibration = load_calibration(name, sets, flights)
    flown, total = count(1), DESIGNS * calibration.params.flights + 2 * FLIGHTS
    with nullcontext() if out is None else atomic_folder(Path(out), "calibration", force) as folder:
        try:
            found = find(calibration, lambda _, row: progress(next(flown), total) if progress else None)
        except TooFew as error:
            raise refusal(name, str(error)) from error
        if folder is not None:
            _write_findings(found, folder, name, sets, flights)
    return found


def _write_findings(
    found: Findings, folder: Path, scenario: str, sets: Sequence[str], flights: int | None
) -> None:
    """Write ``summary.json`` and the scenario with the values found, each marked by the command."""
    from edl6dof.calibration.findings import overlay_text, plain, rounded
    from edl6dof.config.document.locate import extends_name
    from edl6dof.config.dump import json_text
    from edl6dof.report.document import significant

    (folder / "summary.json").write_text(json_text(plain(found)), encoding="utf-8")
    options = [*(f"--set {text}" for text in sets), *([] if flights is None else [f"-n {flights}"])]
    command = " ".join(["edl6dof calibrate", scenario, *options])
    sources = {
        path: f"{command}: +- {significant(found.sigmas[path], 2)}; prior {prior.mean:g} +- {prior.sigma:g}"
        for path, prior in found.calibration.params.parameters.items()
    }
    name = f"{found.calibration.loaded.scenario.name}_calibrated"
    text = overlay_text(name, extends_name(scenario), rounded(found), sources)
    (folder / "calibrated.yaml").write_text(text, encoding="utf-8")


def verify(*cases: str) -> list[Report]:
    """Run check cases against their independent references, as ``edl6dof verify`` does; by default all cases.

    Raises:
        ValueError: there is no such case.
    """
    from edl6dof.config.errors import did_you_mean
    from edl6dof.verify.check import CASES, run_case

    for name in cases:
        if name not in CASES:
            raise ValueError(f"no check case {name!r}{did_you_mean(name, CASES)}")
    return [run_case(name) for name in cases or CASES]
