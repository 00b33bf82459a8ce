"""One row of the study's table for each flight."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import Flight
from edl6dof.studies.hu2022.rigs import Entry, from_entry, thrust_error_deg

#: Thrust-direction error below which a commanded direction counts as found, and the time in which it is
#: looked for.  In the divert the command turns by some 2.5 deg/s, and the controller, to which no rate of it
#: is told, follows derivative over proportional gain behind: 1.4 s.
FOUND_DEG, WATCHED_S = 5.0, 12.0
#: Attitude error below which a torque step counts as settled: above the limit cycle of the thrusters.
SETTLED_DEG = 0.5


def entry_row(release: State, index: int, entry: Entry, formulation: str) -> Row:
    """How one error formulation finds the commanded thrust direction from one dispersed entry."""
    flight = from_entry(release, entry, formulation)
    t = flight.telemetry["t_s"] - flight.telemetry["t_s"][0]
    watched = t < WATCHED_S
    t, error = t[watched], thrust_error_deg(flight)[watched]
    return {
        **_head("entry", formulation, flight, index),
        "roll_deg": entry.roll_deg,
        "tilt_deg": entry.tilt_deg,
        "first_error_deg": float(error[0]),
        "peak_error_deg": float(error.max()),
        "settled_s": last_time(t, error > FOUND_DEG),
        "mean_error_deg": float(np.trapezoid(error, t)) / WATCHED_S,
    }


def step_rows(flights: Mapping[str, Flight]) -> list[Row]:
    """Peak and settling of the yaw error after the torque step."""
    rows = []
    for name, flight in flights.items():
        table = flight.telemetry
        t, error = table["t_s"] - table["t_s"][0], np.abs(table["control.error_yaw_deg"])
        figures = {"peak_error_deg": float(error.max()), "settled_s": last_time(t, error > SETTLED_DEG)}
        rows.append({**_head("torque step", name, flight), **figures})
    return rows


def wing_rows(flights: Mapping[str, Flight]) -> list[Row]:
    """Total angle of attack at which the parachute opens."""
    return [
        {
            **_head("trim wing", name, flight),
            "parachute_total_alpha_deg": flight.metrics["parachute_total_alpha_deg"],
        }
        for name, flight in flights.items()
    ]


def last_time(t: np.ndarray, outside: np.ndarray) -> float:
    """Last time at which a condition holds; 0 when it never does."""
    where = np.flatnonzero(outside)
    return float(t[where[-1]]) if len(where) else 0.0


def _head(experiment: str, variant: str, flight: Flight, index: int = 0) -> Row:
    return {
        "experiment": experiment,
        "variant": variant,
        "case": index,
        "landed": bool(flight.landed),
        "outcome": flight.outcome,
    }
