"""What can be observed and commanded in a flight, by name, unit and shape, for programs that know neither."""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.api.simulation import Simulation
from edl6dof.config.units import split_unit
from edl6dof.sim.commanding import ESTIMATE

#: Commands of more than one number, or of none: how many; those left out have one.
_SIZES = {"thrust_n": 3, "torque_nm": 3, "safe_spot_m": 2, "coarse_spot_m": 2}


def described(simulation: Simulation) -> dict[str, Any]:
    """The scenario, and everything that can be observed and commanded in it."""
    from edl6dof import __version__

    scenario = simulation.loaded.scenario
    thrusters = scenario.thruster_names
    return {
        "version": __version__,
        "scenario": scenario.name,
        "cycle_s": simulation.cycle_s,
        "phases": list(scenario.phase_names),
        "thrusters": list(thrusters),
        "observations": {name: _kind(name, value) for name, value in simulation.observe().items()},
        "commands": {name: _command(name, len(thrusters)) for name in simulation.commands},
    }


def _kind(name: str, value: Any) -> dict[str, Any]:
    """Type, shape and unit of an observation."""
    kinds = {bool: "true or false", int: "whole number"}
    return {
        "type": kinds.get(type(value), "number"),
        "shape": list(np.shape(value)),
        "unit": split_unit(name)[1].label,
    }


def _command(name: str, thrusters: int) -> dict[str, Any]:
    """Type, shape and unit of a command."""
    if name == "estimate":
        parts = {part: _numbers(part, size) for part, (_, size) in ESTIMATE.items()}
        return {"type": "map", "of": parts}
    if name == "isolate":
        return {"type": "names of thrusters", "shape": [], "unit": ""}
    return _numbers(name, thrusters if name == "duties" else _SIZES.get(name, 1))


def _numbers(name: str, size: int) -> dict[str, Any]:
    return {"type": "number", "shape": [] if size == 1 else [size], "unit": split_unit(name)[1].label}
