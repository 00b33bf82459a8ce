"""The sampled drag observer against linear algebra and an independently integrated entry."""

from math import cos, exp, radians, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from edl6dof.fsw.guidance.entry.disturbance_observers import MEMORY_S, OBSERVER, observe, observer_gains
from edl6dof.fsw.guidance.entry.drag_dynamics import drag_dynamics

RADIUS, MU, SCALE_HEIGHT = 3397.2e3, 4.2828376212e13, 10e3
BALLISTIC, LIFT_TO_DRAG = 120.0, 0.24


@pytest.mark.parametrize("epsilon", [0.1, 0.7, 3.0])
@pytest.mark.parametrize("dt", [0.02, 0.1, 0.5, 2.0])
def test_sampled_error_has_the_poles_of_the_continuous_observer(epsilon, dt):
    """Eigenvalues of (I - K C) F, F the exact transition of three integrators."""
    gain = np.array(observer_gains(epsilon, dt))
    chain = np.array([[1.0, dt, dt**2 / 2.0], [0.0, 1.0, dt], [0.0, 0.0, 1.0]])
    error = (np.eye(3) - np.outer(gain, [1.0, 0.0, 0.0])) @ chain
    expected = np.poly([exp(-n * dt / epsilon) for n in (1, 2, 3)])
    assert np.poly(error) == pytest.approx(expected, abs=1e-9)


def test_printed_observer_closed_explicitly_at_ten_hertz_would_diverge():
    """Why the observer is solved exactly between samples."""
    continuous = np.array([[-60.0, 1.0, 0.0], [-1100.0, 0.0, 1.0], [-6000.0, 0.0, 0.0]])
    assert np.sort(np.linalg.eigvals(continuous).real) == pytest.approx([-30.0, -20.0, -10.0])
    assert np.max(np.abs(np.linalg.eigvals(np.eye(3) + 0.1 * continuous))) == pytest.approx(2.0, abs=1e-6)


def test_steady_perturbation_is_found_without_error():
    """D'' = b + a u + phi with everything constant: all three estimates become exact."""
    memory = np.zeros(1, OBSERVER)[0]
    dt, a, b, phi = 0.1, -0.05, 0.3, -0.02
    for k in range(60):
        t = 10.0 + k * dt
        drag = 20.0 + 1.5 * t + 0.5 * (b + 0.4 * a + phi) * t * t
        observe(memory, 0.1, drag, t, drag, a, b, 0.4)
    assert memory["drag"] == pytest.approx(drag, abs=1e-7)
    assert memory["rate"] == pytest.approx(1.5 + (b + 0.4 * a + phi) * t, abs=1e-6)
    assert memory["phi"] == pytest.approx(phi, abs=1e-4)


def entry(lift_to_drag, density, bank):
    """Wu et al. eqs. 1-3, 7-8 with their numbers, integrated by scipy; returns state, drag and drag rate as
    functions of time.
    """

    def drag_of(r, v):
        return 0.5 * density * np.exp(-(r - RADIUS - 31.8e3) / SCALE_HEIGHT) * v**2 / BALLISTIC

    def rates(t, s):
        r, v, gamma = s
        drag, g = drag_of(r, v), MU / r**2
        return [
            v * sin(gamma),
            -drag - g * sin(gamma),
            lift_to_drag * drag * cos(bank) / v + (v / r - g / v) * cos(gamma),
        ]

    flown = solve_ivp(
        rates, (0.0, 60.0), [RADIUS + 60e3, 5700.0, radians(-14.0)], dense_output=True, rtol=1e-10, atol=1e-8
    ).sol

    def drag_at(t):
        r, v, _ = flown(t)
        return drag_of(r, v)

    return flown, drag_at, lambda t: (drag_at(t + 1e-3) - drag_at(t - 1e-3)) / 2e-3


@pytest.mark.parametrize(
    "lift_to_drag, density",
    [
        pytest.param(0.24, 0.00078, marks=pytest.mark.long),
        (0.216, 0.0009),
        pytest.param(0.264, 0.00066, marks=pytest.mark.long),
    ],
)
def test_estimates_converge_within_0_6_s_from_a_wrong_start(lift_to_drag, density):
    """Wu, Cui & Cui 2013, Fig. 3: sampled at 10 Hz, from a drag 20 % off and no drag rate, L/D off by 3
    sigma.
    """
    bank = radians(60.0)
    flown, drag_at, rate_at = entry(lift_to_drag, density, bank)
    memory = np.zeros(1, OBSERVER)[0]
    largest = max(abs(rate_at(t)) for t in np.arange(0.5, 59.0, 0.5))
    for k in range(500):
        t = 0.1 * k
        r, v, gamma = flown(t)
        drag = float(drag_at(t))
        _, a, b = drag_dynamics(drag, v, gamma, r, MU / r**2, LIFT_TO_DRAG * drag, SCALE_HEIGHT)
        observe(memory, 0.1, 0.8 * drag, t, drag, a, b, cos(bank))
        if t >= 0.6:
            assert memory["drag"] == pytest.approx(drag, rel=0.01)
            assert memory["rate"] == pytest.approx(rate_at(t), abs=0.02 * largest)


def test_a_long_gap_starts_afresh_and_a_repeated_call_changes_nothing():
    memory = np.zeros(1, OBSERVER)[0]
    observe(memory, 0.1, 10.0, 1.0, 10.0, -0.1, 0.2, 0.5)
    assert (memory["drag"], memory["rate"], memory["phi"]) == (10.0, 0.0, 0.0)
    before = memory.copy()
    observe(memory, 0.1, 11.0, 1.0, 11.0, -0.1, 0.2, 0.5)
    assert memory == before
    observe(memory, 0.1, 50.0, 1.0 + 1.1 * MEMORY_S, 50.0, -0.1, 0.2, 0.5)
    assert (memory["drag"], memory["rate"], memory["phi"]) == (50.0, 0.0, 0.0)
