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

from edl6dof.verify.outcome import History, Outcome, Result
from edl6dof.verify.scene import (
    BARE,
    ENDLESS,
    ONE_BODY,
    VACUUM,
    WEIGHTLESS,
    after,
    scenes,
    state_of,
    to_the_end,
)

G0 = 9.80665
ISP = 300.0
#: Thrust commands (N), each for ten seconds; 0 cuts off.
THROTTLE = (7500.0, 3000.0, 1500.0, 5000.0, 2200.0, 0.0)
_SCENE = (
    *BARE,
    *VACUUM,
    *WEIGHTLESS,
    *ONE_BODY,
    *ENDLESS,
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
    "initial.rate_deg_s=[0, 0, 0]",
)


def run(planted: Sequence[str] = ()) -> Outcome:
    """Throttle through six levels and compare speed lost with mass lost at every row."""
    state, speed, mass, time, thrust = None, [], [], [], []
    for index, level in enumerate(THROTTLE):
        _, loaded = scenes([*_SCENE, f"simulation.time_limit_s={10 * (index + 1)}"], planted)
        state = state_of(loaded) if state is None else state
        state.plant["running"][0, 0], state.fsw["command"]["thrust"][0, 0] = 1, level
        state.fsw["command"]["engine_mode"] = 2 if index == 0 else 1
        flight = to_the_end(loaded, state)
        rows = flight.telemetry
        speed.append(rows["truth.v_down_m_s"])
        mass.append(rows["truth.mass_kg"])
        time.append(rows["t_s"])
        thrust.append(rows["truth.engine_thrust_n"])
        state = after(flight)
    v, m, t = np.concatenate(speed), np.concatenate(mass), np.concatenate(time)
    expected = v[0] - ISP * G0 * np.log(m[0] / m)
    error = float(np.max(np.abs(v - expected)) / (v[0] - v[-1]))
    burnt = float(np.trapezoid(np.concatenate(thrust), t) / (ISP * G0))
    off = abs((m[0] - m[-1]) / burnt - 1.0)
    source, why = "rocket equation", "RK4 at 10 ms; corners of the thrust rate"
    return Outcome(
        (
            Result("speed against mass", "throttled burn", source, error, 1e-9, "-", why),
            Result(
                "mass against impulse",
                "propellant flow",
                "integral of the thrust",
                off,
                1e-5,
                "-",
                "trapezoid over rows 20 ms apart",
            ),
        ),
        History("Throttled burn", "time (s)", "speed (m/s)", t, {"flown": v, "expected": expected}),
    )
