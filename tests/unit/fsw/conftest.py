"""The Tianwen-1 scenario with a plan that ends at the aim point, its onboard record and its planned entry,
built once.
"""

import pytest

from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.planned_entry import planned_again
from edl6dof.scenario.records import build_onboard

BANK = "points: [{at: 1500, bank_deg: 90}, {at: 3500, bank_deg: 90}]"
#: A bank angle of 90 deg at all speeds, shifted to the range.
PLANNED = f"flight_software.guidance.entry.reference_bank={{fit_range: true, {BANK}}}"


@pytest.fixture(scope="session")
def scenario():
    return load_scenario("tianwen1", [PLANNED]).scenario


@pytest.fixture(scope="session")
def shared_onboard(scenario):
    return build_onboard(scenario)


@pytest.fixture
def onboard(shared_onboard):
    """A copy that a test may change, shape (1,)."""
    return shared_onboard.copy()


@pytest.fixture(scope="session")
def planned_rows(scenario, shared_onboard):
    """Rows of the planned entry; for reading only."""
    rows = planned_again(shared_onboard, scenario)
    rows.flags.writeable = False
    return rows
