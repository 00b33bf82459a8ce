"""What the log of navigation says of instruments: words, and figures beside the true faults."""

import numpy as np
import pytest

from edl6dof.fsw.navigation.exclusions import (
    ACCELEROMETERS,
    BEAMS,
    EXCLUSIONS,
    GYROS,
    INERTIAL_UNIT,
    MAX_CHANGES,
    STAR_TRACKER,
    note_changes,
)
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION
from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.metrics.figures import FIGURES
from edl6dof.metrics.out_of_use import exclusion_figures, exclusions
from edl6dof.vehicle.faults.fault import FaultParams
from edl6dof.vehicle.plant import NOT_BEGUN, STATE

COMPONENTS = {
    "gyro": ["g1", "g2", "g3"],
    "accelerometer": ["a1"],
    "beam": ["b1", "b2"],
    "radar": ["r1", "r2"],
    "star_tracker": ["s1"],
    "inertial_unit": ["inertial_unit"],
    "branch": ["left", "right"],
    "flow_meter": ["left", "right"],
}


def log(*changes, meters=()):
    """``meters``: number and time of flow meters that are believed no more."""
    fsw = np.zeros(1, FSW)
    for number, t in meters:
        fsw["diagnosis"]["flow"]["meter_failed"][0, number] = 1
        fsw["diagnosis"]["flow"]["failed_at"][0, number] = t
    record = fsw["navigation"]["exclusions"][0]
    record["n_changes"] = len(changes)
    record["changes"][: len(changes)] = list(changes)
    return exclusions(fsw[0], COMPONENTS)


def figures(found, *faults):
    """``faults``: kind, component, name, and when it began."""
    plant = np.zeros(1, STATE)
    plant["fault_since"] = NOT_BEGUN
    plant["fault_since"][0, : len(faults)] = [since for *_, since in faults]
    params = [
        FaultParams.model_validate({"kind": kind, component: name, "at": {"time_s": 1.0}})
        for kind, component, name, _ in faults
    ]
    return exclusion_figures(found, params, COMPONENTS, {"r1": ["b1"], "r2": ["b2"]}, plant[0])


def test_each_change_in_words():
    found = log(
        (1.0, GYROS + 2, 0), (2.0, ACCELEROMETERS, 0), (3.0, BEAMS + 1, 0), (4.0, BEAMS + 1, 1),
        (5.0, STAR_TRACKER, 0), (6.0, INERTIAL_UNIT, 0), (7.0, INERTIAL_UNIT, 1),
    )  # fmt: skip
    assert [one.label for one in found] == [
        "gyro g3 excluded", "accelerometer a1 excluded", "beam b2 excluded", "beam b2 back in use",
        "star tracker s1 excluded", "gyros saturated", "gyros read again",
    ]  # fmt: skip
    assert [one.t_s for one in found] == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]


def test_right_exclusion_has_a_time_and_wrong_ones_count():
    found = log((10.0, GYROS + 1, 0), (12.0, BEAMS, 0), (14.0, BEAMS, 1))
    assert figures(found, ("hardover", "gyro", "g2", 9.5)) == {
        "instrument_false_alarms": 1.0, "time_to_exclude_s": pytest.approx(0.5),
    }  # fmt: skip
    assert figures(found, ("false_lock", "beam", "b1", 11.0))["time_to_exclude_s"] == pytest.approx(1.0)
    assert figures(found, ("hardover", "gyro", "g1", 9.5)) == {"instrument_false_alarms": 2.0}
    assert figures(found) == {"instrument_false_alarms": 2.0}


def test_a_beam_of_a_dead_radar_is_excluded_rightly_and_one_of_the_other_radar_wrongly():
    found = log((11.0, BEAMS + 1, 0), (12.0, BEAMS, 0))
    told = figures(found, ("reading_outage", "radar", "r2", 10.0))
    assert told == {"instrument_false_alarms": 1.0, "time_to_exclude_s": pytest.approx(1.0)}


def test_exclusion_before_the_fault_is_a_false_alarm():
    found = log((10.0, GYROS + 1, 0))
    assert figures(found, ("hardover", "gyro", "g2", 10.5)) == {"instrument_false_alarms": 1.0}
    assert figures(found, ("hardover", "gyro", "g2", NOT_BEGUN)) == {"instrument_false_alarms": 1.0}


def test_saturated_gyros_isolate_none_of_them():
    found = log((10.0, INERTIAL_UNIT, 0), (11.0, INERTIAL_UNIT, 1))
    assert figures(found) == {"instrument_false_alarms": 0.0}
    assert figures(found, ("gyros_saturated", "inertial_unit", "inertial_unit", 9.98)) == {
        "instrument_false_alarms": 0.0, "time_to_exclude_s": pytest.approx(0.02),
    }  # fmt: skip


def test_figures_are_declared():
    found = log((10.0, GYROS + 1, 0))
    declared = {figure.name for figure in FIGURES if figure.source == "exclusions"}
    assert figures(found, ("hardover", "gyro", "g2", 9.5)).keys() == declared


def test_flow_meters_stand_among_the_others_in_the_order_of_time():
    found = log((1.0, GYROS, 0), (3.0, BEAMS, 0), meters=[(1, 2.0)])
    assert [one.label for one in found] == [
        "gyro g1 excluded",
        "flow meter right excluded",
        "beam b1 excluded",
    ]
    named = figures(found, ("reading_outage", "flow_meter", "right", 1.5))
    assert named == {"instrument_false_alarms": 2.0, "time_to_exclude_s": pytest.approx(0.5)}


def test_log_holds_each_change_once_and_in_the_order_of_time():
    """A beam is out of use when its range or its speed is; three cycles after each change add nothing."""
    instruments, memory = np.zeros(1, ONBOARD["instruments"])[0], np.zeros(1, EXCLUSIONS)[0]
    health, motion = np.ones(1, INSTRUMENT_HEALTH)[0], np.zeros(1, MOTION)[0]
    instruments["n_gyros"], instruments["n_accelerometers"], instruments["n_beams"] = 3, 2, 2
    instruments["n_trackers"] = 2
    motion["rate_known"] = 1
    changes = [
        (1.0, health["gyro"], 2, 0, GYROS + 2),
        (2.0, health["accelerometer"], 1, 0, ACCELEROMETERS + 1),
        (3.0, health["beam_range"], 0, 0, BEAMS),
        (4.0, health["beam_speed"], 1, 0, BEAMS + 1),
        (5.0, health["gyro"], 2, 1, GYROS + 2),
        (6.0, motion, "rate_known", 0, INERTIAL_UNIT),
        (7.0, health["star_tracker"], 1, 0, STAR_TRACKER + 1),
        (8.0, motion, "rate_known", 1, INERTIAL_UNIT),
    ]
    note_changes(instruments, 0.0, health, motion, memory)
    assert memory["n_changes"] == 0
    for t, where, which, in_use, _ in changes:
        where[which] = in_use
        for late in (0.0, 0.02, 0.04):
            note_changes(instruments, t + late, health, motion, memory)
    found = memory["changes"][: memory["n_changes"]].tolist()
    assert found == [(t, number, in_use) for t, _, _, in_use, number in changes]


def test_log_that_is_full_loses_what_comes_after():
    instruments, memory = np.zeros(1, ONBOARD["instruments"])[0], np.zeros(1, EXCLUSIONS)[0]
    health, motion = np.ones(1, INSTRUMENT_HEALTH)[0], np.zeros(1, MOTION)[0]
    for k in range(MAX_CHANGES + 5):
        motion["rate_known"] = k % 2
        note_changes(instruments, float(k), health, motion, memory)
    assert memory["n_changes"] == MAX_CHANGES
    assert memory["changes"]["t"].tolist() == list(range(MAX_CHANGES))
