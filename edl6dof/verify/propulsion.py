"""Check cases of engines and thrusters: thrust, flow and mass loss."""

from __future__ import annotations

from functools import partial

import numpy as np

from edl6dof.config.units import G0
from edl6dof.scenario.records import initial_sensors
from edl6dof.sim.checkpoint import State
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate
from edl6dof.vehicle.plant import OUTPUTS, PROPELLANT, WORKSPACE
from edl6dof.verify import case
from edl6dof.verify.case import Bench, given, largest, records_of, state_of, to_the_end

#: One rigid body with propellant.
_FUELLED = (
    *(*case.FREE, case.NO_RATE),
    "vehicle.mass.entry_centre_m=[-0.85, 0, 0]",
    "vehicle.tanks=[{name: main, mass_kg: 190, centre_m: [-0.85, 0, 0]}]",
)
ENGINE_ISP = 300.0
#: Thrust commands (N), each for ten seconds; 0 cuts off.
_THROTTLE = (7500.0, 3000.0, 1500.0, 5000.0, 2200.0, 0.0)
BURN = (
    *(*_FUELLED, *case.ALIGNED),
    *given("vehicle.engines.main", full_specific_impulse_s=ENGINE_ISP, nozzle_m=[-0.3, 0, 0]),
    f"vehicle.engines.main.throttled.low_specific_impulse_s={ENGINE_ISP}",
    *given("initial", flight_path_angle_deg=-90, speed_m_s=1000),
)


def rocket_equation(bench: Bench) -> None:
    """Verifies: thrust, propellant flow and mass loss of a throttled burn.

    gravity none | atmosphere none | winds none | vehicle one rigid body with propellant and a centred engine
    | source: Tsiolkovsky, exact for constant specific impulse whatever the throttle does: dV = Isp g0 ln(m0 /
    m1) | tolerance 1e-9 of dV: RK4 at 10 ms where the thrust is a smooth function, and 1e-7 of a step's dV at
    the few steps that hold a corner of its rate limit.

    Throttle through six levels and compare speed lost with mass lost at every row.
    """
    state, found = None, []
    for index, level in enumerate(_THROTTLE):
        _, loaded = bench.scenes([*BURN, f"simulation.time_limit_s={10 * (index + 1)}"])
        state = state_of(loaded) if state is None else state
        state.plant["running"][0, 0], state.fsw["command"]["thrust"][0, 0] = 1, level
        state.fsw["command"]["engine_mode"] = 2 if index == 0 else 1
        flight = to_the_end(loaded, state)
        names = ("t_s", "truth.v_down_m_s", "truth.mass_kg", "truth.engine_thrust_n")
        found.append([flight.telemetry[name] for name in names])
        cycle = round(flight.time_s * flight.scenario.flight_software.rates.base_hz)
        state = State(cycle, flight.plant, flight.peaks, initial_sensors(), flight.fsw, "")
    t, v, m, thrust = np.concatenate(found, axis=1)
    expected = v[0] - ENGINE_ISP * G0 * np.log(m[0] / m)
    error, burnt = largest(v - expected) / (v[0] - v[-1]), float(np.trapezoid(thrust, t) / (ENGINE_ISP * G0))
    corners = ("throttled burn", "rocket equation", "RK4 at 10 ms; corners of the thrust rate")
    sampled = ("propellant flow", "integral of the thrust", "trapezoid over rows 20 ms apart")
    bench.compare("speed against mass", error, 1e-9, "-", *corners)
    bench.compare("mass against impulse", abs((m[0] - m[-1]) / burnt - 1.0), 1e-5, "-", *sampled)
    bench.plot("Throttled burn", "time (s)", "speed (m/s)", t, v, expected)


_THRUST, _ISP, _RISE, _DECAY = 250.0, 270.0, 0.012, 0.019
_JET = (
    "{name: J, group: axial, position_m: [-2, 0, 0], direction: [1, 0, 0], minimum_pulse_s: 0.001, "
    f"thrust_n: {_THRUST}, specific_impulse_s: {_ISP}, rise_s: {_RISE}, decay_s: {_DECAY}}}"
)
_PULSES = (
    *(*_FUELLED, "flight_software.check_out.thrusters=[]", "initial.speed_m_s=0"),
    *given("vehicle.rcs", thrusters=f"[{_JET}]", branches=[]),
)
CYCLE, CYCLES = 0.1, 200


def _closed_form(length: np.ndarray) -> np.ndarray:
    """Integral of the thrust fraction of one pulse from rest, s."""
    peak = length / _RISE
    short = 0.5 * peak * (length + peak * _DECAY)
    return np.where(length >= _RISE, length + 0.5 * (_DECAY - _RISE), short)


def impulses(bench: Bench) -> None:
    """Verifies: impulse and propellant of random thruster pulse trains over random steps, through the
    integrator.

    gravity none | atmosphere none | winds none | vehicle one rigid body with propellant, one thruster in line
    with its centre | source: a trapezium for each pulse, F (T + (decay - rise) / 2), or a triangle if it is
    shorter than the rise (F: steady thrust, T: time for which the valve is open); rocket equation for the
    speed | tolerance: rounding of 2,000 steps. The propellant used up to each pulse is within 1e-10 of its
    expected value; the speed after each pulse is within 1.2e-11 m/s, 1e-11 of the final speed of 1.2 m/s.

    Fire 200 pulses of 1 to 60 ms in steps of random length and compare propellant and speed.
    """
    nominal, loaded = bench.scenes(_PULSES)
    plant, rng = state_of(loaded).plant, np.random.default_rng(11)
    flown = (*records_of(loaded), plant[0], np.zeros(1, OUTPUTS)[0], np.zeros(1, WORKSPACE)[0])
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
    used = _THRUST * np.cumsum(_closed_form(lengths)) / (_ISP * G0)
    mass = nominal.vehicle.mass.entry_kg
    expected = _ISP * G0 * np.log(mass / (mass - used))
    compare = partial(bench.compare, verifies="pulse impulse", why="rounding of 2,000 steps")
    off_mass, off_speed = largest(np.array(delivered) / used - 1.0), largest(speed - expected) / expected[-1]
    compare("propellant", off_mass, 1e-10, source="trapezium for each pulse")
    compare("speed", off_speed, 1e-11, source="trapezium and rocket equation")
    bench.plot("Pulse train", "pulse", "speed (m/s)", np.arange(CYCLES), np.array(speed), expected)
