"""Commands that compare the simulator with closed forms and with papers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from edl6dof.api import functions
from edl6dof.api.functions import activate
from edl6dof.cli.group import NOT_WITHIN_LIMITS
from edl6dof.cli.options import Scenario, Sets, argument, flag, option
from edl6dof.config.errors import refusal

#: Most flights that are accepted for means, and for each mission.
MOST_FLIGHTS, MOST_OF_A_MISSION = 100_000, 1_000_000


def verify(
    names: Annotated[list[str] | None, argument("NAME", "Check cases; all if none is named.")] = None,
    as_json: Annotated[bool, flag("Print JSON.", "--json")] = False,
    plots: Annotated[
        Path | None, option("FOLDER", "Draw each case that has a history, as FOLDER/NAME.png.")
    ] = None,
    force: Annotated[bool, flag("Also replace files that you made or changed.", "--force")] = False,
    golden: Annotated[
        bool, flag("Fly the golden flights instead and compare all bits with those shipped.", "--golden")
    ] = False,
) -> int:
    """Check the simulator against closed forms and published tables.

    Everything is computed on this machine, and conservation laws are checked too. With --golden every
    shipped scenario and a small campaign are flown and compared bit for bit with what this version gave
    when it was made; NAME then names flights.

    Exit status: 0 all within tolerance or identical, 1 not, 2 bad input.

    edl6dof verify
    edl6dof verify kepler tumbling --plots plots
    """
    from edl6dof.cli.evidence_tables import fly_golden, run_cases

    return fly_golden(names or [], as_json) if golden else run_cases(names or [], as_json, plots, force)


def figures(
    scenario: Scenario,
    sets: Sets = None,
    flights: Annotated[int | None, option("N", "Flights; 30 if not given.", "-n", "--flights")] = None,
    as_json: Annotated[bool, flag("Print JSON instead of tables.", "--json")] = False,
) -> int:
    """Compute mean and spread of figures over many flights.

    The flights differ by a millionth of a metre per second at their start. The digits of one flight are one
    random draw of many, so documents quote the results of this command.

    Exit status: 0 every flight within limits, 1 not, 2 bad input, 130 interrupted.

    edl6dof figures tianwen1 -n 30
    edl6dof figures tianwen1 --set vehicle.mass.entry_kg=1350
    """
    activate(scenario)
    from edl6dof.api.progress import count_runs
    from edl6dof.campaign.ensemble import FLIGHTS, fly_neighbours, sample_means
    from edl6dof.cli.evidence_tables import show_figures
    from edl6dof.scenario.loading import load_scenario

    count = _enough(FLIGHTS if flights is None else flights, MOST_FLIGHTS)
    loaded = load_scenario(scenario, sets or ())
    with count_runs(loaded.scenario.name, quiet=as_json) as progress:
        rows = fly_neighbours(loaded, count, progress=lambda done, row: progress(done, count))
    means = sample_means(rows, loaded.scenario.published)
    show_figures(loaded.scenario, rows, means, as_json)
    return 0 if all(row["success"] for row in rows) else NOT_WITHIN_LIMITS


def _enough(flights: int, most: int) -> int:
    """Return a number of flights after checking that it suffices for a spread and is at most ``most``."""
    if not 2 <= flights <= most:
        raise refusal(f"-n {flights}", f"a spread needs 2 flights, and at most {most} are flown")
    return flights


def validate(
    names: Annotated[
        list[str] | None, argument("NAME", "Missions, by name or file; all shipped ones if none is named.")
    ] = None,
    flights: Annotated[
        int | None, option("N", "Dispersed flights of each; 200 if not given.", "-n", "--flights")
    ] = None,
    workers: Annotated[
        int | None, option("N", "Threads; all cores if not given.", "--jobs", "--workers", min=1, max=1024)
    ] = None,
    flown: Annotated[
        Path | None,
        option("FILE", "Trajectory of the real flight, csv, to draw over the flights of a mission."),
    ] = None,
    out: Annotated[Path | None, option("FOLDER", "Folder; runs/validation if not given.")] = None,
    force: Annotated[bool, flag("Replace an existing folder.", "--force")] = False,
    as_json: Annotated[bool, flag("Print JSON instead of the table.", "--json")] = False,
) -> int:
    """Compare dispersed flights of missions with published values.

    A mission is a scenario with published values of its flight and a file that disperses it.
    Afterwards, the same flights with a report: edl6dof campaign NAME -n N.

    Exit status: 0 the central 68 % contain a share of the flown values that fits 68 %, 1 not,
    2 bad input, 130 interrupted.

    edl6dof validate
    edl6dof validate viking1_mc -n 1000
    """
    activate(*(names or []))
    from edl6dof.api.progress import count_runs
    from edl6dof.cli.evidence_tables import show_missions
    from edl6dof.missions.agreement import is_calibrated
    from edl6dof.missions.mission import compare, load_mission, percentiles, shipped_missions
    from edl6dof.missions.write import to_json, write_validation
    from edl6dof.runs.files import atomic_folder, default_folder

    count = _enough(200 if flights is None else flights, MOST_OF_A_MISSION)
    if flown is not None and len(names or ()) != 1:
        raise refusal("--flown", "is the flight of one mission: name that mission alone")
    missions = [load_mission(name, count, flown) for name in names or shipped_missions()]
    if twice := {one.name for one in missions if [two.name for two in missions].count(one.name) > 1}:
        raise refusal(", ".join(sorted(twice)), "named twice")
    target = out or default_folder("validation", force)
    rows, compared = {}, []
    with atomic_folder(target, "validation", force) as folder:
        for mission in missions:
            with count_runs(mission.name, quiet=as_json) as progress:
                rows[mission.name] = mission.fly(workers, progress)
            compared.append(compare(mission, rows[mission.name]))
        write_validation(compared, rows, folder)
    if as_json:
        print(to_json(compared), end="")
    else:
        show_missions(compared, target)
    return 0 if is_calibrated(percentiles(compared)) else NOT_WITHIN_LIMITS


def calibrate(
    scenario: Annotated[str, argument("SCENARIO", "Scenario with a calibration section, such as tianwen1.")],
    sets: Sets = None,
    flights: Annotated[
        int | None,
        option("N", "Flights of each of the three designs (docs/calibration.md).", "-n", "--flights"),
    ] = None,
    out: Annotated[Path | None, option("FOLDER", "Folder; runs/calibration-<name> if not given.")] = None,
    force: Annotated[bool, flag("Replace an existing folder.", "--force")] = False,
    as_json: Annotated[bool, flag("Print JSON instead of tables.", "--json")] = False,
) -> int:
    """Fit uncertain parameters to the published figures of a flight.

    Writes calibrated.yaml, a scenario that extends this one.

    Exit status: 0 every figure explained within two sigma, 1 not, 2 bad input, 130 interrupted.

    edl6dof calibrate tianwen1
    edl6dof fly runs/calibration-tianwen1/calibrated.yaml --out runs/calibrated
    """
    activate(scenario)
    from edl6dof.api.progress import count_runs
    from edl6dof.calibration.problem import load_calibration
    from edl6dof.cli.evidence_tables import show_calibration
    from edl6dof.runs.files import default_folder

    name = load_calibration(scenario, tuple(sets or ()), flights).loaded.scenario.name
    target = out or default_folder(f"calibration-{name}", force)
    with count_runs(name, quiet=as_json) as progress:
        found = functions.calibrate(
            scenario, sets or (), flights=flights, out=target, force=force, progress=progress
        )
    if as_json:
        print((target / "summary.json").read_text(encoding="utf-8"), end="")
    else:
        show_calibration(found, target)
    return 0 if not found.unexplained else NOT_WITHIN_LIMITS


def study(
    name: Annotated[str | None, argument("NAME", "Study; without one, they are listed.")] = None,
    runs: Annotated[
        int | None,
        option(
            "N", "Flights; as many as the paper's, or the study's own number, if not given.", "-n", "--runs"
        ),
    ] = None,
    seed: Annotated[int | None, option("N", "Seed of the draws, of study guidance.", "--seed")] = None,
    only: Annotated[
        list[str] | None, option("LAW", "One law of those that a study compares; repeatable.", "--only")
    ] = None,
    out: Annotated[Path | None, option("FOLDER", "Folder; runs/study-<name> if not given.")] = None,
    force: Annotated[bool, flag("Replace an existing folder.", "--force")] = False,
    quick: Annotated[bool, flag("Fly few runs, as a quick test.", "--quick")] = False,
    as_json: Annotated[bool, flag("Print JSON instead of the table.", "--json")] = False,
) -> int:
    """Repeat a paper's experiment and compare the results.

    Exit status: 0 every published requirement is met, 1 not, 2 bad input, 130 interrupted.

    edl6dof study
    edl6dof study guidance --only fnpeg --only etpc -n 100
    """
    activate()
    from edl6dof.cli.studies import list_studies, run_study

    if name is None:
        return list_studies()
    return run_study(
        name, runs=runs, seed=seed, only=only or (), out=out, force=force, quick=quick, as_json=as_json
    )
