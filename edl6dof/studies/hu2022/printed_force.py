"""The disturbance force of Fig. 12 as eqs. 10 to 12 are printed: the *commanded* force is the vehicle's own.

Put together they say F' = lambda_v (m a_b - F_c - F): what pulse modulation gives beyond the command, and
what it owes, is part of that estimate.  The command is worked out again from the telemetry of a flight with
perfect sensors, by the law of guidance and at its rate; the estimated force, which this product feeds
forward, is not in it.
"""

from __future__ import annotations

from math import exp

import numpy as np

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.guidance.command import GUIDE
from edl6dof.fsw.guidance.powered.terminal import TerminalParams, acceleration_towards, push_sideways
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.interface.roles import HAZARD_AVOIDANCE
from edl6dof.sim.flight import Flight

#: Convergence speeds lambda_v, rad/s; the paper prints none.
POLES_RAD_S = (1.0, 2.0, 4.0, 8.0)


def commanded_n(flight: Flight) -> np.ndarray:
    """Lateral force (N, towards north and east) commanded in hazard avoidance, by row, shape (2, rows)."""
    software = flight.scenario.flight_software
    table, rows = flight.telemetry, np.flatnonzero(flight.during(HAZARD_AVOIDANCE))
    params = np.zeros(1, dtype_of(TerminalParams))[0]
    fill(params, software.guidance.powered.terminal)
    nav, goal = np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0]
    north, east, v_north, v_east, mass = (
        table[f"truth.{name}"][rows]
        for name in ("site_north_m", "site_east_m", "v_north_m_s", "v_east_m_s", "mass_kg")
    )
    spot = north[0] + params["safe_spot_north"], east[0] + params["safe_spot_east"]
    found = np.empty((2, len(rows)))
    for k in range(len(rows)):
        if k % software.rates.powered_guidance_every == 0:
            nav["v_N"][:2] = v_north[k], v_east[k]
            towards = acceleration_towards(params, nav, spot[0] - north[k], spot[1] - east[k])
            push_sideways(params, mass[k], towards, (0.0, 0.0), goal)
        found[:, k] = goal["force_N"]
    return found


def largest_n(flight: Flight, pole_rad_s: float) -> float:
    """Largest lateral component (N) of the estimate as printed, in hazard avoidance."""
    table, rows = flight.telemetry, np.flatnonzero(flight.during(HAZARD_AVOIDANCE))
    felt = np.stack(
        [table[f"truth.rcs_force_{axis}_n"] + table[f"truth.aero_force_{axis}_n"] for axis in "yz"]
    )
    unexplained = felt[:, rows] + commanded_n(flight)  # upright: y points south, z west
    dt = float(np.median(np.diff(table["t_s"][rows])))
    step, estimate, largest = 1.0 - exp(-pole_rad_s * dt), np.zeros(2), 0.0
    for seen in unexplained.T:
        estimate += step * (seen - estimate)
        largest = max(largest, float(np.max(np.abs(estimate))))
    return largest
