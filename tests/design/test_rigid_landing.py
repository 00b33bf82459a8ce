"""Verifies: the successive convexification of a rigid lander by finite differences, by flying its controls
through scipy's DOP853, and by the convex optimum of the point mass, which it cannot beat.

gravity 3.71 m/s2 | 900 kg | 1500 to 5000 N, 7500 N for the first second | tilt 25 deg, rate 15 deg/s, glide
slope 10 deg
"""

import sys
from dataclasses import replace
from functools import cache
from math import degrees, pi, radians
from pathlib import Path

import numpy as np
import pytest

from edl6dof.design.rigid_landing import LandingFigures, RigidLanding, excesses, figures_of
from edl6dof.design.successive import Nodes, first_guess, land, linearise, propagate

pytest.importorskip("cvxpy")
from edl6dof.design import successive

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from point_mass_landing import Landing, held_controls, solve

#: Position, velocity, quaternion and rates at ignition.
STARTS = {
    "near": ((200.0, 100.0, 1086.0), (10.0, 5.0, -59.0), (1.0, 0.05, 0.1, 0.02), (0.05, -0.03, 0.02)),
    "aside": ((-300.0, 200.0, 1086.0), (10.0, 5.0, -59.0), (1.0, 0.05, 0.1, 0.02), (0.05, -0.03, 0.02)),
    "far": ((600.0, 300.0, 1086.0), (10.0, 5.0, -59.0), (1.0, 0.05, 0.1, 0.02), (0.05, -0.03, 0.02)),
    "above": ((0.0, 0.0, 1200.0), (0.0, 0.0, -70.0), (1.0, 0.05, 0.1, 0.02), (0.05, -0.03, 0.02)),
    "low": ((50.0, 0.0, 800.0), (5.0, 0.0, -60.0), (1.0, 0.05, 0.1, 0.02), (0.05, -0.03, 0.02)),
}


def problem(start, full_time=1.0, torque=(280.0, 280.0, 400.0), rate_deg_s=15.0):
    position, velocity, q, rate = start
    return RigidLanding(
        start=np.array([900.0, *position, *velocity, *(np.array(q) / np.linalg.norm(q)), *rate]),
        dry_mass=700.0,
        thrust=(1500.0, 5000.0),
        full_thrust=7500.0,
        full_time=full_time,
        throttled_time=8.0,
        torque=np.array(torque),
        exhaust_speed=2942.0,
        gravity=3.71,
        inertia=np.array([600.0, 550.0, 700.0]),
        arm=np.array([0.004, -0.002, 0.0]),
        tilt=radians(25.0),
        rate=radians(rate_deg_s),
        glide_slope=radians(10.0),
    )


@cache
def landed(name):
    """What is found from one of the starts; for reading only."""
    return land(problem(STARTS[name]))


def quick(name):
    """From one of the starts with an attitude that costs next to nothing."""
    return replace(problem(STARTS[name], torque=(1000.0,) * 3, rate_deg_s=57.0), torque_price=0.0)


@cache
def quickly_landed(name):
    """What is found then; for reading only."""
    return land(quick(name))


def point_mass(landing, time, full_time):
    """Least propellant of the point mass with the same thrust, tilt and glide slope, in this time and in one
    a little shorter or longer, kg.
    """
    x = landing.start
    same = Landing(
        mass=x[0],
        thrust=landing.thrust,
        exhaust_speed=landing.exhaust_speed,
        gravity=landing.gravity,
        position=tuple(x[1:4]),
        velocity=tuple(x[4:7]),
        glide_slope=landing.glide_slope,
        tilt=landing.tilt,
        end_tilt=pi,
        full_thrust=landing.full_thrust,
        full_time=full_time,
    )
    found = (solve(same, held_controls(share * time, 60, full_time)) for share in (0.97, 1.0, 1.03))
    return min(one.fuel for one in found if one is not None)


def disturbed():
    """A problem, and nodes that are no flight."""
    landing = problem(STARTS["near"])
    guess, random = first_guess(landing, 30), np.random.default_rng(1)
    x = guess.x + random.normal(size=guess.x.shape) * (0.01 * np.max(np.abs(guess.x), axis=0) + 0.01)
    u = guess.u + random.normal(size=guess.u.shape) * np.array([300.0, 50.0, 50.0, 50.0])
    return landing, replace(guess, x=x, u=u)


def difference(landing, nodes, nudge):
    """Central difference of the states at the checked points; ``nudge(nodes, sign)`` moves the nodes."""
    return 0.5 * (linearise(landing, nudge(1.0)).x - linearise(landing, nudge(-1.0)).x)


#: One of each kind in the suite: mass, position, velocity, attitude, rate, thrust and torque at either end,
#: durations.
COLUMNS = (0, 2, 5, 8, 12, 14, 16, 18, 21, 22)


@pytest.mark.parametrize(
    "column", [pytest.param(k, marks=[] if k in COLUMNS else pytest.mark.long) for k in range(23)]
)
def test_linearisation_is_the_derivative(column):
    landing, nodes = disturbed()
    found = linearise(landing, nodes).by[..., column]
    if column == 22:
        parts = (nodes.parts == 0, nodes.parts == 1)
        for part, own in enumerate(parts):
            step = 1e-4 * np.eye(2)[part]
            by = difference(
                landing, nodes, lambda s, d=step: replace(nodes, durations=nodes.durations + s * d)
            )
            assert found[:, own] == pytest.approx(by[:, own] / 1e-4, rel=1e-6, abs=1e-6)
        return
    if column < 14:
        size, moved = 1e-4 * max(1.0, abs(nodes.x[0, column])), "x"
        step = size * np.eye(14)[column]
    else:
        # neighbours stay: only every second node moves, the first or the last of each interval
        size, moved = 1e-2, "u"
        step = size * np.eye(4)[(column - 14) % 4]
    for parity in (0, 1) if moved == "u" else (None,):
        mask = np.ones((31, 1)) if parity is None else (np.arange(31)[:, None] % 2 == parity)
        own = slice(None) if parity is None else (np.arange(30) + (column >= 18)) % 2 == parity

        def nudge(sign, mask=mask):
            return replace(nodes, **{moved: getattr(nodes, moved) + sign * mask * step})

        by = difference(landing, nodes, nudge) / size
        assert found[:, own] == pytest.approx(by[:, own], rel=1e-5, abs=1e-7)


@pytest.mark.parametrize(
    "name",
    [
        "near",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("low", "aside", "far", "above")),
    ],
)
def test_controls_flown_end_at_rest_and_keep_the_limits(name):
    landing, found = problem(STARTS[name]), landed(name)
    assert found.landed
    t, x, u = propagate(landing, found.nodes, 20)
    flown = figures_of(landing, t, x)
    assert flown.miss_m < 0.5
    assert flown.speed_m_s < 0.1
    assert flown.end_tilt_deg < 0.5
    assert np.linalg.norm(x[:, 7:11], axis=1) == pytest.approx(1.0, abs=1e-9)
    assert np.linalg.norm(found.nodes.x[:, 7:11], axis=1) == pytest.approx(1.0, abs=1e-5)
    # limits hold at four points of each interval, and between them to 1 and 4 % of them and 0.1 m
    assert flown.tilt_deg < 1.01 * degrees(landing.tilt)
    assert flown.rate_deg_s < 1.04 * degrees(landing.rate)
    assert flown.slope_m > -0.1
    throttled = u[t > found.nodes.durations[0] + 1e-9]
    assert np.all((throttled[:, 0] > 1500.0 - 1e-3) & (throttled[:, 0] < 5000.0 + 1e-3))
    assert np.all(np.abs(u[:, 1:]) < landing.torque + 1e-3)
    assert t[-1] == pytest.approx(found.nodes.durations.sum())


def test_limits_exceeded_are_told_and_only_a_little_is_tolerated():
    def exceeded(tilt_deg, rate_deg_s):
        flown = LandingFigures(60.0, 36.0, tilt_deg, rate_deg_s, 0.0, 0.01, 1e-3, 1e-3)
        return [
            (one.what, pytest.approx(one.by), one.tolerated)
            for one in excesses(problem(STARTS["near"]), flown)
        ]

    assert exceeded(24.0, 15.004) == []
    assert exceeded(25.1, 15.7) == [("tilt", 0.1, True), ("body rate", 0.7, True)]
    assert exceeded(26.3, 15.8) == [("tilt", 1.3, False), ("body rate", 0.8, False)]


@pytest.mark.long
@pytest.mark.parametrize("name", ["near", "low"])
def test_quick_attitude_comes_near_the_point_mass_and_does_not_beat_it(name):
    found = quickly_landed(name)
    assert found.landed
    least = point_mass(quick(name), found.nodes.durations.sum(), found.nodes.durations[0])
    assert least < found.fuel < 1.02 * least


@pytest.mark.long
def test_what_attitude_costs_is_paid_in_propellant():
    assert landed("near").fuel > quickly_landed("near").fuel + 0.2


def test_without_full_level_the_whole_flight_is_in_the_band():
    landing = problem(
        ((0.0, 0.0, 1000.0), (0.0, 0.0, -40.0), (1.0, 0.0, 0.0, 0.0), (0.0,) * 3), full_time=0.0
    )
    found = land(landing, 14)
    assert found.landed
    assert len(found.nodes.durations) == 1
    assert np.all(found.nodes.u[:, 0] < 5000.0 + 1e-6)
    assert found.fuel == pytest.approx(point_mass(landing, found.nodes.durations[0], 0.0), rel=1e-3)


def test_a_start_that_cannot_be_landed_is_told(monkeypatch):
    monkeypatch.setattr(successive, "PROGRAMS", 25)
    found = land(problem(((1000.0, 0.0, 300.0), *STARTS["near"][1:])), intervals=15)
    assert not found.landed
    assert found.defect > 1e-3


def test_parts_share_the_nodes():
    nodes = Nodes(np.zeros((11, 14)), np.zeros((11, 4)), np.array([2.0, 12.0]), 4)
    assert nodes.times == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0])
