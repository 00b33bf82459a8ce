"""Every entry law on the same entries: five vehicles, what may be other than planned one thing at a time, and
two of them with everything dispersed.

No paper's experiment but this simulator's own: on each vehicle one plant, one attitude controller, one
reversal logic and the same errors for all laws, from entry interface to the mortar.  The miss is that of the
point entry guidance steers to, at mortar fire.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.rows import Row, table_of
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.scenario.schema import Scenario
from edl6dof.studies.call_time import call_time
from edl6dof.studies.guidance.conditions import CONDITIONS, DISPERSED, WAVES_AND_GUSTS
from edl6dof.studies.guidance.drawings import drawings
from edl6dof.studies.guidance.figures import of_flight
from edl6dof.studies.guidance.reach import lift_up, out_of_reach
from edl6dof.studies.guidance.tables import REMARKS, findings, grids, of
from edl6dof.studies.guidance.vehicles import VEHICLES, Vehicle, entries, with_law
from edl6dof.studies.study import Progress, Report, Study

#: A law of constant magnitude is no guidance.
LAWS = tuple(name for name in ENTRY_LAWS.names if name != "constant_bank")
#: Dispersed flights for each flight of a condition.
_PER_CONDITION = 20


def run(laws: Sequence[str], flights: int, progress: Progress) -> Report:
    """Fly the laws: ``flights`` dispersed entries, and a twentieth of that in each condition."""
    rows: list[Row] = []
    calls: dict[tuple[str, str], float] = {}
    total = sum(len(cases(vehicle, vehicle.load().scenario, "", flights)) for vehicle in VEHICLES) * len(laws)
    for vehicle in VEHICLES:
        for law in laws:
            loaded = with_law(vehicle, law)
            planned = cases(vehicle, loaded.scenario, law, flights)
            for row in fly_rows(loaded, planned, collect=of_flight):
                rows.append(row)
                progress(len(rows), total)
            calls[vehicle.name, law] = call_time(loaded)
    far = [row for vehicle in VEHICLES if vehicle.dispersions for row in lift_up(vehicle, rows, flights)]
    beyond = {vehicle.name: out_of_reach(of(far, vehicle=vehicle.name)) for vehicle in VEHICLES}
    return Report(
        tuple(findings(rows, calls, beyond)),
        tuple(drawings(rows)),
        table_of([*rows, *far]),
        total + len(far),
        REMARKS,
        tuple(grids(rows, calls)),
    )


def cases(vehicle: Vehicle, scenario: Scenario, law: str, flights: int) -> list[Case]:
    """All that a law flies of a vehicle."""
    label = {"vehicle": vehicle.name, "law": law}
    some = range(max(flights // _PER_CONDITION, 1))
    plan = [(condition, flight) for condition in CONDITIONS for flight in some]
    flown = [condition.case(i, scenario, flight, label) for i, (condition, flight) in enumerate(plan)]
    return (
        [*flown, *_dispersed(vehicle.dispersions, flights, len(flown), label)]
        if vehicle.dispersions
        else flown
    )


def _dispersed(dispersions: str, flights: int, first: int, label: dict[str, str]) -> Iterator[Case]:
    for flight, truth in enumerate(entries(dispersions, flights)):
        about = {**label, "condition": DISPERSED}
        yield Case(first + flight, {**truth, **WAVES_AND_GUSTS}, profile=flight, label=about)


STUDY = Study(
    "guidance",
    "Entry laws on the same entries: other air, lift, wind and entry angle, slow bank, and all dispersed",
    "this simulator, 2026",
    partial(run, LAWS),
    runs=200,
    quick_runs=20,
    counted=True,
    parts=LAWS,
    run_parts=run,
)
