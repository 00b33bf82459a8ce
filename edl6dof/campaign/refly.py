"""One case of a campaign flown again, the long way: with all its telemetry, and its scenario written out."""

from __future__ import annotations

import math

import pyarrow as pa

from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.fault_response import collected
from edl6dof.config.document.overrides import with_values
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight, fly


def case_scenario(plan: Plan, number: int) -> LoadedScenario:
    """The scenario of a case, checked like a file.

    Raises:
        ConfigError: there is no such case, or its values are not allowed.
    """
    if not 0 <= number < plan.count:
        raise ConfigError([Problem("case", 0, 0, "", f"must be 0 .. {plan.count - 1} (got {number})")])
    case = next(plan.cases(number, number + 1))
    changes = {**case.changes(plan.loaded.scenario.truth), "name": f"{plan.name}_case{number}"}
    return check_document(with_values(plan.loaded.document, changes, Scenario))


def reflown(plan: Plan, number: int) -> Flight:
    """Fly a case again."""
    return fly(case_scenario(plan, number))


def differences(table: pa.Table, place: object, plan: Plan, number: int, flight: Flight) -> list[str]:
    """Columns in which a flight differs from its row, by as much as one bit; ``place`` is whose table it is.

    Raises:
        ConfigError: the case has no row yet.
    """
    found = table["case"].to_pylist()
    if number not in found:
        raise ConfigError([Problem(str(place), 0, 0, "", f"case {number} has not flown yet")])
    row = table.slice(found.index(number), 1).to_pylist()[0]
    mine = {
        "success": flight.success,
        "cause": flight.cause,
        "outcome": flight.outcome,
        "end_s": flight.time_s,
        **flight.metrics,
        **(collect(flight) if (collect := collected(plan)) else {}),
    }
    case = next(plan.cases(number, number + 1))
    known = {
        "case",
        *mine,
        *case.label,
        *(f"truth.{path}" for path in case.truth),
        *(f"belief.{path}" for path in case.belief),
        "profile",
    }
    extra = [name for name, value in row.items() if name not in known and value is not None]
    return [name for name, value in mine.items() if not _same(value, row.get(name))] + extra


def _same(value: object, stored: object) -> bool:
    both_missing = (
        isinstance(value, float)
        and math.isnan(value)
        and (stored is None or isinstance(stored, float) and math.isnan(stored))
    )
    return both_missing or value == stored
