"""A riser that becomes slack and taut in flight: a mass on a spring that only pulls, in closed form, and line
stretch beside the axis against short steps.

Bounce: a mass m comes to the end of the lines at a speed v.  While they pull it moves as m s'' + 2 z w m s' +
w^2 m s = 0; they let go when spring and damper together pull no more, (pi - 2 asin z) / (w sqrt(1 - z^2))
later, and it goes back at v exp(-z (pi - 2 asin z) / sqrt(1 - z^2)).
"""

from math import asin, exp, pi, sqrt

import numpy as np
import pytest
from test_state_events import PACK, Flown

from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.parachutes.parachute import EXTRACTING
from edl6dof.vehicle.plant import ATTITUDE, CANOPY_POSITION, CANOPY_VELOCITY, POSITION, RATE, VELOCITY
from edl6dof.verify.case import UNIFORM

MAIN = "vehicle.parachutes.main"
LENGTH, SPEED, MASS, STIFFNESS = 2.0, 20.0, 38.0, 4000.0


def thrown(*changes, velocity, direction, left):
    """A vehicle at ``velocity`` (m/s) along its own axes, nose forward, with the pack ``left`` m before line
    stretch in a ``direction`` from the confluence (B), at the speed of its mortar.
    """
    flown = Flown(*PACK, "initial.speed_m_s=0", f"{MAIN}.confluence_m=[-3.9, 0, 0]", *changes)
    y, chute = flown.plant["y"][0], flown.case["vehicle"]["parachutes"][0, 0]
    y[ATTITUDE : ATTITUDE + 4], y[RATE : RATE + 3] = (1.0, 0.0, 0.0, 0.0), 0.0
    y[VELOCITY : VELOCITY + 3] = (velocity, 0.0, 0.0)
    evaluate(*flown)
    out = (chute["line_length"] - left) * np.array(direction)
    place = y[POSITION : POSITION + 3] + chute["confluence"] - flown.outputs["centre"][0] + out
    y[CANOPY_POSITION : CANOPY_POSITION + 3] = place
    y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] = (velocity, 0.0, 0.0) + SPEED * np.array(direction)
    flown.plant["canopy"] = EXTRACTING
    evaluate(*flown)
    return flown


@pytest.mark.parametrize("damping, bounces", [(0.0, 6), (0.1, 6), (0.3, 6), (0.7, 3)])
def test_a_mass_bounces_at_the_end_of_its_lines_as_the_closed_form_says(damping, bounces):
    """Speed after so many bounces, and the time at which it passes the confluence after them."""
    omega, root = sqrt(STIFFNESS / MASS), sqrt(1.0 - damping * damping)
    angle = pi - 2.0 * asin(damping)
    kept, pulled = exp(-damping * angle / root), angle / (omega * root)
    speed, now = SPEED, 1.0 / SPEED
    for _ in range(bounces):
        speed *= kept
        # where the lines let go they are still stretched, by 2 z s' / w
        now += pulled + (2.0 * LENGTH + 2.0 * damping * speed / omega) / speed
    now -= LENGTH / speed
    flown = thrown(
        "planet.equatorial_radius_m=1e5",  # positions resolve 1e-11 m
        "vehicle.mass.entry_kg=1e9",
        "simulation.canopy_step_s=0.0025",
        f"{MAIN}.line_length_m={LENGTH}",
        f"{MAIN}.stiffness_n_m={STIFFNESS}",
        f"{MAIN}.damping_ratio={damping}",
        velocity=0.0,
        direction=(-1.0, 0.0, 0.0),
        left=1.0,
    )
    flown.to(0.02 * (now // 0.02), step=0.02)
    assert advance(*flown, now)
    y = flown.plant["y"][0]
    velocity = y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] - y[VELOCITY : VELOCITY + 3]
    assert np.linalg.norm(velocity) == pytest.approx(speed, rel=3e-6)
    place = y[CANOPY_POSITION : CANOPY_POSITION + 3] - y[POSITION : POSITION + 3]
    confluence = flown.case["vehicle"]["parachutes"]["confluence"][0, 0] - flown.outputs["centre"][0]
    assert place == pytest.approx(confluence, abs=3e-5)


def test_a_riser_at_the_edge_between_slack_and_taut_does_not_hang_the_flight():
    """The air pulls no harder than the riser when positions change by their rounding, 1e-7 m."""
    flown = thrown(
        *UNIFORM,
        "planet.equatorial_radius_m=1e9",
        "atmosphere.exponential.density_kg_m3=3e-8",
        velocity=400.0,
        direction=(-1.0, 0.0, 0.0),
        left=0.0,
    )
    y = flown.plant["y"][0]
    y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] = y[VELOCITY : VELOCITY + 3]
    evaluate(*flown)
    flown.to(2.0, step=0.02)
    assert abs(flown.outputs["riser_margin"][0]) < 1e-5


def beside_the_axis(angle_deg, *changes):
    """Line stretch at 400 m/s and 640 Pa, at an angle to the axis."""
    angle = np.radians(angle_deg)
    return thrown(
        *UNIFORM,
        "atmosphere.exponential.density_kg_m3=0.008",
        "vehicle.mass.entry_kg=1250",
        *changes,
        velocity=400.0,
        direction=(-np.cos(angle), 0.9 * np.sin(angle), sqrt(0.19) * np.sin(angle)),
        left=0.5,
    )


def attitude_a_second_later(step, angle_deg, *changes):
    flown = beside_the_axis(angle_deg, *changes)
    flown.case["simulation"]["canopy_step"] = step
    flown.to(1.0, step=0.02)
    return flown.plant["y"][0, ATTITUDE : ATTITUDE + 4]


def turned(a, b):
    """Angle between two attitudes, deg."""
    return np.degrees(2.0 * np.linalg.norm(a - b))


@pytest.mark.parametrize("angle_deg", [10.0, 20.0, 30.0])
def test_the_shipped_step_follows_line_stretch_beside_the_axis(angle_deg):
    shipped = attitude_a_second_later(0.01, angle_deg)
    assert turned(shipped, attitude_a_second_later(2e-4, angle_deg)) < 0.03


def test_lines_that_become_slack_and_taut_leave_the_order_of_the_integrator():
    """Fourth, once nothing else jumps: no oscillating area, a canopy that fills for more than a second."""
    smooth = f"{MAIN}.area_oscillation=0", f"{MAIN}.disk_gap_band.inflation_speed_m_s=10"
    coarse, middle, fine = (attitude_a_second_later(step, 45.0, *smooth) for step in (0.01, 0.005, 0.0025))
    assert 3.5 < np.log2(turned(coarse, middle) / turned(middle, fine)) < 4.5
