"""Commands that fly many flights of one scenario."""

from __future__ import annotations

import shlex
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from edl6dof.api.functions import activate
from edl6dof.cli.group import INTERRUPTED, check_target, refuse, write_file
from edl6dof.cli.options import Requirements, Sets, Workers, argument, flag, option
from edl6dof.config.errors import refusal

#: Events for which flights may end at the deployment of the parachute.
ENDS_AT_DEPLOYMENT = ("parachute", "trim_wing")


def campaign(
    scenario: Annotated[
        str | None, argument("CAMPAIGN", "Campaign file or name; with --resume, the folder of a campaign.")
    ] = None,
    sets: Sets = None,
    cases: Annotated[
        int | None, option("N", "Flights (at each point of a sweep).", "-n", "--cases", min=1)
    ] = None,
    seed: Annotated[int | None, option("N", "Seed of the dispersions.", min=0)] = None,
    sampling: Annotated[
        str | None,
        option("NAME", "monte_carlo, latin_hypercube, sobol, or sobol_indices (effect of each dispersion)."),
    ] = None,
    engine: Annotated[str, option("NAME", "threads (this machine) or dask.")] = "threads",
    cluster: Annotated[str | None, option("ADDRESS", "Dask scheduler, such as tcp://127.0.0.1:8786.")] = None,
    workers: Annotated[
        int | None, option("N", "Threads, or worker processes; all cores if not given.", min=1, max=1024)
    ] = None,
    out: Annotated[Path | None, option("FOLDER", "Folder; runs/<name> if not given.")] = None,
    force: Annotated[bool, flag("Replace an existing campaign.", "--force")] = False,
    resume: Annotated[bool, flag("Resume an interrupted campaign.", "--resume")] = False,
    until: Annotated[str | None, option("CONDITION", "Stop early, such as 'p_success +- 0.5%'.")] = None,
    quiet: Annotated[bool, flag("Print the success probability only.", "--quiet", "-q")] = False,
    as_json: Annotated[bool, flag("Print JSON.", "--json")] = False,
) -> int:
    """Fly many dispersed flights, or a grid of them.

    Afterwards: edl6dof report FOLDER, edl6dof refly FOLDER CASE.

    Exit status: 0 finished, 2 bad input or nothing could be written, 130 interrupted.

    edl6dof campaign tianwen1_mc -n 1000
    edl6dof campaign --resume runs/tianwen1_mc
    edl6dof campaign tianwen1_mc --until 'p_success +- 0.5%'
    """
    if scenario is None:
        words = "name a campaign file, such as tianwen1_mc, or with --resume the folder of a campaign"
        raise refusal("edl6dof campaign", words)
    activate(scenario)
    with _keeping("campaign", scenario, out, resume):
        from edl6dof.api.campaign import campaign_job, chosen_engine
        from edl6dof.cli.campaign_flight import fly_campaign

        flying, drawn = chosen_engine(engine, workers, cluster), (cases, seed, sampling)
        changes = tuple(sets or ())
        job = campaign_job(scenario, changes, drawn, flying, until, out=out, force=force, resume=resume)
        return fly_campaign(job, quiet=quiet, as_json=as_json)


@contextmanager
def _keeping(command: str, scenario: str, out: Path | None, resume: bool) -> Iterator[None]:
    """Print how to resume a campaign if it is interrupted; the cases flown so far are kept."""
    try:
        yield
    except KeyboardInterrupt:
        if not resume:
            raise  # nothing was written
        again = shlex.join([command, scenario, *(["--out", str(out)] if out else []), "--resume"])
        print(f"interrupted; what has flown is kept; go on with: edl6dof {again}", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None


def refly(
    folder: Annotated[Path, argument("FOLDER", "Folder of a campaign.")],
    case: Annotated[int | None, argument("CASE", "Number of the case, as the report names it.")] = None,
    worst: Annotated[
        str | None,
        option("FIGURE", "The case in which this figure is worst, such as landing_distance_m, instead."),
    ] = None,
    out: Annotated[
        Path | None, option("FOLDER", "Run folder; runs/<name>_case<number> if not given.")
    ] = None,
    force: Annotated[bool, flag("Replace an existing run folder.", "--force")] = False,
    replay: Annotated[bool, flag("Write the 3D replay.", "--replay/--no-replay")] = True,
) -> int:
    """Fly one case of a campaign again, with all its telemetry.

    Exit status: 0 identical to its row, 1 not, 2 bad input.

    edl6dof refly runs/tianwen1_mc 17
    edl6dof refly runs/tianwen1_mc --worst landing_distance_m
    """
    activate(folder)
    from edl6dof.api.campaign import refly_case, worst_case
    from edl6dof.api.flight import flown_into
    from edl6dof.campaign.run import resumed_plan
    from edl6dof.campaign.store import Store
    from edl6dof.metrics.figures import figure_of_merit
    from edl6dof.report.document import significant
    from edl6dof.runs.files import default_folder

    if (case is None) == (worst is None):
        raise refusal(folder, "name one case: its number, or --worst FIGURE")
    store = Store(folder)
    plan = resumed_plan(store)
    table = store.table()
    number = worst_case(table, worst) if worst is not None else case or 0
    target = out or default_folder(f"{folder.resolve().name}_case{number}", force)
    again = partial(refly_case, plan, table, folder, number)
    flight = flown_into(target, again, replay=replay, force=force, release=True)
    print(f"{target}: case {number}, {flight.outcome}")
    if worst is not None and (value := flight.figures.get(worst)) is not None:
        figure = figure_of_merit(worst)
        print(f"{figure.meaning}: {significant(value)} {figure.unit.label}".rstrip())
    if not flight.differences:
        print("identical to its row")
        return 0
    print(f"differs from its row: {', '.join(flight.differences)}")
    print(
        "program, files and libraries are those of the campaign; check this machine: edl6dof verify --golden"
    )
    return 1


def faults(
    scenario: Annotated[
        str,
        argument("SCENARIO", "Scenario, tianwen1 if not given; with --resume also the folder of a matrix."),
    ] = "tianwen1",
    sensors: Annotated[bool, flag("Faults of every instrument instead of thrusters.", "--sensors")] = False,
    kinds: Annotated[
        str,
        option(
            "LIST", "Kinds of fault, with commas, or all; stuck_off, or with --sensors all, if not given."
        ),
    ] = "",
    components: Annotated[
        str, option("LIST", "Components, such as D7,P1, with commas; by default all that can have the fault.")
    ] = "",
    pairs: Annotated[bool, flag("Let every pair of them fail together.", "--pairs")] = False,
    at: Annotated[
        str | None,
        option(
            "LIST",
            "Moments: times in s, 'every 10 s' of the nominal flight, or its events, such as "
            "bank_reversal, trim_wing, mortar, ignition, with commas.",
        ),
    ] = None,
    phases: Annotated[
        str,
        option(
            "LIST",
            "Phases at whose start the faults begin, with commas; by default one of each kind of "
            "control, with --sensors every phase.",
        ),
    ] = "",
    after: Annotated[
        float | None, option("S", "Time from the start of the phase to the fault; 1 s if not given.")
    ] = None,
    settings: Annotated[
        str, option("YAML", "Other keys of each fault, as under faults:, such as 'duration_s: 20'.", "--with")
    ] = "",
    sets: Sets = None,
    vehicles: Annotated[
        int | None,
        option(
            "N", "Dispersed vehicles for each fault; the nominal one if not given.", "-n", "--vehicles", min=1
        ),
    ] = None,
    seed: Annotated[int | None, option("N", "Seed of the dispersions.", min=0)] = None,
    workers: Workers = None,
    out: Annotated[Path | None, option("FOLDER", "Folder; runs/faults-<scenario> if not given.")] = None,
    force: Annotated[bool, flag("Replace an existing matrix.", "--force")] = False,
    resume: Annotated[bool, flag("Resume an interrupted matrix.", "--resume")] = False,
    as_json: Annotated[bool, flag("Print JSON instead of tables.", "--json")] = False,
) -> int:
    """Fly one fault in each flight, for every thruster and moment.

    Other kinds of fault apply to every engine, surface or parachute; --sensors to every instrument.

    The folder contains a row for each flight, and report.html maps of landing, isolation and its time.
    Afterwards: edl6dof refly FOLDER CASE.

    Exit status: 0 all within limits, 1 not, 2 bad input, 130 interrupted.

    edl6dof faults tianwen1
    edl6dof faults tianwen1 --out runs/map --kinds all --at 'every 10 s'
    edl6dof faults tianwen1 --out runs/sensors --sensors
    """
    activate(scenario)
    with _keeping("faults", scenario, out, resume):
        from edl6dof.api.campaign import chosen_engine, faults_job
        from edl6dof.campaign.fault_choice import FaultRequest
        from edl6dof.cli.campaign_flight import fly_campaign

        request = FaultRequest(
            *(sensors, kinds, components, pairs), phases=phases, after_s=after, at=at, settings=settings
        )
        changes, drawn, engine = tuple(sets or ()), (vehicles, seed), chosen_engine(workers=workers)
        job = faults_job(scenario, changes, request, drawn, engine, out=out, force=force, resume=resume)
        return fly_campaign(job, command="faults", as_json=as_json)


def covariance(
    campaign: Annotated[
        str,
        argument("CAMPAIGN", "Campaign, tianwen1_mc if not given; or the folder of one, to compare with it."),
    ] = "tianwen1_mc",
    at: Annotated[
        str, option("EVENT", "entry (its peaks), parachute, trim_wing, backshell or touchdown.")
    ] = "parachute",
    sets: Sets = None,
    pairs: Annotated[
        int, option("N", "Pairs of flights; more if there are more dispersions.", min=8, max=4096)
    ] = 24,
    each: Annotated[
        bool, flag("Also step each dispersion alone, to show where the response is linear.", "--each")
    ] = False,
    seed: Annotated[int | None, option("N", "Seed of the steps; the campaign's if not given.", min=0)] = None,
    workers: Workers = None,
    out: Annotated[
        Path | None, option("FILE", "Write the error budget (.csv) or the ellipse (.png, .pdf, .svg).")
    ] = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> None:
    """Compute the covariance of an event and its contributions.

    Every dispersion is one standard deviation high in half of the flights and low in their mirror images,
    all at once; a twentieth of the flights of a campaign suffices for its ellipse and error budget.

    Exit status: 0 formed, 2 bad input or nothing could be written, 130 interrupted.

    edl6dof covariance tianwen1_mc
    edl6dof covariance tianwen1_mc --at touchdown
    """
    activate(campaign)
    from edl6dof.api.campaign import is_campaign
    from edl6dof.api.progress import count_runs
    from edl6dof.campaign.covariance_estimate import flown, fly_alone, fly_covariance
    from edl6dof.campaign.covariance_flights import ending_at_deployment, figures_at
    from edl6dof.campaign.design.plan import load_plan
    from edl6dof.campaign.run import resumed_plan
    from edl6dof.campaign.store import Store
    from edl6dof.cli.analysis_tables import show_alone, show_covariance, write_budget

    event = figures_at(at)
    check_target(out, (".csv", ".png", ".pdf", ".svg"), force)
    folder, sampled = Path(campaign), None
    if not is_campaign(folder):
        plan = load_plan(campaign, tuple(sets or ()), seed=seed)
    elif sets:
        raise refusal(folder, "has its plan; its covariance accepts no other values")
    else:
        store = Store(folder)
        plan = resumed_plan(store)
        if seed is not None and plan.campaign is not None:
            plan = replace(plan, campaign=plan.campaign.model_copy(update={"seed": seed}))
        sampled = flown(store.table(list(event.all)), event, folder)
    if at in ENDS_AT_DEPLOYMENT:
        plan = ending_at_deployment(plan)
    with count_runs("covariance") as progress:
        began = time.perf_counter()
        found = fly_covariance(plan, event, pairs, workers, progress)
        took_s = time.perf_counter() - began
    show_covariance(plan.name, at, found, sampled, took_s)
    if each:
        show_alone(fly_alone(plan, event, workers), event)
    if out is None or out.suffix == ".csv":
        write_file(out, force, partial(write_budget, found))
    else:
        from edl6dof.report.campaign.footprint import ellipse_figure
        from edl6dof.report.matplotlib_figure import write_figure

        write_file(out, force, partial(write_figure, ellipse_figure(f"{plan.name}, {at}", found, sampled)))


def rare(
    campaign: Annotated[str, argument("CAMPAIGN", "Campaign file or name.")],
    requirement: Annotated[
        str, option("ID", "Requirement of the file, or figure that has a limit in the scenario.")
    ],
    requirements: Requirements = None,
    sets: Sets = None,
    size: Annotated[
        int, option("N", "Flights of each level of a population.", "-n", "--size", min=20, max=100_000)
    ] = 155,
    populations: Annotated[int, option("N", "Populations, whose spread is reported.", min=2, max=64)] = 4,
    seed: Annotated[int | None, option("N", "Seed; the campaign's if not given.", min=0)] = None,
    workers: Workers = None,
    out: Annotated[Path | None, option("FOLDER", "Folder; runs/rare-<campaign> if not given.")] = None,
    force: Annotated[bool, flag("Replace an existing folder of this command.", "--force")] = False,
    resume: Annotated[bool, flag("Resume an interrupted simulation.", "--resume")] = False,
    as_json: Annotated[bool, flag("Print JSON instead of tables.", "--json")] = False,
) -> int:
    """Compute the probability of a rare violation of a requirement.

    A subset simulation flies the dispersions of the campaign towards the violation: a probability of one in
    a hundred thousand takes about 4,000 flights. It also describes the region of the inputs in which the
    requirement is violated. The folder contains every flight, rare.html and the scenarios of the worst cases.

    Exit status: 0 finished, 2 bad input or nothing could be written, 130 interrupted.

    edl6dof rare tianwen1_mc requirements.yaml --requirement EDL-2
    edl6dof rare tianwen1_mc --requirement touchdown_vertical_m_s -n 1000
    """
    activate(campaign)
    from edl6dof.api import functions
    from edl6dof.api.progress import count_runs
    from edl6dof.api.reports import write_page
    from edl6dof.config.dump import json_text
    from edl6dof.report.campaign.rare import rare_report
    from edl6dof.report.terminal import show_report

    target = out or Path("runs") / f"rare-{Path(campaign).stem}"
    began = time.process_time()
    try:
        with count_runs("rare", as_json) as count:
            found = functions.rare(
                *(campaign, requirement, tuple(sets or ())),
                requirements=requirements,
                size=size,
                populations=populations,
                seed=seed,
                workers=workers,
                out=target,
                force=force,
                resume=resume,
                progress=lambda flown: count(flown, None),
            )
    except KeyboardInterrupt:
        print("interrupted; what has flown is kept; repeat the command with --resume", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:
        reason = f"{error.filename2 or error.filename or target}: {error.strerror or error}"
        return refuse(f"{reason}; what has flown is kept; repeat the command with --resume")
    page = target / "rare.html"
    report = rare_report(found)
    write_page(report, page, True, target)
    if as_json:
        print(json_text(found.data), end="")
    else:
        show_report(report)
        print(f"\n{time.process_time() - began:.0f} s of CPU in this run; {page}")
    return 0


def margins(
    scenario: Annotated[str, argument("SCENARIO", "Scenario; with -n a campaign.")],
    sets: Sets = None,
    phases: Annotated[
        str, option("LIST", "Phases, with commas; all with attitude control if not given.")
    ] = "",
    moments: Annotated[int, option("N", "Moments of each phase.", min=1, max=100)] = 3,
    vehicles: Annotated[
        int, option("N", "Dispersed vehicles, instead of the scenario itself.", "-n", "--vehicles", min=0)
    ] = 0,
    seed: Annotated[int | None, option("N", "Seed of the dispersions.", min=0)] = None,
    measure: Annotated[
        bool, flag("Measure margins too: push the vehicle, with more gain or later valves.", "--measure")
    ] = False,
    out: Annotated[Path | None, option("FILE", "Write the rows (.csv).")] = None,
    force: Annotated[bool, flag("Replace an existing file.", "--force")] = False,
) -> None:
    """Compute the stability margins of attitude control.

    For every phase and axis: gain, phase, delay and disk margin of the loop that flies, linearised at some
    moments, and the limit cycle of an axis that rests within a deadband, predicted and flown.

    Exit status: 0 computed, 2 bad input or nothing could be written.

    edl6dof margins tianwen1
    edl6dof margins tianwen1_mc -n 10 --moments 1
    """
    activate(scenario)
    from edl6dof.api import functions
    from edl6dof.api.progress import count_runs
    from edl6dof.cli.analysis_tables import show_margins, write_rows

    check_target(out, (".csv",), force)
    names = [name.strip() for name in phases.split(",") if name.strip()]
    with count_runs("margins") as progress:
        rows = functions.margins(
            *(scenario, tuple(sets or ())),
            phases=names,
            moments=moments,
            vehicles=vehicles,
            seed=seed,
            measure=measure,
            progress=progress,
        )
    show_margins(scenario, rows)
    write_file(out, force, partial(write_rows, rows))
