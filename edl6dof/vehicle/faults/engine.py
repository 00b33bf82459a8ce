"""Faults of one engine: too little thrust, or a throttle that does not move."""

from __future__ import annotations

from edl6dof.config.base import param
from edl6dof.jit import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.component import EngineFault
from edl6dof.vehicle.plant import THRUST


class EngineShortfallParams(EngineFault):
    """The engine gives less thrust than its throttle is set to."""

    thrust_factor: float = param(0.8, "thrust left", ge=0.0, lt=1.0)


class ThrottleStuckParams(EngineFault):
    """The throttle of the engine stays where it is; before ignition, at full thrust.  Cut-off still works."""


@kernel
def engine_shortfall(fault, case, since, command, plant):
    """Take away part of the thrust."""
    plant.thrust_lost[fault.component] = 1.0 - fault.params.engine_shortfall.thrust_factor


@kernel
def throttle_stuck(fault, case, since, command, plant):
    """Hold the level of the moment the fault began."""
    i = fault.component
    if plant.t == since:
        running = plant.running[i] != 0
        plant.thrust_held[i] = plant.y[THRUST + i] if running else case.vehicle.engines[i].full_thrust
    plant.thrust_command[i] = plant.thrust_held[i]


MEMBERS = (
    Member("engine_shortfall", EngineShortfallParams, {"inflict": engine_shortfall}, "low chamber pressure"),
    Member("throttle_stuck", ThrottleStuckParams, {"inflict": throttle_stuck}, "seized throttle valve"),
)
