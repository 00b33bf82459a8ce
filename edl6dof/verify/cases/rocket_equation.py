"""Verifies: thrust, propellant flow and mass loss of a throttled burn.

gravity none | atmosphere none | winds none | vehicle one rigid body with propellant and a centred engine |
source: Tsiolkovsky, exact for
constant specific impulse whatever the throttle does: dV = Isp g0 ln(m0 / m1) | tolerance 1e-9 of dV: RK4 at
10 ms where the thrust is a smooth function, and 1e-7 of a step's dV at the few steps that hold a corner of
its rate limit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.config.units import G0
from edl6dof.scenario.records import initial_sensors
from edl6dof.sim.checkpoint import State
from edl6dof.verify.case import FREE, NO_RATE, History, Outcome, Result, largest, scenes, state_of, to_the_end

ISP = 300.0
#: Thrust commands (N), each for ten seconds; 0 cuts off.
THROTTLE = (7500.0, 3000.0, 1500.0, 5000.0, 2200.0, 0.0)
_SCENE = (
    *(*FREE, NO_RATE),
    "vehicle.mass.entry_centre_m=[-0.85, 0, 0]",
    "vehicle.tanks=[{name: main, mass_kg: 190, centre_m: [-0.85, 0, 0]}]",
    f"vehicle.engines.main.full_specific_impulse_s={ISP}",
    f"vehicle.engines.main.throttled.low_specific_impulse_s={ISP}",
    "vehicle.engines.main.nozzle_m=[-0.3, 0, 0]",
    "initial.flight_path_angle_deg=-90",
    "initial.alpha_deg=0",
    "initial.beta_deg=0",
    "initial.bank_deg=0",
    "initial.speed_m_s=1000",
)


def run(planted: Sequence[str] = ()) -> Outcome:
    """Throttle through six levels and compare speed lost with mass lost at every row."""
    state, found = None, []
    for index, level in enumerate(THROTTLE):
        _, loaded = scenes([*_SCENE, f"simulation.time_limit_s={10 * (index + 1)}"], planted)
        state = state_of(loaded) if state is None else state
        state.plant["running"][0, 0], state.fsw["command"]["thrust"][0, 0] = 1, level
        state.fsw["command"]["engine_mode"] = 2 if index == 0 else 1
        flight = to_the_end(loaded, state)
        names = ("t_s", "truth.v_down_m_s", "truth.mass_kg", "truth.engine_thrust_n")
        found.append([flight.telemetry[name] for name in names])
        cycle = round(flight.time_s * flight.scenario.flight_software.rates.base_hz)
        state = State(cycle, flight.plant, flight.peaks, initial_sensors(), flight.fsw, "")
    t, v, m, thrust = np.concatenate(found, axis=1)
    expected = v[0] - ISP * G0 * np.log(m[0] / m)
    error, burnt = largest(v - expected) / (v[0] - v[-1]), float(np.trapezoid(thrust, t) / (ISP * G0))
    why, sampled = "RK4 at 10 ms; corners of the thrust rate", "trapezoid over rows 20 ms apart"
    about = {"verifies": "propellant flow", "source": "integral of the thrust", "why": sampled}
    results = (
        Result("speed against mass", error, 1e-9, "-", "throttled burn", "rocket equation", why),
        Result("mass against impulse", abs((m[0] - m[-1]) / burnt - 1.0), 1e-5, **about),
    )
    return Outcome(results, History("Throttled burn", "time (s)", "speed (m/s)", t, v, expected))
