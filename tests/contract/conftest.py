"""The Tianwen-1 onboard record, built once."""

import pytest
from onboard_states import states

from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.planned_entry import planned_again
from edl6dof.scenario.records import build_onboard


@pytest.fixture(scope="session")
def scenario():
    return load_scenario("tianwen1").scenario


@pytest.fixture(scope="session")
def shared_onboard(scenario):
    onboard = build_onboard(scenario)
    planned = planned_again(onboard, scenario)
    for law in ENTRY_LAWS.members:  # a flight plans for its own law only
        if law.plan is not None:
            law.plan(onboard, planned)
    return onboard


@pytest.fixture(scope="session")
def whole_grid(shared_onboard):
    return list(states(shared_onboard))


@pytest.fixture(scope="session")
def grid(whole_grid):
    return [nav for nav in whole_grid if nav["speed"] > 0.0]
