"""A trim wing that does not report itself open counts as failed after a while, and from then on."""

import numpy as np
import pytest

from edl6dof.fsw.diagnosis.trim_wing import watch_trim_wing
from edl6dof.fsw.health import HEALTH
from edl6dof.fsw.navigation import NAV
from edl6dof.fsw.vehicle_state import VEHICLE_STATE

PATIENCE, COMMANDED_AT = 2.0, 100.0


@pytest.fixture
def watch():
    state, nav, health = (np.zeros(1, dtype)[0] for dtype in (VEHICLE_STATE, NAV, HEALTH))
    state["wing_commanded"], state["wing_time"] = 1, COMMANDED_AT

    def failed(late, is_open=0):
        nav["t"], nav["wing_open"] = COMMANDED_AT + PATIENCE + late, is_open
        watch_trim_wing(PATIENCE, state, nav, health)
        return bool(health["wing_failed"])

    failed.state = state
    return failed


def test_silence_after_the_patience_is_a_failure_for_good(watch):
    assert [watch(-0.1), watch(0.1), watch(0.2, is_open=1)] == [False, True, True]


def test_wing_that_reports_itself_open_has_not_failed(watch):
    assert not watch(10.0, is_open=1)


def test_wing_that_was_not_commanded_has_not_failed(watch):
    watch.state["wing_commanded"] = 0
    assert not watch(10.0)
