"""Opening load: what is published of parachutes on Mars and above the Earth, and what factor and riser make
of it.

Vehicle and canopy fly one behind the other on the shipped kernels, integrated by scipy from line stretch,
both at one speed (what the snatch of the pack adds is left out), through air of one density.

Sources.  [P] second hand: peak decelerations of Phoenix 83.0, MSL 58.3 raw and 41.4 smoothed, M2020 49.0 and
53.7 m/s2 (SPICE accelerations).  [P] ASPIRE: SR01 35,000 lbf at Mach 1.8 (NASA), SR02 55.8 klbf at Mach 1.97
and 670 Pa, SR03 67.4 klbf at Mach 1.85 and 932 Pa (abstract of O'Farrell et al.).  [R] all masses, drag areas
of vehicles, the diameter of Phoenix's canopy, and the states of deployment but those of SR02 and SR03.
"""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import edl6dof
from edl6dof.config.dtype import fill
from edl6dof.vehicle.parachutes import parachute as kernels
from edl6dof.vehicle.parachutes.parachute import PARACHUTE_PARAMS, ParachuteParams

SOUND, LBF = 225.0, 4.448222
FACTOR, SPEED, DECAY = 1.344, 27.2, 0.25


@cache
def opening(diameter, mass, packed, mach, pressure, vehicle_area, stiffness):
    """Peak tension (N), and peak deceleration of the vehicle (m/s2)."""
    chute = np.zeros(1, PARACHUTE_PARAMS).view(np.recarray)[0]
    params = {"diameter_m": diameter, "line_length_m": 40.0, "stiffness_n_m": stiffness, "damping_ratio": 0.3}
    params |= {"mortar_speed_m_s": 30.0, "confluence_m": (0.0, 0.0, 0.0)}
    fill(chute, ParachuteParams(name="main", drag_coefficient=0.62, **params))
    speed = mach * SOUND
    density = 2.0 * pressure / speed**2

    def motion(t, y):
        tension, _ = kernels.riser_tension(chute, packed, y[0] - y[2], y[1] - y[3], kernels.BY_STRETCH)
        share = kernels.inflation(chute, t)
        axis, v_air = (1.0, 0.0, 0.0), (y[3], 0.0, 0.0)
        pull = kernels.canopy_force(chute, share, density, y[3] / SOUND, t, v_air, axis)[0]
        canopy = packed + kernels.apparent_mass(chute, density, share)
        slowing = (tension + 0.5 * density * y[1] ** 2 * vehicle_area) / mass
        return [y[1], -slowing, y[3], (tension + pull) / canopy], tension, slowing

    span = (0.0, diameter / SPEED + 2.0 * DECAY)
    start = [40.0, speed, 0.0, speed]
    flown = solve_ivp(lambda t, y: motion(t, y)[0], span, start, rtol=1e-8, atol=1e-8, max_step=2e-3)
    tension, slowing = np.array([motion(t, y)[1:] for t, y in zip(flown.t, flown.y.T, strict=True)]).T
    return tension.max(), slowing.max()


#: D (m), vehicle and packed mass (kg), Mach, Pa, drag area of the vehicle (m2), stiffness (N/m).
PHOENIX = (11.73, 572.0, 17.0, 1.68, 490.0, 8.3, 30e3)
MSL = (21.5, 3100.0, 60.0, 1.75, 494.0, 23.9, 60e3)
M2020 = (21.5, 3250.0, 80.0, 1.82, 516.0, 23.9, 60e3)
SR01 = (21.5, 1200.0, 60.0, 1.77, 452.0, 0.33, 60e3)
SR02 = (21.5, 1200.0, 80.0, 1.97, 670.0, 0.33, 60e3)
SR03 = (21.5, 1200.0, 80.0, 1.85, 932.0, 0.33, 60e3)


@pytest.mark.parametrize(
    "case, published, low, high",
    [
        (PHOENIX, 83.0, 0.92, 1.05),  # -4 %
        (MSL, 58.3, 0.75, 1.0),  # -19 % of the raw peak, which rings
        (MSL, 41.4, 1.0, 1.2),  # +14 % of the second, smoothed
        pytest.param(M2020, 49.0, 0.88, 1.05, marks=pytest.mark.long),  # -6 %
        pytest.param(M2020, 53.7, 0.80, 0.95, marks=pytest.mark.long),  # -15 %
    ],
)
def test_deceleration_behind_a_capsule_is_near_the_published_one(case, published, low, high):
    assert low < opening(*case)[1] / published < high


@pytest.mark.parametrize(
    "case, klbf",
    [
        (SR01, 35.0),
        pytest.param(SR02, 55.8, marks=pytest.mark.long),
        pytest.param(SR03, 67.4, marks=pytest.mark.long),
    ],
)
def test_behind_a_slender_body_the_coefficients_of_a_capsule_say_too_little(case, klbf):
    """A miss, by 25 to 40 %: there is no wake of a capsule in which drag is lost, and these fell into thicker
    air while they filled.
    """
    assert 0.55 < opening(*case)[0] / (1e3 * klbf * LBF) < 0.80


def peak_over_drag(*changes):
    """Peak tension of the nominal flight over the drag of the open canopy at full inflation."""
    limit = "simulation.time_limit_s=300"  # all open by then
    flight = edl6dof.fly("tianwen1", [limit, *(f"vehicle.parachutes.main.{change}" for change in changes)])
    chute, rows = flight.scenario.vehicle.main_parachute, flight.telemetry
    taut = next(one["t_s"] for one in flight.events if one["key"] == "line_stretch")
    full = taut + chute.diameter_m / SPEED
    pressure, mach = rows.at(full, "truth.dynamic_pressure_pa", "truth.mach")
    record = np.zeros(1, PARACHUTE_PARAMS).view(np.recarray)[0]
    fill(record, chute)
    area = kernels.nominal_area(record) * chute.drag_coefficient * kernels.drag_efficiency(record, mach)
    return flight.figures["max_riser_tension_n"] / (pressure * area)


def test_the_peak_tension_is_drag_times_the_opening_load_factor_once_nothing_is_counted_twice():
    """The area that oscillates while it fills moves the peak by 10 % and more either way, the elastic riser
    adds the share that the shipped canopy states.
    """
    stated = edl6dof.load("tianwen1").scenario.vehicle.main_parachute.disk_gap_band.dynamic_load_factor
    once = "disk_gap_band.dynamic_load_factor=1"
    phases = [f"area_oscillation_frequency_hz={f}" for f in (2.0, 2.4, 2.8, 3.2, 3.6, 4.0, 4.4)]
    moved = [peak_over_drag("area_oscillates=always", once, phase) for phase in phases]
    assert 1.05 * FACTOR < max(moved) < 1.25 * FACTOR and 0.85 * FACTOR < min(moved) < FACTOR
    one = peak_over_drag("area_oscillates=open", once, phases[0])
    assert one == pytest.approx(stated * FACTOR, rel=0.01)
    assert peak_over_drag("area_oscillates=open") == pytest.approx(FACTOR, rel=0.01)
