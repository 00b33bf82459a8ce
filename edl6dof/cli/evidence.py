"""Commands that compare the simulator with closed forms and with papers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from edl6dof.api.functions import activate
from edl6dof.cli.exit_status import NOT_WITHIN_LIMITS, refuse
from edl6dof.cli.group import Sets, argument, flag, option

#: More flights than any mean, and than any mission, needs.
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
    """
    from edl6dof.cli.check_cases import fly_golden, run_cases

    return fly_golden(names or [], as_json) if golden else run_cases(names or [], as_json, plots, force)


def figures(
    scenario: Annotated[str, argument("SCENARIO", "Scenario file, or the name of a shipped one.")],
    sets: Sets = None,
    flights: Annotated[int | None, option("N", "Flights; 30 if not given.", "-n", "--flights")] = None,
    as_json: Annotated[bool, flag("Print JSON instead of tables.", "--json")] = False,
) -> int:
    """Compute mean and spread of figures over many flights.

    The flights differ by a millionth of a metre per second at their start. The digits of one flight are one
    random draw of many, so documents quote the results of this command.

    Exit status: 0 every flight within limits, 1 not, 2 bad input, 130 interrupted.
    """
    activate(scenario)
    from edl6dof.campaign.ensemble import FLIGHTS, fly_neighbours, sample_means
    from edl6dof.cli.evidence_tables import plain_means, show_figures
    from edl6dof.cli.progress import count_runs
    from edl6dof.config.dump import json_text
    from edl6dof.scenario.loading import load_scenario

    count = FLIGHTS if flights is None else flights
    if not 2 <= count <= MOST_FLIGHTS:
        return refuse(f"-n {count}: a spread needs 2 flights, and at most {MOST_FLIGHTS} are flown")
    loaded = load_scenario(scenario, sets or ())
    with count_runs(loaded.scenario.name, quiet=as_json) as progress:
        rows = fly_neighbours(loaded, count, progress=lambda done, row: progress(done, count))
    means = sample_means(rows, loaded.scenario.published)
    if as_json:
        print(json_text(plain_means(loaded, rows, means)), end="")
    else:
        show_figures(loaded, rows, means)
    return 0 if all(row["success"] for row in rows) else NOT_WITHIN_LIMITS


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
    out: Annotated[Path | None, option("FOLDER", "Folder; runs/validation if not given.")] = None,
    force: Annotated[bool, flag("Replace an existing folder.", "--force")] = False,
    as_json: Annotated[bool, flag("Print JSON instead of the table.", "--json")] = False,
) -> int:
    """Compare dispersed flights of missions with published values.

    A mission is a scenario with published values of its flight and a file that disperses it.
    Afterwards, the same flights with a report: edl6dof campaign NAME -n N.

    Exit status: 0 nine in ten flown values within three sigma, 1 not, 2 bad input, 130 interrupted.
    """
    activate(*(names or []))
    from edl6dof.cli.evidence_tables import show_missions
    from edl6dof.cli.progress import count_runs
    from edl6dof.missions.mission import compare, load_mission, reached_goal, shipped_missions
    from edl6dof.missions.write import to_json, write_validation
    from edl6dof.runs.files import atomic_folder, default_folder

    count = 200 if flights is None else flights
    if not 2 <= count <= MOST_OF_A_MISSION:
        return refuse(f"-n {count}: a spread needs 2 flights, and at most {MOST_OF_A_MISSION} are flown")
    missions = [load_mission(name, count) for name in names or shipped_missions()]
    if twice := {one.name for one in missions if [two.name for two in missions].count(one.name) > 1}:
        return refuse(f"{', '.join(sorted(twice))}: named twice")
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
    return 0 if reached_goal(compared) else NOT_WITHIN_LIMITS


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
    """
    activate(scenario)
    from edl6dof.api.calibration import found_by, write_findings
    from edl6dof.calibration.problem import load_calibration
    from edl6dof.cli.evidence_tables import show_calibration
    from edl6dof.cli.progress import count_runs
    from edl6dof.runs.files import atomic_folder, default_folder

    calibration = load_calibration(scenario, tuple(sets or ()), flights)
    name = calibration.loaded.scenario.name
    target = out or default_folder(f"calibration-{name}", force)
    with atomic_folder(target, "calibration", force) as folder:
        with count_runs(name, quiet=as_json) as progress:
            found = found_by(calibration, scenario, progress)
        summary = write_findings(found, folder, scenario, sets or (), flights)
    if as_json:
        print(summary, end="")
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
    """
    activate()
    from edl6dof.cli.studies import list_studies, run_study

    if name is None:
        return list_studies()
    return run_study(name, runs=runs, only=only or (), out=out, force=force, quick=quick, as_json=as_json)
