"""Beams and flags of saturation that are watched: who goes, who stays, who comes back."""

from collections import namedtuple

import numpy as np
import pytest

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.navigation.exclusions import (
    BEAM_WATCH,
    BEAMS,
    EXCLUSIONS,
    INERTIAL_UNIT,
    MAX_CHANGES,
    BeamWatchParams,
    note_changes,
    watch_beams,
)
from edl6dof.fsw.navigation.instruments import INSTRUMENTS
from edl6dof.fsw.navigation.redundancy import exclude_stale_flags
from edl6dof.fsw.navigation.solution import INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.interface.sensed import RADAR

Planet = namedtuple("Planet", "rotation_rate")


def filled(model):
    record = np.zeros(1, dtype_of(type(model)))
    fill(record[0], model)
    return record[0]


def healthy():
    health = np.zeros(1, INSTRUMENT_HEALTH)
    for name in INSTRUMENT_HEALTH.names:
        health[name] = 1
    return health


class Beams:
    """Four beams that move over the ground, and what the filter made of them. A look takes 50 ms."""

    def __init__(self, speed=100.0, **changed):
        self.params = filled(BeamWatchParams(refused_looks=10, silent_looks=20, agreed_looks=30, **changed))
        self.radar, self.solution = np.zeros(1, RADAR), np.zeros(1, SOLUTION)
        self.health, self.memory = healthy(), np.zeros(1, BEAM_WATCH)
        self.instruments = np.zeros(1, INSTRUMENTS)
        self.instruments["n_beams"], self.instruments["beam_axis"][0, :4] = 4, (1.0, 0.0, 0.0)
        self.solution["r_I"], self.solution["q_I2B"] = (-3.4e6, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
        self.planet = Planet(rotation_rate=7e-5)
        self.solution["v_I"], self.solution["t"] = (0.0, -3.4e6 * 7e-5, speed), 300.0

    def look(self, times, refused=(), silent=(), looked=1):
        self.solution["looked"] = looked
        self.solution["ranges_refused"] = self.solution["speeds_refused"] = sum(1 << i for i in refused)
        self.radar["locked"][0, :4] = [i not in silent for i in range(4)]
        for _ in range(times):
            self.solution["t"] += 0.05
            watch_beams(
                self.params,
                self.planet,
                self.instruments[0],
                self.radar[0],
                self.solution[0],
                health=self.health[0],
                memory=self.memory[0],
            )
        out = [[i for i in range(4) if not self.health[name][0, i]] for name in ("beam_range", "beam_speed")]
        assert out[0] == out[1]
        return out[0]


def test_a_beam_refused_again_and_again_is_excluded_and_given_back_when_it_agrees_for_long():
    beams = Beams()
    assert beams.look(9, refused=[2]) == []
    assert beams.look(1, refused=[2]) == [2]
    assert beams.look(29) == [2]
    assert beams.look(1) == []


def test_a_beam_refused_every_other_look_keeps_its_place():
    beams = Beams()
    for _ in range(100):
        assert beams.look(1, refused=[1]) == beams.look(1) == []


@pytest.mark.parametrize("refused", [(0, 1, 2), (0, 1, 2, 3)])
def test_most_beams_at_once_are_not_wrong(refused):
    assert Beams().look(1000, refused=refused) == []


def test_a_range_that_is_refused_leaves_the_speed_in_use_and_the_reverse():
    for wrong, sound in (("range", "speed"), ("speed", "range")):
        beams = Beams()
        beams.look(1)
        beams.solution[f"{wrong}s_refused"] = 0b0100
        for _ in range(10):
            watch_beams(
                beams.params,
                beams.planet,
                beams.instruments[0],
                beams.radar[0],
                beams.solution[0],
                health=beams.health[0],
                memory=beams.memory[0],
            )
        assert list(beams.health[f"beam_{wrong}"][0, :4]) == [1, 1, 0, 1]
        assert list(beams.health[f"beam_{sound}"][0, :4]) == [1, 1, 1, 1]


@pytest.mark.parametrize(
    ("range_rate", "speed", "excluded"),
    [
        pytest.param(30.0, -30.0, [], id="part that falls ahead"),
        pytest.param(0.0, -30.0, [3], id="range that stays"),
        pytest.param(-80.0, -30.0, [3], id="range that falls"),
        pytest.param(-80.0, 60.0, [3], id="ground, with a wrong speed"),
        pytest.param(30.0, 60.0, [3], id="speed of the wrong sign"),
        pytest.param(0.0, 0.0, [3], id="part of the vehicle itself"),
    ],
)
@pytest.mark.parametrize("lost", [(), (3, 12)])
def test_a_refused_echo_that_moves_away_is_of_a_part_ahead_and_the_beam_works(
    range_rate, speed, excluded, lost
):
    """Noise of the range: 1 m, alternating; without an echo in the looks ``lost``."""
    beams, out = Beams(), []
    beams.instruments["range_sigma"] = 1.0
    beams.radar["speed"][0, :4] = 80.0
    for k in range(100):
        beams.radar["range"][0, 3] = 2000.0 + 0.05 * k * range_rate + (-1) ** k
        beams.radar["speed"][0, 3] = speed
        out = beams.look(1, refused=[3], silent=[3] if k in lost else [])
    assert out == excluded


def test_a_part_ahead_that_is_seen_now_and_then_is_the_same_part():
    """A swinging beam sees it for 0.3 s, then the ground for 0.1 s."""
    beams = Beams()
    beams.instruments["range_sigma"], beams.radar["speed"][0, :4] = 1.0, 80.0
    for k in range(400):
        ground = k % 8 > 5
        beams.radar["range"][0, 3] = 3000.0 if ground else 2000.0 + 1.5 * k + (-1) ** k
        beams.radar["speed"][0, 3] = 80.0 if ground else -30.0
        assert beams.look(1, refused=[] if ground else [3]) == []


def test_of_two_beams_with_an_echo_none_can_be_told_wrong():
    beams = Beams()
    assert 0 not in beams.look(15, refused=[0], silent=[2, 3])


def test_a_beam_without_echo_is_excluded_unless_most_have_none():
    beams = Beams()
    assert beams.look(19, silent=[3]) == beams.look(1) == []
    assert beams.look(20, silent=[3]) == [3]
    assert Beams().look(1000, silent=[1, 2, 3]) == []


def test_a_beam_over_one_steep_slope_is_silent_and_healthy():
    """In hover all looks are at the same slope; then 30 m of path show a failed beam, at 5 m/s 121 looks."""
    assert Beams(speed=0.0).look(1000, silent=[3]) == []
    beams = Beams(speed=5.0)  # the first look begins the path
    assert beams.look(120, silent=[3]) == []
    assert beams.look(2, silent=[3]) == [3]
    beams = Beams(speed=5.0)
    for _ in range(10):
        assert beams.look(100, silent=[3]) == beams.look(1) == []


@pytest.mark.parametrize(("angle_deg", "excluded"), [(44.0, [3]), (46.0, [])])
def test_a_beam_that_looks_too_flat_for_ground_that_slopes_may_be_silent(angle_deg, excluded):
    beams, angle = Beams(), np.radians(angle_deg)
    beams.instruments["beam_axis"][0, 3] = np.cos(angle), np.sin(angle), 0.0
    assert beams.look(1000, silent=[3]) == excluded


def test_beams_are_left_alone_where_nobody_looked_or_nobody_asks():
    assert Beams().look(1000, refused=[0], looked=0) == []
    assert Beams(enabled=False).look(1000, refused=[0]) == []


@pytest.mark.parametrize(("reading", "excluded"), [(0.4, True), (0.6, False)])
def test_flag_of_saturation_is_believed_as_long_as_the_motion_is_large(reading, excluded):
    """Range 1 rad/s; half of it is where a flag becomes doubtful."""
    health, flagged = np.ones(3, int), np.zeros(3)
    for k in range(21):
        assert health.all() or k == 20
        exclude_stale_flags(
            1.95, np.eye(3), 3, 1.0, np.array([0, 1, 0]), (0.0, 0.1 * reading, 0.0), 0.1, health, flagged
        )
    assert list(health) == [1, 0 if excluded else 1, 1]


def test_log_notes_each_change_once_and_is_full_in_the_end():
    known, health, motion, log = (
        np.zeros(1, INSTRUMENTS),
        healthy(),
        np.zeros(1, MOTION),
        np.zeros(1, EXCLUSIONS),
    )
    known["n_beams"], motion["rate_known"] = 4, 1
    note_changes(known[0], 1.0, health[0], motion[0], log[0])
    assert log["n_changes"][0] == 0
    health["beam_range"][0, 2], motion["rate_known"] = 0, 0
    for t in (2.0, 3.0):
        note_changes(known[0], t, health[0], motion[0], log[0])
    motion["rate_known"] = 1
    note_changes(known[0], 4.0, health[0], motion[0], log[0])
    changes = log["changes"][0, : log["n_changes"][0]]
    assert [tuple(one) for one in changes] == [
        (2.0, BEAMS + 2, 0), (2.0, INERTIAL_UNIT, 0), (4.0, INERTIAL_UNIT, 1),
    ]  # fmt: skip
    for k in range(100):
        motion["rate_known"] = k % 2
        note_changes(known[0], 5.0 + k, health[0], motion[0], log[0])
    assert log["n_changes"][0] == MAX_CHANGES
