"""Reaction-control thrusters: valves opened and closed at any time, impulse delivered exactly.

A valve command is an interval [open, close].  The thrust level of a thruster climbs linearly to one in
``rise_s`` while the valve is open and falls to zero in ``decay_s`` when it is shut.  Over one integration
step the level is integrated twice in closed form and applied as a line
(:mod:`edl6dof.vehicle.propulsion.engine_models`), so the impulse of a pulse does not depend on the step, nor
does the displacement that it leaves.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import field_validator

from edl6dof.config.base import REQUIRED, Capacity, Hardware, Key, Vec3, param, unique_names, unit_vector
from edl6dof.config.dtype import dtype_of
from edl6dof.config.units import G0
from edl6dof.interface.capacities import MAX_BRANCHES, MAX_TANKS, MAX_THRUSTERS
from edl6dof.interface.effectors import ThrusterGroup
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import add, clamp, cross, put3, scale, take3
from edl6dof.vehicle.propulsion.feed_system import Branch, draw, load_within_reach
from edl6dof.vehicle.propulsion.line_in_step import line_in_step


class Thruster(Hardware):
    """One reaction-control thruster."""

    name: Key = param(REQUIRED, "name, unique in the vehicle", record=False)
    group: ThrusterGroup = param(
        REQUIRED,
        (
            "what it is for: horizontal hazard avoidance and roll; axial beside the engine; pitch and yaw; "
            "fine pointing"
        ),
    )
    position_m: Vec3 = param(REQUIRED, "nozzle position in B")
    direction: Vec3 = param(REQUIRED, "unit vector of the force on the vehicle in B")
    thrust_n: float = param(
        REQUIRED, "steady vacuum thrust", ge=0.0, le=5000.0, usual=(0.1, 5000, "attitude control thrusters")
    )
    thrust_factor: float = param(1.0, "thrust delivered over thrust_n, which is believed", ge=0.0, le=1.5)
    specific_impulse_s: float = param(
        REQUIRED,
        "specific impulse, steady",
        gt=0.0,
        le=500.0,
        usual=(50, 500, "cold gas to hydrogen and oxygen"),
    )
    minimum_pulse_s: float = param(
        REQUIRED, "shortest commanded pulse", gt=0.0, le=1.0, usual=(0.001, 0.5, "valves of thrusters")
    )
    rise_s: float = param(0.012, "time from valve opening to full thrust", status="estimate", gt=0.0, le=0.2)
    decay_s: float = param(0.012, "time from valve closing to no thrust", status="estimate", gt=0.0, le=0.2)
    draws_from: list[Key] = param(None, "tanks that feed it; empty: all", record=False, factory=list)

    @field_validator("direction")
    @classmethod
    def _unit_length(cls, value: Vec3) -> Vec3:
        return unit_vector(value)

    @property
    def full_flow_kg_s(self) -> float:
        """Propellant flow at full thrust."""
        return self.thrust_n / (self.specific_impulse_s * G0)


class RcsParams(Hardware):
    """The thruster set and its interaction with the flow."""

    thrusters: Annotated[list[Thruster], Capacity(MAX_THRUSTERS)] = param(
        None, "thrusters; empty for none", factory=list, max_length=MAX_THRUSTERS
    )
    branches: Annotated[list[Branch], Capacity(MAX_BRANCHES)] = param(
        None,
        "propellant branches, each behind one latch valve; empty: every thruster on one of its own",
        record=False,
        factory=list,
    )
    flow_loss: float = param(
        0.0,
        "fraction of thrust lost at the reference dynamic pressure",
        status="estimate",
        ge=0.0,
        lt=1.0,
        usual=(0, 0.3, "losses of several thrusters at once"),
    )
    flow_loss_pressure_pa: float = param(
        5000.0, "dynamic pressure at which flow_loss applies", status="estimate", gt=0.0
    )

    @field_validator("thrusters", "branches")
    @classmethod
    def _unique_names(cls, value: list[Any]) -> list[Any]:
        return unique_names(value)

    @property
    def laid_branches(self) -> list[Branch]:
        """The branches: those given, or one for every thruster, named as it."""
        return self.branches or [Branch(name=jet.name, thrusters=[jet.name]) for jet in self.thrusters]


RCS = dtype_of(RcsParams)


@kernel
def climb(level, duration, slope):
    """First and second integral of a level over ``duration`` while it moves at ``slope`` (1/s) and stops at 0
    or 1; returns (first, second, new level).
    """
    if duration <= 0.0:
        return 0.0, 0.0, level
    goal = 1.0 if slope > 0.0 else 0.0
    reach = (goal - level) / slope
    if reach >= duration:
        end = level + slope * duration
        return 0.5 * (level + end) * duration, (2.0 * level + end) / 6.0 * duration * duration, end
    moving, rest = 0.5 * (level + goal) * reach, duration - reach
    second = (2.0 * level + goal) / 6.0 * reach * reach + (moving + 0.5 * goal * rest) * rest
    return moving + goal * rest, second, goal


@kernel
def linear_level(level, rise, decay, start, step, open_time, close_time):
    """Thrust level over [start, start + step] of a valve open during [open_time, close_time], as a line;
    returns (mean, slope in 1/s, level at the end).
    """
    end = start + step
    a = clamp(open_time, start, end)
    b = clamp(close_time, a, end)
    before, before2, level = climb(level, a - start, -1.0 / decay)
    during, during2, level = climb(level, b - a, 1.0 / rise)
    after, after2, level = climb(level, end - b, -1.0 / decay)
    second = before2 + before * (end - a) + during2 + during * (end - b) + after2
    mean, slope = line_in_step(before + during + after, second, step)
    return mean, slope, level


@kernel
def efficiency(rcs, dynamic_pressure):
    """Share of the thrust that the flow around the vehicle leaves, at a dynamic pressure in Pa."""
    return 1.0 - rcs.flow_loss * clamp(dynamic_pressure / rcs.flow_loss_pressure, 0.0, 1.0)


@kernel
def fire(rcs, loads, branch, valves, t, step, inputs, used):
    """Force and moment of all thrusters in vacuum and their propellant flow, linear over a step: unless a
    fault parts them, the flow goes with the thrust, or a speed would not follow from the propellant used.
    What the air takes of the force (:func:`efficiency`) changes within the step.

    Updates ``valves.level`` and ``valves.mean`` (the mean thrust fraction of each thruster, logged and drawn
    as plumes); writes ``rcs_force``, ``rcs_moment`` (mean, N and N m about the origin of B),
    ``rcs_force_slope``, ``rcs_moment_slope`` (N/s, N m/s), ``rcs_flow`` (mean, kg/s out of each tank) and
    ``rcs_flow_slope`` (kg/s2) of ``inputs``, whose ``filled`` says which tanks are not empty.  ``loads`` are
    the thrusters' ``FEEDS``, ``branch`` says on which each lies, and ``used`` (kg) counts on for each branch.
    """
    for k in range(MAX_TANKS):
        inputs.rcs_flow[k] = inputs.rcs_flow_slope[k] = 0.0
    force = moment = force_slope = moment_slope = (0.0, 0.0, 0.0)
    for i in range(rcs.n_thrusters):
        if valves.level[i] == 0.0 and (valves.close_time[i] <= t or valves.open_time[i] >= t + step):
            valves.mean[i] = 0.0
            continue
        jet = rcs.thrusters[i]
        mean, slope, level = linear_level(
            valves.level[i],
            jet.rise,
            jet.decay,
            start=t,
            step=step,
            open_time=valves.open_time[i],
            close_time=valves.close_time[i],
        )
        valves.level[i] = level
        within = load_within_reach(loads, i, inputs.filled)
        if mean == 0.0 or within == 0.0:
            valves.mean[i] = 0.0
            continue
        thrust = jet.thrust * jet.thrust_factor
        full_flow = thrust / (jet.specific_impulse * G0)
        drawn = (1.0 - valves.flow_lost[i]) * (1.0 - valves.feed_lost)
        draw(
            loads,
            row=i,
            filled=inputs.filled,
            within=within,
            flow=mean * drawn * full_flow,
            taken=inputs.rcs_flow,
            first=0,
        )
        draw(
            loads,
            row=i,
            filled=inputs.filled,
            within=within,
            flow=slope * drawn * full_flow,
            taken=inputs.rcs_flow_slope,
            first=0,
        )
        used[branch[i]] += mean * drawn * full_flow * step
        kept = (1.0 - valves.lost[i]) * (1.0 - valves.feed_lost)
        mean *= kept
        slope *= kept
        valves.mean[i] = mean
        full = scale(thrust, take3(jet.direction, 0))
        arm = cross(take3(jet.position, 0), full)
        force, moment = add(force, scale(mean, full)), add(moment, scale(mean, arm))
        force_slope = add(force_slope, scale(slope, full))
        moment_slope = add(moment_slope, scale(slope, arm))
    put3(inputs.rcs_force, 0, force)
    put3(inputs.rcs_moment, 0, moment)
    put3(inputs.rcs_force_slope, 0, force_slope)
    put3(inputs.rcs_moment_slope, 0, moment_slope)
