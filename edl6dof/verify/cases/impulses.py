"""Verifies: impulse and propellant of random thruster pulse trains over random steps, through the integrator.

gravity none | atmosphere none | winds none | vehicle one rigid body with propellant, one thruster in line
with its centre | source: a trapezium for each pulse, F (T + (decay - rise) / 2), or a triangle if it is
shorter than the rise; rocket equation for the speed | tolerance 1e-10 of each sum of propellant, and 1e-11
of the last speed, 1.2 m/s, for all of them: rounding of 2,000 steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from edl6dof.config.units import G0
from edl6dof.scenario import records
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.plant import OUTPUTS, PROPELLANT, WORKSPACE
from edl6dof.verify.case import FREE, NO_RATE, History, Outcome, Result, largest, scenes, state_of

THRUST, ISP, RISE, DECAY = 250.0, 270.0, 0.012, 0.019
_JET = (
    "{name: J, group: axial, position_m: [-2, 0, 0], direction: [1, 0, 0], minimum_pulse_s: 0.001, "
    f"thrust_n: {THRUST}, specific_impulse_s: {ISP}, rise_s: {RISE}, decay_s: {DECAY}}}"
)
_SCENE = (
    *(*FREE, NO_RATE),
    "vehicle.mass.entry_centre_m=[-0.85, 0, 0]",
    "vehicle.tanks=[{name: main, mass_kg: 190, centre_m: [-0.85, 0, 0]}]",
    f"vehicle.rcs.thrusters=[{_JET}]",
    "vehicle.rcs.branches=[]",
    "flight_software.check_out.thrusters=[]",
    "initial.speed_m_s=0",
)
CYCLE, CYCLES = 0.1, 200


def closed_form(length: np.ndarray) -> np.ndarray:
    """Integral of the thrust fraction of one pulse from rest, s."""
    peak = length / RISE
    return np.where(length >= RISE, length + 0.5 * (DECAY - RISE), 0.5 * peak * (length + peak * DECAY))


def run(planted: Sequence[str] = ()) -> Outcome:
    """Fire 200 pulses of 1 to 60 ms in steps of random length and compare propellant and speed."""
    nominal, loaded = scenes(_SCENE, planted)
    tables = records.build_tables(loaded.truth)
    case, start = records.build_case(loaded.truth, tables), state_of(loaded)
    plant, rng = start.plant, np.random.default_rng(11)
    flown = (case[0], tables[0], plant[0], np.zeros(1, OUTPUTS)[0], np.zeros(1, WORKSPACE)[0])
    evaluate(*flown)
    lengths = rng.uniform(0.001, 0.06, CYCLES)
    delivered, speed, v0 = [], [], plant["y"][0, 3:6].copy()
    for k, length in enumerate(lengths):
        begin = k * CYCLE + rng.uniform(0.0, 0.01)
        plant["valves"]["open_time"][0, 0], plant["valves"]["close_time"][0, 0] = begin, begin + length
        for cut in [*np.sort(rng.uniform(k * CYCLE, (k + 1) * CYCLE, 9)), (k + 1) * CYCLE]:
            advance(*flown, cut)
        delivered.append(190.0 - plant["y"][0, PROPELLANT])
        speed.append(float(np.linalg.norm(plant["y"][0, 3:6] - v0)))
    used = THRUST * np.cumsum(closed_form(lengths)) / (ISP * G0)
    mass = nominal.vehicle.mass.entry_kg
    expected = ISP * G0 * np.log(mass / (mass - used))
    result = partial(Result, verifies="pulse impulse", why="rounding of 2,000 steps")
    off_mass, off_speed = largest(np.array(delivered) / used - 1.0), largest(speed - expected) / expected[-1]
    results = (
        result("propellant", off_mass, 1e-10, source="trapezium for each pulse"),
        result("speed", off_speed, 1e-11, source="trapezium and rocket equation"),
    )
    curves = History("Pulse train", "pulse", "speed (m/s)", np.arange(CYCLES), np.array(speed), expected)
    return Outcome(results, curves)
