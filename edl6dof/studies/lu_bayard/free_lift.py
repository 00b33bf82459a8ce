"""The paper's setting flown: the equations of motion 2 to 4 in air that is not the model's, measured drag and
drag rate, and an input u = (L/D) cos(bank) that has no limit, or that of the vehicle.

The law is the kernel that flies, called at the rate of guidance.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, cos, exp, log, pi, sin

import numpy as np

from edl6dof.fsw.guidance.entry.laws.adaptive_hinf import MEMORY, begin, goal_rates, track
from edl6dof.fsw.guidance.entry.prediction.uncertain_drag import uncertain_drag
from edl6dof.fsw.guidance.entry.profiles.drag_velocity import path_sine, profile_drag
from edl6dof.studies.lu_bayard.disturbance import disturbance_of
from edl6dof.studies.lu_bayard.drag_model import Adapted, Design, state_energy

STEP_S = 0.1
#: Rows after which a flight that does not slow down is given up.
MOST_ROWS = 6000
#: Height (m) of one wave of the density, and below which a wind grows with height.
WAVE_M = 40e3
#: (height, speed, flight-path angle): m, m/s, rad.
State = tuple[float, float, float]
NAV = np.dtype([("flight_path_angle", "f8"), ("gravity", "f8"), ("speed", "f8"), ("radius", "f8")])


@dataclass(frozen=True)
class Errors:
    """What the law is not told.

    Attributes:
        density: amplitude of a wave of ln(density) over height.
        wind_m_s: head wind at the height ``WAVE_M``, in proportion below.
        lift: relative error of L/D.
    """

    density: float = 0.0
    wind_m_s: float = 0.0
    lift: float = 0.0

    def excess(self, height: float, speed: float) -> float:
        """ln(rho / rho_model) + 2 ln(V_air / V)."""
        air = 1.0 + self.wind_m_s * height / WAVE_M / speed
        return self.density * sin(2.0 * pi * height / WAVE_M) + 2.0 * log(air)

    def excess_rate(self, height: float, speed: float, climb: float, speed_rate: float) -> float:
        """Its derivative by time (1/s), at a rate of climb (m/s) and of speed (m/s2)."""
        head = self.wind_m_s * height / WAVE_M
        wave = 2.0 * pi / WAVE_M
        air_rate = head / speed * (climb / max(height, 1.0) - speed_rate / speed)
        return self.density * wave * cos(wave * height) * climb + 2.0 * air_rate / (1.0 + head / speed)


@dataclass(frozen=True)
class Setting:
    """What all flights share.

    Attributes:
        onboard: record array of length one with the planned profile.
        design: settings of the law.
        drag_per_pressure: drag of the model over rho V^2 / 2, m2/kg.
        surface_density: of the model, kg/m3.
        start_error: drag error at the start, m/s2.
    """

    onboard: np.ndarray
    design: Design
    drag_per_pressure: float
    surface_density: float
    start_error: float


def fly_free(
    setting: Setting, errors: Errors, *, limit: float | None = None, constant: float | None = None
) -> tuple[Adapted, np.ndarray]:
    """One flight from the beginning of the profile to its end; returns the response and the inputs u.

    Args:
        setting: vehicle, air and law.
        errors: what the law is not told.
        limit: largest |u|; ``None`` for none.
        constant: an input held in place of the law's.
    """
    memory = np.zeros(1, MEMORY)[0]
    begin(_law(setting), memory)
    state, u = _start(setting, errors), 0.0
    rows: list[tuple[float, ...]] = []
    final = float(setting.onboard[0]["plan"]["adaptive_hinf"]["final"])
    while state[1] > final and len(rows) < MOST_ROWS:
        drag, rate = _measured(setting, errors, state)
        error, error_rate, wanted = _track(setting, memory, state, drag, rate, u, STEP_S if rows else 0.0)
        u = wanted if constant is None else constant
        u = u if limit is None else min(max(u, -limit), limit)
        rows.append((*state, drag, error, error_rate, u, *memory["theta"]))
        state = _step(setting, errors, state, u)
    table = np.array(rows)
    height, speed, _, drags, error, error_rate, inputs = table[:, :7].T
    t = STEP_S * np.arange(len(table))
    excess = np.array([errors.excess(h, v) for h, v in zip(height, speed, strict=True)])
    w = disturbance_of(setting.design, t, drags, speed, excess, errors.lift * inputs)
    return Adapted(t, error, w, state_energy(setting.design, error, error_rate), table[:, 7:]), inputs


def _law(setting: Setting) -> np.void:
    return setting.onboard[0]["guidance"]["entry"]["adaptive_hinf"]


def _start(setting: Setting, errors: Errors) -> State:
    """(height, speed, flight-path angle) on the profile but for ``start_error`` of drag."""
    profile, design = setting.onboard[0]["plan"]["adaptive_hinf"], setting.design
    speed = float(profile["start"])
    goal, slope, _ = profile_drag(profile, speed)
    height = 0.0
    for _ in range(20):
        surface = _drag(setting, errors, height, speed) * exp(height / design.scale_height)
        height = design.scale_height * log(surface / (goal + setting.start_error))
    path = asin(path_sine(speed, goal, slope, _gravity(design, height), design.scale_height))
    return height, speed, path


def _gravity(design: Design, height: float) -> float:
    return design.gravity * (design.radius / (design.radius + height)) ** 2


def _drag(setting: Setting, errors: Errors, height: float, speed: float) -> float:
    density = setting.surface_density * exp(-height / setting.design.scale_height)
    return 0.5 * density * speed**2 * setting.drag_per_pressure * exp(errors.excess(height, speed))


def _measured(setting: Setting, errors: Errors, state: State) -> tuple[float, float]:
    """Drag and its rate, which the paper takes as measured."""
    height, speed, path = state
    drag = _drag(setting, errors, height, speed)
    climb, speed_rate = speed * sin(path), -drag - _gravity(setting.design, height) * sin(path)
    relative = -climb / setting.design.scale_height + 2.0 * speed_rate / speed
    return drag, drag * (relative + errors.excess_rate(height, speed, climb, speed_rate))


def _track(
    setting: Setting, memory: np.void, state: State, drag: float, rate: float, flown: float, dt: float
) -> tuple[float, float, float]:
    """Drag error, its rate, and the input that the law wants."""
    record, design = setting.onboard[0], setting.design
    height, speed, path = state
    goal, slope, curvature = profile_drag(record["plan"]["adaptive_hinf"], speed)
    nav = np.array([(path, _gravity(design, height), speed, design.radius + height)], NAV)[0]
    goal_rate, goal_free, goal_per_u = goal_rates(nav, drag, rate, slope, curvature)
    dynamics = uncertain_drag(drag, rate, speed, design.gravity, design.radius, design.scale_height)
    error, error_rate = drag - goal, rate - goal_rate
    wanted = track(_law(setting), memory, dt, flown, error, error_rate, dynamics, goal_free, goal_per_u)
    return error, error_rate, wanted


def _step(setting: Setting, errors: Errors, state: State, u: float) -> State:
    """The state a step later, the input held: RK4."""

    def rates(height: float, speed: float, path: float) -> State:
        drag, gravity = _drag(setting, errors, height, speed), _gravity(setting.design, height)
        turn = (speed / (setting.design.radius + height) - gravity / speed) * cos(path)
        lift = drag * u * (1.0 + errors.lift)
        return speed * sin(path), -drag - gravity * sin(path), lift / speed + turn

    a = rates(*state)
    b = rates(*_ahead(state, 0.5 * STEP_S, a))
    c = rates(*_ahead(state, 0.5 * STEP_S, b))
    d = rates(*_ahead(state, STEP_S, c))
    x, y, z = (p + 2.0 * (q + r) + s for p, q, r, s in zip(a, b, c, d, strict=True))
    return _ahead(state, STEP_S / 6.0, (x, y, z))


def _ahead(state: State, dt: float, rates: State) -> State:
    """Where constant rates lead in a time; plain numbers, as numpy takes longer for three."""
    return state[0] + dt * rates[0], state[1] + dt * rates[1], state[2] + dt * rates[2]
