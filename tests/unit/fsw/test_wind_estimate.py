"""Verifies: the estimate of the wind from the force across the body axis."""

import numpy as np
import pytest

import edl6dof
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.guidance.entry.airframe import side_force
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.navigation.flow_at_ports import flow_at_ports
from edl6dof.fsw.navigation.instruments import INSTRUMENTS
from edl6dof.fsw.navigation.solution import SOLUTION
from edl6dof.fsw.navigation.wind_estimate import WIND_ESTIMATE, WindEstimateParams, estimate_wind
from edl6dof.interface.capacities import MAX_PORTS
from edl6dof.sensors.pressure_ports import cross_of_ports
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


def estimated(onboard, nav, seconds, pressure=(), sigma=(0.0, 0.0), **values):
    memory, params = np.zeros(1, WIND_ESTIMATE)[0], np.zeros(1, dtype_of(WindEstimateParams))[0]
    readings = np.zeros(MAX_PORTS)
    readings[: len(pressure)] = pressure
    fill(params, WindEstimateParams(enabled=True, **values))
    solution = np.zeros(1, SOLUTION)[0]
    solution["sigma_attitude"], solution["sigma_v"] = sigma
    for _ in range(round(seconds / DT)):
        nav["t"] += DT
        estimate_wind(params, onboard[0], (2.0, -3.0), solution, readings, nav, memory)
    return memory


@pytest.mark.parametrize("wind", [(40.0, 0.0), (-25.0, 30.0), (0.0, -60.0)])
@pytest.mark.parametrize("flow, wing_open", [((0.0, 0.0), 1), ((0.03, -0.02), 1), ((0.01, -0.15), 0)])
def test_wind_follows_from_velocity_attitude_and_force(onboard, wind, flow, wing_open):
    memory = estimated(onboard, readings(onboard, wind, 25.0, flow, wing_open), 60.0, slope_error=0.0)
    assert memory["shift_N"] + (2.0, -3.0) == pytest.approx(wind, abs=1.0)


@pytest.mark.parametrize("angle", [0.0, -0.27])
def test_component_along_a_flat_path_stays_as_expected(onboard, angle):
    """Level flight shows the wind across alone, and says so, also where the vehicle trims at 15 deg."""
    nav = readings(onboard, (2.0, 20.0), 0.0, (0.0, angle), 1)
    memory = estimated(onboard, nav, 30.0, slope_error=0.0)
    assert memory["shift_N"] + (2.0, -3.0) == pytest.approx((2.0, 20.0), abs=1.5)
    sigma = np.sqrt(np.diag(memory["variance"]))
    assert sigma[0] > 25.0 and sigma[1] < 2.0


@pytest.mark.parametrize("sigma", [(0.0, 2.0), (2.0 / 420.0, 0.0)])
def test_lasting_error_of_navigation_is_the_least_error_of_the_wind(onboard, sigma):
    """After the time in which it lasts, an error of 2 m/s across the flight leaves that error of the wind."""
    nav = readings(onboard, (2.0, -3.0), 0.0, (0.0, 0.0), 1)
    certain = {"slope_error": 0.0, "swing_deg": 0.01, "change_m_s": 0.0, "lasting_s": 30.0}
    memory = estimated(onboard, nav, 30.0, sigma=sigma, **certain)
    assert np.sqrt(memory["variance"][1, 1]) == pytest.approx(2.0, rel=0.02)


NORMALS = np.array([port.axis for port in cross_of_ports()])
STATIC, STAGNATION = 30.0, 900.0  # Pa


def pressures(flow, static=STATIC):
    """Modified Newtonian pressures at the ports for a flow with the components (1, v, w), Pa."""
    towards = np.array([1.0, *flow]) / np.linalg.norm([1.0, *flow])
    return static + STAGNATION * (NORMALS @ towards) ** 2


def with_ports(record):
    record["n_ports"], record["port_bias"] = len(NORMALS), 1.0
    record["port_axis"][: len(NORMALS)] = NORMALS
    return record


@pytest.mark.parametrize("flow", [(0.0, 0.0), (0.05, -0.12), (-0.02, 0.3)])
@pytest.mark.parametrize("static", [STATIC, 0.7 * STATIC])
def test_ports_show_the_flow(flow, static):
    """From a prediction 3 deg off; 30 % of error of the static pressure adds 0.2 deg at 17 deg."""
    instruments = with_ports(np.zeros(1, INSTRUMENTS)[0])
    predicted = 1.0, flow[0] + 0.05, flow[1] - 0.05
    shown, variance, most = flow_at_ports(instruments, pressures(flow), static, predicted)
    assert shown == pytest.approx(flow, abs=1e-5 if static == STATIC else 4e-3)
    assert most == pytest.approx(pressures(flow).max())
    rng = np.random.default_rng(1)
    off = [
        flow_at_ports(instruments, pressures(flow) + rng.standard_normal(7), static, predicted)[0]
        for _ in range(800)
    ]
    assert np.std(off, axis=0) == pytest.approx(np.sqrt(variance), rel=0.12)  # 5 sigma of the sample


@pytest.mark.parametrize("mach, share", [(1.7, 0.10), (3.0, 0.03)])
def test_an_error_of_the_static_pressure_changes_the_shown_angle(mach, share):
    """30 % of error; q Cp_max is the stagnation pressure above the static one, Cp_max 1.85."""
    instruments, static = with_ports(np.zeros(1, INSTRUMENTS)[0]), 2.0 * STAGNATION / (1.85 * 1.3 * mach**2)
    shown, _, _ = flow_at_ports(instruments, pressures((0.0, 0.1), static), 1.3 * static, (1.0, 0.0, 0.1))
    assert shown[1] / 0.1 - 1.0 == pytest.approx(share, abs=0.005)


def test_ports_without_pressure_show_nothing():
    instruments = with_ports(np.zeros(1, INSTRUMENTS)[0])
    assert flow_at_ports(instruments, np.zeros(7), STATIC, (1.0, 0.0, 0.0))[2] == 0.0


def test_wind_follows_from_the_ports_whatever_the_force_says(onboard):
    """The force is that of a wrong flow, as with a slope that does not hold."""
    record, flow = onboard.copy(), (0.03, -0.15)
    with_ports(record[0]["instruments"])
    nav = readings(onboard, (40.0, 10.0), 25.0, flow, 0)
    nav["specific_force_B"] = -5.0, 1.0, 1.0
    nav["dynamic_pressure"] = 0.5 * 1.3 * MACH * MACH * STATIC
    memory = estimated(record, nav, 60.0, pressures(flow))
    assert memory["shift_N"] + (2.0, -3.0) == pytest.approx((40.0, 10.0), abs=1.5)


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
