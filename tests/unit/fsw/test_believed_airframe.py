"""The believed airframe against its definition and against the flight."""

from math import log

import numpy as np
import pytest

from edl6dof.fsw.guidance.entry.airframe import (
    FIRST_MACH,
    LAST_MACH,
    NODES,
    area_rate,
    believed_aero,
    mach_nodes,
)
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.records import build_records

#: Speed (m/s) above any at which something opens.
FAST = 1e9


def test_airframe_table_is_exact_at_its_nodes_and_clamped_outside(onboard):
    vehicle = onboard[0]["vehicle"]
    table = vehicle["airframe"]
    table["wing_mach"] = 0.0
    for i in (0, 7, 40, NODES - 2):
        area, lift = believed_aero(vehicle, mach_nodes()[i], FAST)
        assert area == pytest.approx(vehicle["drag_area"] * table["drag"][i], rel=1e-9)
        assert lift == pytest.approx(vehicle["lift_to_drag"] * table["lift"][i], rel=1e-9)
    assert believed_aero(vehicle, 0.0, FAST) == believed_aero(vehicle, FIRST_MACH, FAST)
    assert believed_aero(vehicle, 1e3, FAST) == pytest.approx(
        believed_aero(vehicle, LAST_MACH, FAST), rel=1e-3
    )


@pytest.mark.parametrize("mach", [22.3, 11.7, 5.2])
def test_area_rate_is_that_of_the_believed_drag_area_while_the_speed_falls(onboard, mach):
    vehicle, speed, slowing = onboard[0]["vehicle"], 200.0 * mach, -60.0
    areas = [believed_aero(vehicle, mach * (1.0 + side * 1e-5), FAST)[0] for side in (-1.0, 1.0)]
    expected = log(areas[1] / areas[0]) / 2e-5 * slowing / speed
    assert area_rate(vehicle, mach, speed, slowing) == pytest.approx(expected, rel=0.02, abs=1e-7)


def test_no_lift_is_believed_once_the_wing_is_open(onboard):
    vehicle = onboard[0]["vehicle"]
    assert vehicle["airframe"]["wing_mach"] == 2.8
    assert believed_aero(vehicle, 2.79, FAST)[1] == 0.0
    assert believed_aero(vehicle, 2.81, FAST)[1] > 0.14


def test_no_lift_is_believed_below_the_speed_at_which_the_balance_masses_go():
    vehicle = build_records(load_scenario("msl")).onboard[0]["vehicle"]
    assert (vehicle["airframe"]["wing_speed"], vehicle["airframe"]["wing_mach"]) == (444.0, 0.0)
    assert believed_aero(vehicle, 1.9, 443.9)[1] == 0.0
    assert believed_aero(vehicle, 1.9, 444.1)[1] > 0.2


def test_believed_airframe_is_what_the_rigid_body_trims_to(nominal, shared_onboard):
    """Drag and lift of the 6-DOF flight over its own density and airspeed, in continuum flow, against the
    ground's trim solution.
    """
    t = nominal.telemetry
    force = np.stack([t[f"truth.aero_force_{axis}_n"] for axis in "xyz"])
    alpha, beta = np.radians(t["truth.alpha_deg"]), np.radians(t["truth.beta_deg"])
    along = np.stack([np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)])
    drag = -np.sum(force * along, axis=0)
    lift = np.linalg.norm(force + drag * along, axis=0)
    vehicle = shared_onboard[0]["vehicle"]
    for low, high in ((3.2, 6.0), (6.0, 12.0), (12.0, 20.0)):
        part = (t["truth.mach"] > low) & (t["truth.mach"] < high) & (t["truth.dynamic_pressure_pa"] > 300.0)
        believed = np.array([believed_aero(vehicle, mach, FAST) for mach in t["truth.mach"][part]])
        assert np.mean(drag[part] / t["truth.dynamic_pressure_pa"][part] / believed[:, 0]) == pytest.approx(
            1.0, abs=0.01
        )
        assert np.mean(lift[part] / drag[part] / believed[:, 1]) == pytest.approx(1.0, abs=0.04)
