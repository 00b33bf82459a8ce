"""Overrides that make another vehicle or mission of Tianwen-1's, and what a flight shows at a time."""

from __future__ import annotations

import json

import numpy as np

import edl6dof


def phases(change):
    """Override: the mission of Tianwen-1 with ``change(phases)`` applied to its phases by name."""
    own = edl6dof.load("tianwen1").scenario.mission.phases
    table = {phase.name: phase.model_dump(mode="json", exclude_none=True) for phase in own}
    change(table)
    return f"mission.phases={json.dumps(list(table.values()))}"


def when(quantity, crosses, value, **window):
    return {"quantity": quantity, "crosses": crosses, "value": value, **window}


def event(name, action, component, trigger, delay_s=0.0):
    return {"name": name, "action": action, "component": component, "delay_s": delay_s, "when": trigger}


def at(flight, column, t):
    return np.interp(t, flight.telemetry["t_s"], flight.telemetry[column])


def parts(*more):
    own = [part.model_dump(mode="json") for part in edl6dof.load("tianwen1").scenario.vehicle.parts]
    return f"vehicle.parts={json.dumps([*own, *more])}"
