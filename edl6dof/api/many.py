"""Functions about many flights, as ``import edl6dof`` offers them: light, what they need is loaded when they
are called.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from edl6dof.api.one import Overrides, activate
from edl6dof.api.wording import in_python, scenario_name

if TYPE_CHECKING:
    from edl6dof.api.campaigns import CampaignResult
    from edl6dof.api.flights import Flight
    from edl6dof.calibration.findings import Findings
    from edl6dof.verify.check import Report

#: What many flights are reported to: how many have flown, and of how many.
Progress = Callable[[int, int], None]


@in_python()
def campaign(
    scenario: str | Path,
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
        overrides: as of :func:`load`.
        cases: flights (at each point of a sweep) instead of the file's.
        seed: of the dispersions.
        sampling: ``monte_carlo``, ``latin_hypercube``, ``sobol`` or ``sobol_indices``.
        until: when to stop early, such as ``"p_success +- 0.5%"``.
        engine: ``threads`` or ``dask``.
        workers: threads or processes; all cores if not given.
        cluster: address of a Dask scheduler.
        out: folder to keep it in, which can be gone on with; in memory only if not given.
        force: whether a campaign that is there may be replaced.
        resume: go on with a campaign that was interrupted.
        progress: called with how many cases have flown, and with how many there are.

    Raises:
        ConfigError: the campaign is wrong, or its folder must not be replaced.
    """
    scenario = scenario_name(scenario)
    activate(scenario)
    from edl6dof.api.public import EngineChoice, fly_campaign

    return fly_campaign(
        scenario,
        overrides,
        cases=cases,
        seed=seed,
        sampling=sampling,
        engine=EngineChoice(engine, workers, cluster),
        until=until,
        out=out,
        force=force,
        resume=resume,
        progress=progress,
    )


@in_python(after="after_s")
def faults(
    scenario: str | Path = "tianwen1",
    overrides: Overrides = (),
    *,
    sensors: bool = False,
    kinds: str | Iterable[str] = (),
    components: str | Iterable[str] = (),
    pairs: bool = False,
    at: str | float | Iterable[str | float] | None = None,
    phases: str | Iterable[str] = (),
    after_s: float | None = None,
    vehicles: int | None = None,
    seed: int | None = None,
    workers: int | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> CampaignResult:
    """Fail every thruster, or instrument, at every moment, one flight each, as ``edl6dof faults`` does.

    Args:
        scenario: file, or name of a shipped one.
        overrides: as of :func:`load`.
        sensors: fail instruments instead of thrusters.
        kinds: kinds of fault; ``"all"``.
        components: what fails; all that can if not given.
        pairs: fail every two of them together.
        at: when: times in s, ``"every 10 s"``, or events of the nominal flight.
        phases: when instead: phases.
        after_s: time from the start of the phase to the fault, s.
        vehicles: dispersed vehicles for each fault; the nominal one if not given.
        seed: of their dispersions.
        workers: threads; all cores if not given.
        out: as of :func:`campaign`.
        force: as of :func:`campaign`.
        progress: as of :func:`campaign`.

    Raises:
        ConfigError: everything that is wrong with what is wanted.
    """
    scenario = scenario_name(scenario)
    activate(scenario)
    from edl6dof.api.public import faults as fly_faults

    return fly_faults(
        scenario,
        overrides,
        sensors=sensors,
        kinds=kinds,
        components=components,
        pairs=pairs,
        at=at,
        phases=phases,
        after_s=after_s,
        vehicles=vehicles,
        seed=seed,
        workers=workers,
        out=out,
        force=force,
        progress=progress,
    )


@in_python()
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
        campaign: folder, or result, of a campaign.
        case: its number.
        out: as of :func:`fly`.
        replay: as of :func:`fly`.
        force: as of :func:`fly`.

    Returns:
        The flight; its ``differences`` name the columns in which it is not as its row, by as much as a bit.

    Raises:
        ConfigError: there is no such case.
    """
    if isinstance(campaign, str | Path):
        activate(campaign)
    from edl6dof.api.public import refly as refly_case

    return refly_case(campaign, case, out, replay, force)


@in_python()
def calibrate(
    scenario: str | Path,
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
        overrides: as of :func:`load`.
        flights: of each design, instead of the file's.
        out: folder for what was found; none if not given.
        force: as of :func:`campaign`.
        progress: as of :func:`campaign`.

    Raises:
        ConfigError: the section is wrong, or too few flights come to the figures.
    """
    scenario = scenario_name(scenario)
    activate(scenario)
    from edl6dof.api.public import calibrate as fit

    return fit(scenario, overrides, flights, out, force, progress)


def verify(*cases: str) -> list[Report]:
    """Run check cases against their independent references, as ``edl6dof verify`` does; all if none is named.

    Raises:
        ValueError: there is no such case.
    """
    from edl6dof.api.public import verify as run_cases

    return run_cases(cases)
