"""Largest loads, tilt on the ground and rest, each from its definition."""

from math import cos, radians, sin
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from edl6dof.vehicle.landing_gear import ground_speed, note_motion
from edl6dof.vehicle.motion.balance import update_peaks
from edl6dof.vehicle.motion.body import tilt
from edl6dof.vehicle.parachutes.parachute import INFLATING, PACKED, RELEASED
from edl6dof.vehicle.plant import POSITION, RATE, STATES, VELOCITY

SPIN = 7.0882e-5
PLACE = np.array([1.2e6, -2.9e6, 1.1e6])


def moving(over_ground, rate=(0.0, 0.0, 0.0)):
    """State of a vehicle with this velocity relative to the turning planet."""
    y = np.zeros(STATES)
    y[POSITION : POSITION + 3] = PLACE
    y[VELOCITY : VELOCITY + 3] = np.cross((0.0, 0.0, SPIN), PLACE) + over_ground
    y[RATE : RATE + 3] = rate
    return y


def test_speed_over_the_ground_is_relative_to_the_turning_planet():
    assert ground_speed(SPIN, moving((0.0, 0.0, 0.0))) == pytest.approx(0.0, abs=1e-12)
    assert ground_speed(SPIN, moving((3.0, -4.0, 12.0))) == pytest.approx(13.0)


@pytest.mark.parametrize(
    "speed, rate_deg_s, moved", [(0.049, 0.99, False), (0.051, 0.0, True), (0.0, 1.01, True)]
)
def test_vehicle_rests_below_five_centimetres_and_one_degree_a_second(speed, rate_deg_s, moved):
    case = SimpleNamespace(planet=SimpleNamespace(rotation_rate=SPIN))
    y = moving((0.6 * speed, 0.0, 0.8 * speed), (0.0, radians(rate_deg_s), 0.0))
    plant = SimpleNamespace(y=y, t=20.0, moved_time=10.0)
    note_motion.py_func(case, plant)
    assert plant.moved_time == (20.0 if moved else 10.0)


@pytest.mark.parametrize("angle_deg", [0.0, 17.0, 95.0, 180.0])
def test_tilt_is_the_angle_between_the_axis_and_the_vertical_of_the_place(angle_deg):
    latitude, longitude, t = radians(25.0), radians(110.0), 3600.0
    east = longitude + SPIN * t  # in I
    up = np.array([cos(latitude) * cos(east), cos(latitude) * sin(east), sin(latitude)])
    across = np.cross(up, (0.3, -0.5, 0.8))
    axis = -Rotation.from_rotvec(radians(angle_deg) * across / np.linalg.norm(across)).apply(up)
    attitude, _ = Rotation.align_vectors([axis], [(1.0, 0.0, 0.0)])
    out = SimpleNamespace(sin_lat=sin(latitude), cos_lat=cos(latitude))
    out.sin_lon, out.cos_lon = sin(longitude), cos(longitude)
    case = SimpleNamespace(planet=SimpleNamespace(rotation_rate=SPIN))
    q = (1.0 + 1e-12) * attitude.as_quat(scalar_first=True)  # a cosine beyond one by rounding
    found = tilt.py_func(case, t, tuple(q), out)
    assert found == pytest.approx(radians(angle_deg), abs=1e-7)


def test_peaks_are_the_largest_of_a_flight_and_the_ground_is_no_load_of_it():
    names = (
        *("entry_load", "entry_load_time", "parachute_load", "dynamic_pressure", "dynamic_pressure_time"),
        *("heat_flux", "heat_flux_time", "radiative_heat_flux", "riser_tension"),
    )
    peaks = SimpleNamespace(**dict.fromkeys(names, 0.0))
    for t, canopy, pads, force, pressure, flux, tension in (
        (1.0, PACKED, 0, (-3.0, 0.0, 4.0), 100.0, 9e4, 0.0),
        (2.0, PACKED, 0, (-6.0, 0.0, 8.0), 300.0, 8e4, 0.0),
        (3.0, PACKED, 0, (-5.0, 0.0, 5.0), 200.0, 7e4, 0.0),
        (4.0, INFLATING, 0, (-60.0, 0.0, 0.0), 150.0, 1e4, 5e4),
        (5.0, INFLATING, 0, (-30.0, 0.0, 0.0), 140.0, 1e3, 4e4),
        (6.0, RELEASED, 0, (-70.0, 0.0, 0.0), 10.0, 0.0, 0.0),
        (7.0, RELEASED, 1, (-99.0, 0.0, 0.0), 0.0, 0.0, 0.0),
    ):
        outputs = SimpleNamespace(pads=pads, specific_force_B=np.array(force), dynamic_pressure=pressure)
        outputs.heat_flux, outputs.radiative_heat_flux, outputs.riser_tension = flux, 1e4 * t, tension
        update_peaks.py_func(SimpleNamespace(canopy=canopy, t=t), outputs, peaks)
    assert [getattr(peaks, name) for name in names] == [10.0, 2.0, 60.0, 300.0, 2.0, 9e4, 1.0, 7e4, 5e4]
