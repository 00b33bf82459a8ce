"""The point mass against spherical equations of motion integrated by scipy, and its bank angle against the
clock.
"""

from math import atan2, cos, degrees, radians, sin, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.vehicle.aerodynamics.wrench import LiftDragParams, lift_drag_aero
from edl6dof.verify.entries import integrated

RADIUS = 3394500.0
LIFT_TO_DRAG, BALLISTIC = 0.24, 3300.0 / (15.9 * 1.45)
TIME_S = 90.0
SPIN = 7.1e-5
#: Nobody guides: the bank angle stays the initial one.
FREE = ("mission={goal: time, phases: []}", f"simulation.time_limit_s={TIME_S}")


@pytest.mark.exact_start  # the equations start from it too
@pytest.mark.parametrize(
    "bank_deg, amplitude, spin, latitude_deg, azimuth_deg",
    [
        pytest.param(0.0, 0.0, 0.0, 0.0, 90.0, marks=pytest.mark.long),
        pytest.param(75.0, 0.0, 0.0, 0.0, 90.0, marks=pytest.mark.long),
        pytest.param(-50.0, 0.0, 0.0, 37.0, 200.0, marks=pytest.mark.long),
        (75.0, 0.01, 0.0, 0.0, 90.0),
        (30.0, 0.0, 7.1e-5, -20.0, 60.0),
    ],
)
def test_path_is_that_of_the_spherical_equations(bank_deg, amplitude, spin, latitude_deg, azimuth_deg):
    loaded = edl6dof.load(
        "zheng2015",
        [
            *FREE,
            f"initial.bank_deg={bank_deg}",
            f"initial.latitude_deg={latitude_deg}",
            f"initial.azimuth_deg={azimuth_deg}",
            f"planet.rotation_rate_rad_s={spin}",
            f"point_mass.disturbance.amplitude_rad_s={amplitude}",
        ],
    )
    flight = edl6dof.fly(loaded)
    r, lon, lat, v, gamma, psi = integrated(loaded.scenario, np.array([0.0, TIME_S]))[:, -1]
    row = {
        name: flight.telemetry[f"truth.{name}"][-1]
        for name in ("altitude_m", "longitude_deg", "latitude_deg", "speed_m_s")
    }
    assert row["altitude_m"] == pytest.approx(r - RADIUS, abs=1e-3)
    assert row["speed_m_s"] == pytest.approx(v, abs=1e-5)
    assert radians(row["longitude_deg"] - degrees(lon)) * RADIUS == pytest.approx(0.0, abs=1e-3)
    assert radians(row["latitude_deg"] - degrees(lat)) * RADIUS == pytest.approx(0.0, abs=1e-3)
    assert flight.telemetry["truth.flight_path_angle_deg"][-1] == pytest.approx(degrees(gamma), abs=1e-4)
    north, east = (flight.telemetry[f"truth.v_{axis}_m_s"][-1] for axis in ("north", "east"))
    assert atan2(north, east) == pytest.approx(atan2(sin(psi), cos(psi)), abs=1e-6)


@pytest.mark.parametrize("u, v, w", [(100.0, 0.0, 0.0), (98.0, 0.0, -17.0), (80.0, 30.0, -20.0)])
def test_lift_stands_on_the_velocity_in_the_plane_of_symmetry_and_drag_against_it(u, v, w):
    record = np.zeros(1, dtype_of(LiftDragParams))
    fill(record[0], LiftDragParams(reference_area_m2=2.0, drag_coefficient=1.5, lift_to_drag=0.3))
    force, velocity = np.array(lift_drag_aero(record[0], 50.0, (u, v, w))), np.array([u, v, w])
    along = velocity / np.linalg.norm(velocity)
    across = np.cross([0.0, 1.0, 0.0], velocity)
    across /= np.linalg.norm(across)
    assert force == pytest.approx(-150.0 * along + 45.0 * across, abs=1e-12)
    assert across @ along == pytest.approx(0.0, abs=1e-15)
    assert across[2] < 0.0  # up in the body


def test_bank_follows_the_command_at_its_rate_the_short_way():
    """From 80 deg held before guidance to the other side, at 7 deg/s through zero."""
    changes = ["point_mass={bank_response: rate_limited, bank_rate_deg_s: 7.0}", "initial.bank_deg=20"]
    telemetry = edl6dof.fly(
        "zheng2015", [*changes, "simulation.time_limit_s=60", "mission.goal=time"]
    ).telemetry
    t, bank, command = (telemetry[name] for name in ("t_s", "truth.bank_deg", "guide.bank_deg"))
    assert command[1] == pytest.approx(80.0)
    first = t < 60.0 / 7.0
    assert bank[first] == pytest.approx(20.0 + 7.0 * t[first], abs=0.02)
    assert bank[(t > 9.0) & (t < 44.0)] == pytest.approx(80.0, abs=1e-6)
    assert np.max(np.abs(np.diff(bank))) <= 7.0 * 0.02 + 1e-6


def test_ideal_bank_is_there_at_the_next_reading():
    telemetry = edl6dof.fly("zheng2015", ["simulation.time_limit_s=80", "mission.goal=time"]).telemetry
    assert telemetry["truth.bank_deg"][1:] == pytest.approx(telemetry["guide.bank_deg"][:-1], abs=1e-6)


def bank_by_geometry(rows, spin):
    """Angle (deg) of y of B from the horizontal, seen along the velocity relative to a planet that spins at
    ``spin`` (rad/s).
    """
    q = np.stack([rows[f"truth.q_I2B_{part}"] for part in "wxyz"], axis=1)
    side = Rotation.from_quat(q, scalar_first=True).apply([0.0, 1.0, 0.0])
    lat, lon = (
        np.radians(rows["truth.latitude_deg"]),
        np.radians(rows["truth.longitude_deg"]) + spin * rows["t_s"],
    )
    side = Rotation.from_euler("ZY", np.stack([lon, -lat], axis=1)).inv().apply(side)  # up, east, north
    v = np.stack([rows[f"truth.v_{axis}_m_s"] for axis in ("down", "east", "north")], axis=1) * [-1, 1, 1]
    right = np.cross(v, [1.0, 0.0, 0.0])
    below = np.cross(v, right) / np.linalg.norm(v, axis=1)[:, None]
    return np.degrees(np.arctan2(np.sum(side * below, axis=1), np.sum(side * right, axis=1)))


def test_bank_is_about_the_planet_relative_velocity_in_a_wind_too():
    """The velocities relative to air and planet differ by up to 2 deg; angle of attack and sideslip are those
    in the air.
    """
    wind = "wind={model: constant, constant: {east_m_s: 80.0, north_m_s: -120.0}}"
    short = ["simulation.time_limit_s=80", "mission.goal=time", f"planet.rotation_rate_rad_s={SPIN}"]
    rows = edl6dof.fly("zheng2015", [wind, *short]).telemetry
    still = edl6dof.fly("zheng2015", short).telemetry
    assert bank_by_geometry(rows, SPIN) == pytest.approx(rows["truth.bank_deg"], abs=1e-6)
    assert rows["truth.bank_deg"][1:] == pytest.approx(rows["guide.bank_deg"][:-1], abs=1e-6)
    assert rows["truth.alpha_deg"][5:] == pytest.approx(still["truth.alpha_deg"][5], abs=1e-9)
    assert rows["truth.beta_deg"] == pytest.approx(0.0, abs=1e-9)


def test_accelerometer_reads_drag_and_lift():
    flight = edl6dof.fly("zheng2015", [*FREE, "initial.bank_deg=75"])
    rows = flight.telemetry
    drag = 0.5 * rows["truth.density_kg_m3"] * rows["truth.speed_m_s"] ** 2 / BALLISTIC
    load = rows["truth.load_g0"] * 9.80665
    assert load == pytest.approx(drag * sqrt(1.0 + LIFT_TO_DRAG**2), rel=1e-9)
