"""Verifies: the estimate of the wind from the force across the body axis."""

import numpy as np
import pytest

import edl6dof
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.guidance.entry.airframe import side_force
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.navigation.wind_estimate import WIND_ESTIMATE, WindEstimateParams, estimate_wind
from edl6dof.spatial.quaternion import from_axes

DT, MACH = 0.02, 1.9


def readings(onboard, wind, descent_deg, flow, wing_open):
    """``NAV`` of a flight to the north in the ``wind`` (north, east), and the ``flow`` along y and z of B,
    over that along x; the force is that of the believed vehicle.
    """
    nav = np.zeros(1, NAV)[0]
    nav["north_I"], nav["east_I"], nav["up_I"] = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)
    angle = np.radians(descent_deg)
    ground = 420.0 * np.array([np.cos(angle), 0.0, np.sin(angle)])
    in_air = ground - (*wind, 0.0)
    ahead = in_air / np.linalg.norm(in_air)
    right = np.cross((0.0, 0.0, 1.0), ahead) / np.hypot(*ahead[:2])
    below = np.cross(ahead, right)
    # of a body axis x the flow has the components (1, v, w): turn the axes about the flow accordingly
    in_B = np.array([1.0, *flow]) / np.linalg.norm([1.0, *flow])
    y = np.array([0.0, 1.0, 0.0]) - in_B[1] * in_B
    y /= np.linalg.norm(y)
    z = np.cross(in_B, y)
    to_I = np.column_stack([ahead, right, below]) @ np.column_stack([in_B, y, z]).T
    nav["q_I2B"] = from_axes(*(tuple(to_I[:, i]) for i in range(3)))
    nav["v_rel_I"], nav["speed"], nav["mach"], nav["wing_open"] = ground, 420.0, MACH, wing_open
    slope, offset = side_force(onboard[0]["vehicle"], MACH, wing_open)
    nav["specific_force_B"] = -5.0, -5.0 * slope * flow[0], -5.0 * (slope * flow[1] + offset)
    return nav


def estimated(onboard, nav, seconds, **values):
    memory, params = np.zeros(1, WIND_ESTIMATE)[0], np.zeros(1, dtype_of(WindEstimateParams))[0]
    fill(params, WindEstimateParams(enabled=True, **values))
    for _ in range(round(seconds / DT)):
        nav["t"] += DT
        estimate_wind(params, onboard[0]["vehicle"], (2.0, -3.0), nav, memory)
    return memory


@pytest.mark.parametrize("wind", [(40.0, 0.0), (-25.0, 30.0), (0.0, -60.0)])
@pytest.mark.parametrize("flow, wing_open", [((0.0, 0.0), 1), ((0.03, -0.02), 1), ((0.01, -0.15), 0)])
def test_wind_follows_from_velocity_attitude_and_force(onboard, wind, flow, wing_open):
    memory = estimated(onboard, readings(onboard, wind, 25.0, flow, wing_open), 60.0, slope_error=0.0)
    assert memory["shift_N"] + (2.0, -3.0) == pytest.approx(wind, abs=1.0)


def test_component_along_a_flat_path_stays_as_expected(onboard):
    """Level flight shows the wind across alone, and says so."""
    memory = estimated(onboard, readings(onboard, (2.0, 20.0), 0.0, (0.0, 0.0), 1), 30.0)
    assert memory["shift_N"] + (2.0, -3.0) == pytest.approx((2.0, 20.0), abs=1.5)
    sigma = np.sqrt(np.diag(memory["variance"]))
    assert sigma[0] > 25.0 and sigma[1] < 2.0


def test_believed_slope_is_that_of_the_flown_force(onboard):
    """Across a flight of the plant: force across over force along, by the tangent of the angle of attack."""
    flight = edl6dof.fly("tianwen1", ["sensors.set=perfect", "simulation.log_every=50"])
    table = flight.telemetry
    chosen = (table["truth.trim_wing"] == 0.0) & (table["truth.mach"] > 3.0)
    chosen &= (table["truth.dynamic_pressure_pa"] > 500.0) & (table["truth.mach"] < 15.0)
    ratio = (table["truth.aero_force_z_n"] / table["truth.aero_force_x_n"])[chosen]
    shown = ratio / np.tan(np.radians(table["truth.alpha_deg"][chosen]))
    believed = [side_force(onboard[0]["vehicle"], mach, 0)[0] for mach in table["truth.mach"][chosen]]
    assert len(shown) > 50 and np.median(shown / believed) == pytest.approx(1.0, abs=0.03)
