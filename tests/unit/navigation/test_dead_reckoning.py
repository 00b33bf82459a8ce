"""The whole of navigation without aid: what it claims to be off, against flights with drawn errors."""

from math import radians, sqrt

import numpy as np
import pytest
from inertial_units import DT, believed_unit, cone
from pyquaternion import Quaternion
from scipy.stats import chi2

import edl6dof
from edl6dof.fsw.functions import chosen
from edl6dof.fsw.navigation.filters.registry import NAVIGATION_FILTERS
from edl6dof.fsw.navigation.solution import MOTION, SOLUTION
from edl6dof.fsw.navigation.strapdown import integrate
from edl6dof.fsw.navigation.update import NAVIGATION, estimate_state
from edl6dof.fsw.vehicle_state import VEHICLE_STATE
from edl6dof.interface.sensed import SENSED
from edl6dof.kernels import kernel
from edl6dof.scenario.records import build_records

FLIGHTS, CYCLES, STARS_UNTIL = 100, 15_000, 1_500


@pytest.fixture(scope="module")
def onboard():
    record = build_records(edl6dof.load("tianwen1")).onboard.copy()
    record["instruments"] = believed_unit()
    record["navigation"]["filter"] = NAVIGATION_FILTERS.names.index("dead_reckoning")
    record["navigation"]["dead_reckoning"]["gravity"] = 0.0  # the flights have the field of the model
    return record


def new_memory():
    memory = np.zeros(1, NAVIGATION)
    for name in NAVIGATION["health"].names:
        memory["health"][name] = 1
    return memory


@pytest.fixture(scope="module")
def flown(onboard):
    """Increments at the centre of mass, and the true state after each cycle."""
    t = DT * (np.arange(CYCLES) + 0.5)
    deceleration = 90.0 * np.exp(-(((t - 110.0) / 40.0) ** 2)) + 3.0 * (t > 180.0)
    rate = np.column_stack(
        [
            radians(20.0) * np.sin(2.0 * np.pi * t / 60.0) ** 3,
            radians(2.0) * np.sin(4.4 * t),
            radians(2.0) * np.cos(4.4 * t),
        ]
    )
    motions = np.zeros(CYCLES, MOTION)
    motions["dt"], motions["angle"] = DT, rate * DT
    motions["gain"] = DT * np.column_stack([-deceleration, 0.0 * t, -0.15 * deceleration])
    motions["last_angle"][1:], motions["last_gain"][1:] = motions["angle"][:-1], motions["gain"][:-1]
    truth = np.zeros(CYCLES + 1, SOLUTION)
    truth["r_I"][0], truth["v_I"][0] = (3.52e6, 1e5, 2e5), (-1000.0, 4000.0, 2600.0)
    truth["q_I2B"][0] = Quaternion(0.3, -0.5, 0.7, 0.1).normalised.elements
    trace(onboard[0]["planet"], motions, truth)
    return motions, truth


@kernel
def trace(planet, motions, truth):
    """True state after each cycle, with the integration that navigation uses."""
    for k in range(len(motions)):
        truth[k + 1] = truth[k]
        integrate(planet, motions[k], truth[k + 1])


@kernel
def take_part(filters, onboards, states, sensed, memories, angles, gains, stars, first):
    """Hand out counts and star attitudes cycle by cycle."""
    for k in range(len(angles)):
        s = sensed[0]
        s.t = (first + k) * 0.02
        for i in range(6):
            s.inertial.angle[i] += angles[k, i]
            s.inertial.rate[i] = angles[k, i] / 0.02
            s.inertial.gain[i] += gains[k, i]
        s.tracking.fresh = 1 if first + k == 0 else 0
        s.stars.valid[0] = 1 if first + k < len(stars) else 0
        if s.stars.valid[0]:
            for i in range(4):  # a slice would have words about its size compiled with it
                s.stars.q_I2B[0, i] = stars[first + k, i]
        estimate_state(filters, onboards[0], states[0], s, memories[0])


def turned(q, vector):
    """Attitudes ``q`` turned in I by small rotation vectors."""
    small = np.column_stack([np.ones(len(q)), 0.5 * np.asarray(vector)])
    a0, a1, a2, a3 = small.T
    b0, b1, b2, b3 = q.T
    return (
        np.column_stack(
            [
                a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
                a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
                a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
                a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
            ]
        )
        / np.linalg.norm(small, axis=1)[:, None]
    )


def fly(onboard, flown, rng, marks, errors=1.0):
    """Solution at each of ``marks`` of a flight with drawn errors, and the memory at its end."""
    motions, truth = flown
    known, axes = onboard["instruments"][0], cone()
    centre = onboard["vehicle"]["configuration"]["centre"][0, 0]
    known["unit_position"] = centre  # the increments are those of the centre of mass

    def read(vectors, noise, bias, relative):
        true = vectors @ axes.T
        skew = errors * relative * vectors @ rng.normal(size=(3, 6))  # of axes and scale factors
        return (
            true
            + skew
            + errors * (bias * DT * rng.normal(size=6) + noise * sqrt(DT) * rng.normal(size=true.shape))
        )

    rest = np.zeros((1, 6))  # the first reading is that of the first cycle
    angles = np.vstack(
        [rest, read(motions["angle"], known["gyro_noise"], known["gyro_bias"], known["gyro_scale"])]
    )
    gains = np.vstack(
        [
            rest,
            read(
                motions["gain"],
                known["accelerometer_noise"],
                known["accelerometer_bias"],
                known["accelerometer_scale"],
            ),
        ]
    )
    stars = turned(
        truth["q_I2B"][:STARS_UNTIL], errors * known["star_sigma"] * rng.normal(size=(STARS_UNTIL, 3))
    )
    sensed, memory = np.zeros(1, SENSED), new_memory()
    sensed["tracking"]["r_I"] = truth["r_I"][0] + errors * np.sqrt(
        np.diag(known["tracking_position"])
    ) * rng.normal(size=3)
    sensed["tracking"]["v_I"] = truth["v_I"][0] + errors * np.sqrt(
        np.diag(known["tracking_velocity"])
    ) * rng.normal(size=3)
    state, found, first = np.zeros(1, VEHICLE_STATE), [], 0
    filters = tuple(chosen(name, onboard[0]) for name in ("start_filter", "correct_solution"))
    for mark in marks:
        part = slice(first, mark + 1)
        take_part(filters, onboard, state, sensed, memory, angles[part], gains[part], stars, first)
        found.append(memory["solution"][0].copy())
        first = mark + 1
    return found, memory


def error_of(solution, true):
    """Position, velocity and attitude errors in I, 9 numbers."""
    q = Quaternion(solution["q_I2B"]) * Quaternion(true["q_I2B"]).inverse
    q = q if q.w > 0.0 else -q
    return np.concatenate([solution["r_I"] - true["r_I"], solution["v_I"] - true["v_I"], 2.0 * q.vector])


def test_without_errors_navigation_is_the_truth(onboard, flown):
    (end,), memory = fly(onboard, flown, np.random.default_rng(0), [CYCLES], errors=0.0)
    off = error_of(end, flown[1][CYCLES])
    assert np.linalg.norm(off[:3]) < 1e-3 and np.linalg.norm(off[3:6]) < 1e-5
    assert np.linalg.norm(off[6:]) < 1e-8
    estimate = memory["estimate"][0]
    assert np.allclose(estimate["r_I"], end["r_I"]) and estimate["t"] == end["t"]
    assert np.allclose(estimate["specific_force_B"], flown[0]["gain"][-1] / DT, atol=1e-9)


def test_covariance_equals_flights_with_drawn_errors(onboard, flown):
    """NEES of position, velocity and attitude inside 95 % bounds over 100 flights, in each part of the
    flight; no healthy instrument is excluded.
    """
    rng, marks = np.random.default_rng(7), [STARS_UNTIL + 100, 5_500, 9_000, CYCLES]
    errors, claims, excluded = [], [], 0
    for _ in range(FLIGHTS):
        found, memory = fly(onboard, flown, rng, marks)
        errors.append([error_of(s, flown[1][mark]) for s, mark in zip(found, marks, strict=True)])
        excluded += (
            12 - memory["health"]["gyro"][0, :6].sum() - memory["health"]["accelerometer"][0, :6].sum()
        )
    errors = np.array(errors)
    P = memory["filter"]["dead_reckoning"]["covariance"][0]
    assert excluded == 0
    for name, part in (("position", slice(0, 3)), ("velocity", slice(3, 6)), ("attitude", slice(6, 9))):
        e = errors[:, -1, part]
        nees = np.einsum("ij,jk,ik->i", e, np.linalg.inv(P[part, part]), e).mean()
        low, high = chi2.ppf((0.001, 0.999), 3 * FLIGHTS) / FLIGHTS
        assert low < nees < high, name
    # sigmas along the way
    claims = found
    for k, claim in enumerate(claims):
        for name, part in (
            ("sigma_r", slice(0, 3)),
            ("sigma_v", slice(3, 6)),
            ("sigma_attitude", slice(6, 9)),
        ):
            flown_rms = np.sqrt((errors[:, k, part] ** 2).sum(axis=1).mean())
            assert np.linalg.norm(claim[name]) == pytest.approx(flown_rms, rel=0.15), (name, marks[k])
