"""The fading memories of measured drag and of speed."""

from math import exp, sin

import numpy as np
import pytest

from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.navigation.derived import DRAG_FILTER, NAV, filter_drag, model_atmosphere

DT, GAMMA, MACH = 0.02, -0.15, 12.0


class Glide:
    """A straight path through the believed air, its density off by a factor: what navigation would tell."""

    def __init__(self, onboard, altitude, speed):
        self.onboard, self.t, self.altitude, self.speed = onboard, 0.0, altitude, speed
        self.memory = np.zeros(1, DRAG_FILTER)[0]

    def drag(self, altitude, speed):
        vehicle = self.onboard["vehicle"]
        density, _, _ = model_atmosphere(self.onboard["atmosphere"], altitude)
        return 0.5 * density * speed * speed * believed_aero(vehicle, MACH, speed)[0] / vehicle["entry_mass"]

    def step(self, factor=1.0, more_speed=0.0):
        """Filtered drag and energy, and those that were measured, one cycle on."""
        nav = np.zeros(1, NAV)[0]
        nav["t"], nav["altitude"], nav["flight_path_angle"] = self.t, self.altitude, GAMMA
        nav["gravity"], nav["mach"] = 3.7, MACH
        nav["speed"] = self.speed + more_speed
        nav["drag"] = measured = factor * self.drag(self.altitude, self.speed)
        nav["energy"] = energy = 0.5 * nav["speed"] ** 2
        filter_drag(
            self.onboard["navigation"]["drag_filter"],
            self.onboard["atmosphere"],
            self.onboard["vehicle"],
            nav,
            self.memory,
        )
        self.advance(factor)
        return nav["drag"], nav["energy"], measured, energy

    def advance(self, factor):
        """Path and speed over one cycle, Heun's method."""
        ahead = self.altitude + DT * self.speed * sin(GAMMA)
        rate = -factor * self.drag(self.altitude, self.speed) - 3.7 * sin(GAMMA)
        later = -factor * self.drag(ahead, self.speed + DT * rate) - 3.7 * sin(GAMMA)
        self.altitude += DT * (self.speed + 0.5 * DT * rate) * sin(GAMMA)
        self.speed += 0.5 * DT * (rate + later)
        self.t += DT


@pytest.fixture
def glide(onboard):
    return Glide(onboard[0], 35e3, 3300.0)


@pytest.mark.parametrize(
    "factor", [pytest.param(1.0, marks=pytest.mark.long), 0.6, pytest.param(1.4, marks=pytest.mark.long)]
)
def test_drag_and_energy_are_the_measured_ones_without_lag_in_air_that_is_off_by_a_factor(glide, factor):
    for _ in range(1000):
        drag, energy, measured, measured_energy = glide.step(factor)
        assert drag == pytest.approx(measured, rel=1e-6)
        assert energy == pytest.approx(measured_energy, rel=1e-6)


def test_a_sudden_change_of_density_passes_with_the_time_constant(glide):
    glide.step()
    glide.step()
    tau = glide.onboard["navigation"]["drag_filter"]["time_constant"]
    for i in range(1, round(2.0 * tau / DT)):
        drag, _, measured, _ = glide.step(1.2)
        assert drag / measured * 1.2 == pytest.approx(1.0 + 0.2 * (1.0 - exp(-i * DT / tau)), abs=1e-3)


def test_what_lift_does_to_the_speed_in_a_wind_comes_in_with_the_memory_of_the_speed(glide):
    tau = glide.onboard["navigation"]["drag_filter"]["speed_time_constant"]
    glide.step()
    for i in range(1, 200):
        _, energy, _, measured = glide.step(more_speed=2.0)
        missing = 2.0 * exp(-i * DT / tau)
        assert measured - energy == pytest.approx(glide.memory["speed"] * missing, rel=5e-3)


def test_too_little_drag_is_taken_as_measured(onboard):
    high = Glide(onboard[0], 90e3, 3300.0)
    for factor in (1.0, 2.0):
        drag, energy, measured, measured_energy = high.step(factor)
        assert (drag, energy) == (measured, measured_energy)
        assert 0.0 < drag < onboard[0]["navigation"]["drag_filter"]["least_drag"]
