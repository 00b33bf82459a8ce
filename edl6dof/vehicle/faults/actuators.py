"""Faults of thrusters (dead, open, weak, leaking or slow; all behind one latch valve dead; all weak at once),
surfaces such as a trim wing (stuck or lost), parachutes (late or dead mortar, torn canopy or riser), engines
(too little thrust or none, late start, stuck throttle, thrust that points elsewhere) and tanks (leak, blocked
feed).
"""

from __future__ import annotations

from typing import ClassVar

from edl6dof.config.base import param
from edl6dof.interface.effectors import (
    DEGRADED,
    DEPLOY,
    IGNITE,
    STUCK_OFF,
    STUCK_ON,
    Action,
    ThrusterFailure,
    is_done_to,
)
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.aerodynamics.surfaces import wing_opening
from edl6dof.vehicle.faults.component import (
    BranchFault,
    EngineFault,
    ParachuteFault,
    RcsFault,
    SurfaceFault,
    TankFault,
    ThrusterFault,
)
from edl6dof.vehicle.motion.staging import release
from edl6dof.vehicle.plant import THRUST

#: Duration (s) longer than any base cycle, for which a fault opens a valve.
LONG = 1.0


#: Time (s) of an event that never happens.
NEVER = 1e99


@kernel
def is_about(event, action, component):
    """True if an event is an ``action`` on a ``component``, or on a group of engines that contains it."""
    if event.action != action:
        return False
    return is_done_to(event, component) if action >= IGNITE else event.component == component


@kernel
def delay_event(case, command, plant, action, component, delay):
    """Delay an action on a component by ``delay`` s if it is commanded now; a group of engines waits."""
    for k in range(case.events.n_events):
        event = case.events.events[k]
        if command.request[k] != 0 and is_about(event, action, component):
            plant.due[k] += delay


@kernel
def cancel_event(case, plant, action, component):
    """Cancel a scheduled ``action`` on a ``component``."""
    for k in range(case.events.n_events):
        event = case.events.events[k]
        if is_about(event, action, component):
            plant.due[k] = NEVER


class StuckOffParams(ThrusterFault):
    """The thruster does not fire any more."""

    failure: ClassVar[ThrusterFailure | None] = "stuck_off"


class StuckOnParams(ThrusterFault):
    """The thruster's valve does not close any more; only the latch valve of its branch stops it."""

    failure: ClassVar[ThrusterFailure | None] = "stuck_on"


class DegradedParams(ThrusterFault):
    """The thruster gives less thrust."""

    failure: ClassVar[ThrusterFailure | None] = "degraded"

    thrust_factor: float = param(0.5, "remaining share of the thrust", ge=0.0, lt=1.0)
    flow_factor: float = param(
        0.0,
        "remaining share of the propellant flow, 1 with a bad catalyst; 0: the same share as of the thrust",
        ge=0.0,
        le=1.0,
    )


class LeakingParams(ThrusterFault):
    """The valve shuts, but its seat leaks; what leaks gives hot gas.  Only the latch valve stops it."""

    failure: ClassVar[ThrusterFailure | None] = "stuck_on"

    thrust_factor: float = param(0.2, "thrust of the leak, share of the full thrust", ge=0.0, le=1.0)
    flow_factor: float = param(
        0.0,
        "propellant flow of the leak, share of the full flow; 0: the same share as of the thrust",
        ge=0.0,
        le=1.0,
    )


class SlowParams(ThrusterFault):
    """The valve opens and shuts slowly: a long pulse begins and ends late, a short one
    does not reach full thrust."""

    failure: ClassVar[ThrusterFailure | None] = "degraded"

    rise_s: float = param(0.2, "time from valve opening to full thrust", gt=0.0, le=100.0)
    decay_s: float = param(0.2, "time from valve closing to no thrust", gt=0.0, le=100.0)


class BranchDeadParams(BranchFault):
    """The latch valve of the branch fails shut: none of its thrusters fires any more."""

    failure: ClassVar[ThrusterFailure | None] = "stuck_off"


class WeakThrustersParams(RcsFault):
    """All thrusters give less thrust, from less flow: low feed pressure, or cold propellant."""

    failure: ClassVar[ThrusterFailure | None] = "degraded"

    thrust_factor: float = param(0.8, "remaining share of thrust and flow", ge=0.0, lt=1.0)


@kernel
def stuck_off(fault, case, since, command, plant):
    """Keep the valve shut."""
    i = fault.component
    plant.valves.fault[i] = STUCK_OFF
    plant.valves.open_time[i] = plant.valves.close_time[i] = plant.t


@kernel
def stuck_on(fault, case, since, command, plant):
    """Keep the valve open."""
    i = fault.component
    plant.valves.fault[i] = STUCK_ON
    plant.valves.open_time[i], plant.valves.close_time[i] = plant.t, plant.t + LONG


@kernel
def degraded(fault, case, since, command, plant):
    """Take away part of the thrust."""
    i = fault.component
    plant.valves.fault[i] = DEGRADED
    p = fault.params.degraded
    plant.valves.lost[i] = 1.0 - p.thrust_factor
    plant.valves.flow_lost[i] = 1.0 - (p.flow_factor if p.flow_factor > 0.0 else p.thrust_factor)


@kernel
def leaking(fault, case, since, command, plant):
    """Let part of the flow through the shut valve."""
    i, p = fault.component, fault.params.leaking
    plant.valves.fault[i] = STUCK_ON
    plant.valves.leak[i] = p.thrust_factor
    plant.valves.flow_leak[i] = p.flow_factor if p.flow_factor > 0.0 else p.thrust_factor


@kernel
def slow(fault, case, since, command, plant):
    """Make the thrust rise and fall slowly."""
    i = fault.component
    plant.valves.fault[i] = DEGRADED
    plant.valves.rise[i], plant.valves.decay[i] = fault.params.slow.rise, fault.params.slow.decay


@kernel
def branch_dead(fault, case, since, command, plant):
    """Keep all valves of the branch shut."""
    for i in range(case.vehicle.rcs.n_thrusters):
        if case.branches.of[i] == fault.component:
            plant.valves.fault[i] = STUCK_OFF
            plant.valves.open_time[i] = plant.valves.close_time[i] = plant.t


@kernel
def weak_thrusters(fault, case, since, command, plant):
    """Take away part of the thrust and flow of all thrusters."""
    plant.valves.feed_lost = 1.0 - fault.params.weak_thrusters.thrust_factor
    for i in range(case.vehicle.rcs.n_thrusters):
        if plant.valves.fault[i] == 0:
            plant.valves.fault[i] = DEGRADED


_THRUSTER = (
    Member("stuck_off", StuckOffParams, {"inflict": stuck_off}, "Hu et al. 2022, section 6.3"),
    Member("stuck_on", StuckOnParams, {"inflict": stuck_on}, "valve failed open"),
    Member("degraded", DegradedParams, {"inflict": degraded}, "partly blocked feed or catalyst"),
    Member("leaking", LeakingParams, {"inflict": leaking}, "dirt on the seat of the valve"),
    Member("slow", SlowParams, {"inflict": slow}, "worn or frozen valve, cold catalyst"),
    Member("branch_dead", BranchDeadParams, {"inflict": branch_dead}, "latch valve failed shut"),
    Member("weak_thrusters", WeakThrustersParams, {"inflict": weak_thrusters}, "low feed pressure"),
)


class WingStuckParams(SurfaceFault):
    """The surface opens no further."""

    opening: float = param(
        0.0,
        "opening (0 closed, 1 open) at which it sticks, unless it is open further already",
        ge=0.0,
        lt=1.0,
    )


class WingLostParams(SurfaceFault):
    """The surface is torn off."""

    ends: ClassVar[bool] = False


@kernel
def wing_stuck(fault, case, since, command, plant):
    """Limit the opening."""
    i = fault.component
    already = wing_opening(case.vehicle.surfaces[i], since - plant.wing_start[i])
    plant.wing_lost[i] = 1.0 - max(fault.params.wing_stuck.opening, already)


@kernel
def wing_lost(fault, case, since, command, plant):
    """Take the surface away."""
    plant.wing_lost[fault.component] = 1.0


_SURFACE = (
    Member("wing_stuck", WingStuckParams, {"inflict": wing_stuck}, "Hu et al. 2022, section 4.3"),
    Member("wing_lost", WingLostParams, {"inflict": wing_lost}, "structural failure"),
)


class ParachuteDelayParams(ParachuteFault):
    """The mortar fires late."""

    over_after: ClassVar[tuple[Action, ...]] = ("deploy",)

    delay_s: float = param(3.0, "delay of the deployment", gt=0.0, le=600.0)


class ParachuteDeadParams(ParachuteFault):
    """The mortar does not fire."""

    over_after: ClassVar[tuple[Action, ...]] = ("deploy",)


class CanopyTornParams(ParachuteFault):
    """The canopy loses part of its drag area, at once or as it opens."""

    ends: ClassVar[bool] = False

    area_factor: float = param(0.7, "remaining share of the drag area", ge=0.0, lt=1.0)


class RiserTornParams(ParachuteFault):
    """The riser breaks: the vehicle loses the canopy, at once or when it is deployed."""

    ends: ClassVar[bool] = False


@kernel
def parachute_delay(fault, case, since, command, plant):
    """Delay the deployment when it is commanded."""
    delay = fault.params.parachute_delay.delay
    delay_event(case, command, plant, action=DEPLOY, component=fault.component, delay=delay)


@kernel
def parachute_dead(fault, case, since, command, plant):
    """Cancel the deployment."""
    cancel_event(case, plant, DEPLOY, fault.component)


@kernel
def canopy_torn(fault, case, since, command, plant):
    """Take away part of the drag area."""
    plant.canopy_lost[fault.component] = 1.0 - fault.params.canopy_torn.area_factor


@kernel
def riser_torn(fault, case, since, command, plant):
    """Release the canopy."""
    release(case, plant, fault.component)


_PARACHUTE = (
    Member("parachute_delay", ParachuteDelayParams, {"inflict": parachute_delay}, "late mortar"),
    Member("parachute_dead", ParachuteDeadParams, {"inflict": parachute_dead}, "dead mortar"),
    Member(
        "canopy_torn",
        CanopyTornParams,
        {"inflict": canopy_torn},
        "torn gores, as of LDSD 2014 and 2015 and in drop tests of ExoMars 2019; from memory",
    ),
    Member("riser_torn", RiserTornParams, {"inflict": riser_torn}, "structural failure"),
)


class EngineShortfallParams(EngineFault):
    """The engine gives less thrust than its throttle is set to."""

    thrust_factor: float = param(0.8, "remaining share of the thrust", ge=0.0, lt=1.0)


class EngineDeadParams(EngineFault):
    """The engine does not light, or goes out."""


class IgnitionDelayParams(EngineFault):
    """The engine lights late."""

    over_after: ClassVar[tuple[Action, ...]] = ("ignite",)

    delay_s: float = param(2.0, "delay of the ignition", gt=0.0, le=600.0)


class EngineMisalignedParams(EngineFault):
    """The thrust turns away from where it pointed, as with a bent mount or a burnt nozzle."""

    turn_y_deg: float = param(1.5, "rotation of the thrust about y of B", ge=-10.0, le=10.0)
    turn_z_deg: float = param(0.0, "rotation of the thrust about z of B", ge=-10.0, le=10.0)


class ThrottleStuckParams(EngineFault):
    """The throttle sticks at its present level; before ignition, at full thrust.  Cut-off still works."""


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
    """Delay the ignition when it is commanded."""
    delay = fault.params.ignition_delay.delay
    delay_event(case, command, plant, action=IGNITE, component=fault.component, delay=delay)


@kernel
def engine_misaligned(fault, case, since, command, plant):
    """Turn the thrust."""
    i, p = fault.component, fault.params.engine_misaligned
    plant.thrust_turned[i, 0], plant.thrust_turned[i, 1] = p.turn_y, p.turn_z


@kernel
def throttle_stuck(fault, case, since, command, plant):
    """Hold the thrust that the engine had when the fault began; full thrust if it was off."""
    i = fault.component
    if plant.t == since:
        running = plant.running[i] != 0
        plant.thrust_held[i] = plant.y[THRUST + i] if running else case.vehicle.engines[i].full_thrust
    plant.thrust_command[i] = plant.thrust_held[i]


_ENGINE = (
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


class TankLeakParams(TankFault):
    """Propellant leaks out of the tank; left out: the force of its jet."""

    flow_kg_s: float = param(0.5, "mass flow of the leak", gt=0.0, le=100.0)


class TankBlockedParams(TankFault):
    """The feed of the tank is shut: engines and thrusters without another tank give no thrust."""


@kernel
def tank_leak(fault, case, since, command, plant):
    """Let propellant out."""
    plant.leak[fault.component] = fault.params.tank_leak.flow


@kernel
def tank_blocked(fault, case, since, command, plant):
    """Shut the feed."""
    plant.blocked[fault.component] = 1


_TANK = (
    Member("tank_leak", TankLeakParams, {"inflict": tank_leak}, "leaking tank, line or seal"),
    Member(
        "tank_blocked", TankBlockedParams, {"inflict": tank_blocked}, "seized latch valve, clogged filter"
    ),
)


#: Kinds of fault of actuators, in the order of their indices.
MEMBERS = (*_THRUSTER, *_SURFACE, *_PARACHUTE, *_ENGINE, *_TANK)
