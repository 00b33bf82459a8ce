"""Bridle of three legs against independent statics: the confluence from scipy's constrained minimum over
where the legs can reach, the torque from differences of the elastic energy over small turns of the vehicle.
"""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from edl6dof.config.dtype import fill
from edl6dof.config.errors import ConfigError
from edl6dof.scenario.loading import load_scenario
from edl6dof.vehicle.parachutes.parachute import (
    BY_STRETCH,
    PARACHUTE_PARAMS,
    ParachuteParams,
    confluence,
    riser_tension,
)

MEETING = np.array([-3.9, 0.0, -0.034])
ATTACHMENTS = np.array([[-2.5, 0.6, 0.0], [-2.5, -0.3, 0.52], [-2.5, -0.3, -0.52]])
LINE = 31.15


def chute(attachments=ATTACHMENTS):
    record = np.zeros(1, PARACHUTE_PARAMS).view(np.recarray)[0]
    fill(
        record,
        ParachuteParams(
            name="main",
            diameter_m=16.0,
            drag_coefficient=0.62,
            mortar_speed_m_s=30.0,
            line_length_m=LINE,
            stiffness_n_m=40000.0,
            confluence_m=tuple(MEETING),
            bridle_attachments_m=[tuple(map(float, point)) for point in attachments],
        ),
    )
    return record


def canopy_at(angle_deg, roll_deg, distance=LINE + 0.2):
    """Canopy behind the vehicle, at an angle to its axis."""
    angle, roll = np.radians([angle_deg, roll_deg])
    way = [-np.cos(angle), np.sin(angle) * np.cos(roll), np.sin(angle) * np.sin(roll)]
    return MEETING + distance * np.array(way)


def by_scipy(canopy):
    """The reachable point nearest to the canopy, from a general minimiser."""
    lengths = np.linalg.norm(MEETING - ATTACHMENTS, axis=1)
    reach = [
        {"type": "ineq", "fun": lambda p, a=a, length=length: length**2 - np.sum((p - a) ** 2)}
        for a, length in zip(ATTACHMENTS, lengths, strict=True)
    ]
    found = minimize(
        lambda p: 0.5 * np.sum((p - canopy) ** 2),
        ATTACHMENTS.mean(axis=0) + [-0.5, 0.0, 0.0],
        constraints=reach,
        method="SLSQP",
        options={"ftol": 1e-15, "maxiter": 500},
    )
    return found.x


def lengths_of(point):
    return np.linalg.norm(point - ATTACHMENTS, axis=1)


FEW = [(angle, roll) for angle in (0, 25, 85) for roll in (0, 145, 240)]
MORE = [(angle, roll) for angle in (0, 8, 15, 25, 40, 60, 85) for roll in (0, 37, 90, 145, 180, 240, 300)]
CASES = [*FEW, *(pytest.param(*case, marks=pytest.mark.long) for case in MORE if case not in FEW)]


@pytest.mark.parametrize("angle_deg, roll_deg", CASES)
def test_the_confluence_is_the_nearest_point_that_the_legs_reach(angle_deg, roll_deg):
    canopy = canopy_at(angle_deg, roll_deg)
    found = np.array(confluence(chute(), tuple(canopy)))
    assert np.all(lengths_of(found) <= lengths_of(MEETING) * (1.0 + 1e-9))
    assert found == pytest.approx(by_scipy(canopy), abs=2e-6)


def test_legs_go_slack_one_after_the_other_as_the_pull_leaves_their_cone():
    taut = [
        int(
            np.sum(
                lengths_of(confluence(chute(), tuple(canopy_at(angle, 200.0)))) > lengths_of(MEETING) - 1e-9
            )
        )
        for angle in (0.0, 10.0, 20.0, 40.0, 80.0)
    ]
    assert taut[0] == 3 and taut[-1] == 1 and taut == sorted(taut, reverse=True) and 2 in taut


def energy(turn, canopy):
    """Energy of the riser (J) when the vehicle has turned about B's origin and the canopy has stayed."""
    in_body = Rotation.from_rotvec(turn).inv().apply(canopy)
    stretch = np.linalg.norm(in_body - confluence(chute(), tuple(in_body))) - LINE
    return 0.5 * 40000.0 * max(stretch, 0.0) ** 2


@pytest.mark.parametrize("angle_deg, roll_deg", [(3, 50), (12, 10), (25, 200), (40, 120), (70, 300)])
def test_the_torque_is_the_slope_of_the_elastic_energy(angle_deg, roll_deg):
    """Moment about B's origin, as arm x pull, of the tension that flies."""
    canopy, step = canopy_at(angle_deg, roll_deg), 1e-6
    where = np.array(confluence(chute(), tuple(canopy)))
    line = canopy - where
    distance = np.linalg.norm(line)
    torque = np.cross(where, riser_tension(chute(), 38.0, distance, 0.0, BY_STRETCH)[0] * line / distance)
    slopes = [
        -(energy(step * axis, canopy) - energy(-step * axis, canopy)) / (2.0 * step) for axis in np.eye(3)
    ]
    assert torque == pytest.approx(slopes, rel=1e-5, abs=0.05)


def test_the_arm_beyond_the_cone_is_smaller_than_that_of_a_fixed_confluence():
    canopy = canopy_at(50.0, 200.0)
    arms = []
    for record in (chute(), chute(attachments=[])):
        where = np.array(confluence(record, tuple(canopy)))
        arms.append(np.linalg.norm(np.cross(where, (canopy - where) / np.linalg.norm(canopy - where))))
    assert arms[0] < 0.9 * arms[1]


def test_the_confluence_moves_without_jumps_wherever_the_canopy_is():
    angles = np.linspace(0.0, 179.0, 5001)
    record = chute()
    for roll in (10.0, 200.0):
        path = np.array([confluence(record, tuple(canopy_at(angle, roll))) for angle in angles])
        step = np.linalg.norm(np.diff(path, axis=0), axis=1)
        assert step.max() < 0.02


def test_a_canopy_within_reach_pulls_nothing():
    inside = (-2.6, 0.05, 0.0)
    assert confluence(chute(), inside) == inside


@pytest.mark.parametrize(
    "points, words",
    [
        ("[[-2.5, 0, 0.5], [-2.5, 0, -0.5]]", "three points"),
        ("[[-2.5, 0, 0.5], [-2.5, 0, 0], [-2.5, 0, -0.5]]", "plane"),
    ],
)
def test_legs_that_cannot_hold_a_point_are_refused(points, words):
    with pytest.raises(ConfigError, match=words):
        load_scenario("tianwen1", [f"vehicle.parachutes.main.bridle_attachments_m={points}"])
