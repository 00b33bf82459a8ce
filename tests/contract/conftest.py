"""The Tianwen-1 onboard record, built once."""

import pytest

from edl6dof.sim.records import build_onboard, build_tables
from edl6dof.sim.scenario import load_scenario


@pytest.fixture(scope="session")
def scenario():
    return load_scenario("tianwen1").scenario


@pytest.fixture(scope="session")
def shared_onboard(scenario):
    return build_onboard(scenario, build_tables(scenario))
