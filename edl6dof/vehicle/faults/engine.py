"""Faults of one engine: too little thrust or none, a late start, a throttle that does not move, thrust that
points elsewhere.
"""

from __future__ import annotations

from typing import ClassVar

from edl6dof.config.base import param
from edl6dof.interface.events import IGNITE, Action
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.commanded_events import put_off
from edl6dof.vehicle.faults.component import EngineFault
from edl6dof.vehicle.plant import THRUST


class EngineShortfallParams(EngineFault):
    """The engine gives less thrust than its throttle is set to."""

    thrust_factor: float = param(0.8, "thrust left", ge=0.0, lt=1.0)


class EngineDeadParams(EngineFault):
    """The engine does not light, or goes out."""


class IgnitionDelayParams(EngineFault):
    """The engine lights late."""

    over_after: ClassVar[tuple[Action, ...]] = ("ignite",)

    delay_s: float = param(2.0, "time lost", gt=0.0, le=600.0)


class EngineMisalignedParams(EngineFault):
    """The thrust turns away from where it pointed, as with a bent mount or a burnt nozzle."""

    turn_y_deg: float = param(1.5, "about y of B", ge=-10.0, le=10.0)
    turn_z_deg: float = param(0.0, "about z of B", ge=-10.0, le=10.0)


class ThrottleStuckParams(EngineFault):
    """The throttle of the engine stays where it is; before ignition, at full thrust.  Cut-off still works."""


@kernel
def engine_shortfall(fault, case, since, command, plant):
    """Take away part of the thrust."""
    plant.thrust_lost[fault.component] = 1.0 - fault.params.engine_shortfall.thrust_factor


@kernel
def engine_dead(fault, case, since, command, plant):
    """Take away all thrust."""
    plant.thrust_lost[fault.component] = 1.0


@kernel
def ignition_delay(fault, case, since, command, plant):
    """Put the ignition off when it is commanded."""
    put_off(
        case,
        command,
        plant,
        action=IGNITE,
        component=fault.component,
        delay=fault.params.ignition_delay.delay,
    )


@kernel
def engine_misaligned(fault, case, since, command, plant):
    """Turn the thrust."""
    i, p = fault.component, fault.params.engine_misaligned
    plant.thrust_turned[i, 0], plant.thrust_turned[i, 1] = p.turn_y, p.turn_z


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
    Member("engine_dead", EngineDeadParams, {"inflict": engine_dead}, "no ignition, flame-out"),
    Member("ignition_delay", IgnitionDelayParams, {"inflict": ignition_delay}, "slow valve, late command"),
    Member(
        "engine_misaligned",
        EngineMisalignedParams,
        {"inflict": engine_misaligned},
        "bent mount, burnt nozzle",
    ),
    Member("throttle_stuck", ThrottleStuckParams, {"inflict": throttle_stuck}, "seized throttle valve"),
)
