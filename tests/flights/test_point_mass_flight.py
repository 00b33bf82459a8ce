"""The same mission as a point mass and as a rigid body, and how a point-mass flight ends."""

from math import degrees

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError

DEPLOYMENT = "mission.goal=deployment"


@pytest.fixture(scope="module")
def both():
    """The entry of Tianwen-1 as a point mass and as a rigid body."""
    rigid = edl6dof.fly("tianwen1", ["sensors.set=perfect", DEPLOYMENT])  # as the sensors of a point mass are
    return edl6dof.fly("tianwen1", ["dynamics=point_mass", DEPLOYMENT]), rigid


def test_point_mass_and_rigid_body_deploy_at_nearly_the_same_place_and_time(both):
    point, rigid = both
    for flight in both:
        assert flight.outcome == "deployed within limits"
        assert flight.success and not flight.landed
    assert point.figures["parachute_s"] == pytest.approx(rigid.figures["parachute_s"], abs=2.5)
    assert point.figures["parachute_mach"] == pytest.approx(rigid.figures["parachute_mach"], abs=0.02)
    assert point.figures["parachute_altitude_m"] == pytest.approx(
        rigid.figures["parachute_altitude_m"], abs=400.0
    )
    assert point.figures["parachute_miss_m"] == pytest.approx(rigid.figures["parachute_miss_m"], abs=1500.0)


def test_both_feel_the_same_entry(both):
    point, rigid = (flight.figures for flight in both)
    assert point["peak_load_g0"] == pytest.approx(rigid["peak_load_g0"], rel=0.02)
    assert point["peak_heat_flux_w_cm2"] == pytest.approx(rigid["peak_heat_flux_w_cm2"], rel=0.02)
    assert abs(point["bank_reversals"] - rigid["bank_reversals"]) <= 1  # the last comes late or not at all


def test_telemetry_has_the_same_columns(both):
    point, rigid = both
    assert set(point.telemetry) == set(rigid.telemetry)
    assert all(
        np.isfinite(point.telemetry[name]).all()
        for name in ("truth.altitude_m", "nav.drag_m_s2", "truth.bank_deg")
    )


def test_miss_is_made_of_downrange_and_crossrange(both):
    for flight in both:
        figures = flight.figures
        assert np.hypot(figures["parachute_downrange_m"], figures["parachute_crossrange_m"]) == pytest.approx(
            figures["parachute_miss_m"], rel=1e-3
        )


def test_downrange_grows_with_the_aim_point_drawn_nearer():
    """Lift-up flight, the same whatever the aim point, which is moved 3 km back along the track: so much more
    of an overshoot.
    """
    entry = "flight_software.guidance.entry"
    lift_up = ("law=constant_bank", "constant_bank.bank_deg=0", "bank_min_deg=0", "heading.speed_m_s=0")
    straight = [f"{entry}.{change}" for change in lift_up]
    before = edl6dof.fly("zheng2015", straight).figures
    moved = 10.6877 - degrees(3000.0 / 3394500.0)
    after = edl6dof.fly("zheng2015", [*straight, f"terrain.site_longitude_deg={moved!r}"]).figures
    assert after["parachute_downrange_m"] - before["parachute_downrange_m"] == pytest.approx(3000.0, abs=0.1)


def test_point_mass_without_parachute_crashes_on_the_ground():
    flight = edl6dof.fly("zheng2015", ["mission.phases.lift.until.value=1.0", "simulation.time_limit_s=900"])
    assert flight.outcome.startswith("crashed at ")
    assert flight.telemetry["truth.height_m"][-1] == pytest.approx(0.0, abs=20.0)


def test_point_mass_cannot_land():
    with pytest.raises(ConfigError, match="mission.goal.*'deployment' or 'time' with dynamics point_mass"):
        edl6dof.load("zheng2015", ["mission.goal=landing"])


def test_truth_alone_is_dispersed(both):
    """The flight computer plans the nominal: a dispersion of the truth does not move its reference."""
    nominal = edl6dof.fly("zheng2015").telemetry
    thin = edl6dof.fly("zheng2015", ["truth={atmosphere.density_factor: 0.9}"]).telemetry
    assert thin["guide.bank_deg"][0] == nominal["guide.bank_deg"][0]
    assert np.max(np.abs(thin["nav.drag_m_s2"][500:1000] / nominal["nav.drag_m_s2"][500:1000] - 0.9)) < 0.01
