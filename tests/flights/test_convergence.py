"""Verifies: order of the integrator, and that the default step is fine enough, on flights without
flight-software quantisation and, by means over neighbouring flights, in the closed loop.

gravity GMM-3 degree 4 | atmosphere exponential (smooth) or table | winds none or table | vehicle tianwen1 |
source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.4 (order from step
halving).
Planted error: the weights 1, 2, 2, 1 changed to 1, 1, 3, 1 drop the measured order to two;
Euler's step in place of Runge-Kutta's parts the means of the closed loop.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import f_oneway

import edl6dof
from edl6dof.campaign.ensemble import fly_neighbours

FREE = ["mission.phases=[]", "initial.rate_deg_s=[0, 0, 0]", "initial.alpha_deg=-10", "initial.beta_deg=0"]


def _impact(step: float) -> np.ndarray:
    figures = edl6dof.fly("tianwen1", [*FREE, f"simulation.step_s={step}"]).figures
    return np.array([figures["landing_east_m"], figures["landing_north_m"]])


def test_halving_the_step_moves_the_impact_by_less_than_a_metre():
    assert np.linalg.norm(_impact(0.01) - _impact(0.005)) < 1.0


@pytest.mark.parametrize(
    ("quantity", "part"), [("position", slice(0, 3)), ("velocity", slice(3, 6)), ("attitude", slice(6, 10))]
)
def test_runge_kutta_is_of_fourth_order(quantity, part):
    """Spinning body with constant drag coefficient and rate damping in an exponential atmosphere: every force
    is smooth.
    """
    smooth = [
        "sensors.set=perfect",
        "mission.phases=[]",
        "flight_software.rates.base_hz=5",
        "atmosphere.model=exponential",
        "wind.model=none",
        "vehicle.aero.model=constant",
        "vehicle.aero.constant.drag_coefficient=1.5",
        "vehicle.aero.constant.pitch_damping=-0.5",
        "vehicle.aero.constant.reference_area_m2=9",
        "vehicle.aero.constant.chord_m=3.4",
        "vehicle.aero.constant.moment_reference_x_m=-1.2",
        "initial.altitude_m=45000",
        "initial.rate_deg_s=[5, 20, 3]",
        "simulation.time_limit_s=20",
    ]

    def state(step: float) -> np.ndarray:
        return edl6dof.fly("tianwen1", [*smooth, f"simulation.step_s={step}"]).plant["y"][0, part].copy()

    coarse, middle, fine = state(0.1), state(0.05), state(0.025)
    ratio = np.linalg.norm(coarse - middle) / np.linalg.norm(middle - fine)
    assert np.log2(ratio) == pytest.approx(4.0, abs=0.3), quantity


#: One of each stretch of the flight: entry, parachute phase, powered phase, and what it all cost.
CLOSED_LOOP = ("parachute_s", "backshell_s", "touchdown_s", "powered_duration_s", "propellant_used_kg")


@pytest.fixture(
    scope="module",
    params=[((50, 200), 8), pytest.param(((50, 100, 200), 12), marks=pytest.mark.long)],
    ids=["half and twice the default", "default too"],
)
def rows_by_rate(request):
    """Rows of neighbouring flights by the steps a second they took, from entry to standstill."""
    rates, flights = request.param
    kinds = ("step_s", "canopy_step_s", "contact_step_s")
    scenarios = {
        rate: edl6dof.load("tianwen1", [f"simulation.{kind}={1.0 / rate}" for kind in kinds])
        for rate in rates
    }
    return {rate: fly_neighbours(loaded, flights, step_m_s=1e-3) for rate, loaded in scenarios.items()}


@pytest.mark.parametrize("figure", CLOSED_LOOP)
def test_closed_loop_means_agree_at_every_rate(rows_by_rate, figure):
    """One-way analysis of variance: rates differ by no more than flights of one rate do."""
    samples = [[row[figure] for row in rows] for rows in rows_by_rate.values()]
    assert f_oneway(*samples).pvalue > 1e-3, {
        rate: np.mean(s) for rate, s in zip(rows_by_rate, samples, strict=True)
    }
