"""Reaction-control thrusters: valves opened and closed at any time, impulse delivered exactly.

A valve command is an interval [open, close].  The thrust level of a thruster climbs linearly to one in
``rise_s`` while the valve is open and falls to zero in ``decay_s`` when it is shut.  Over one integration
step the level is integrated twice in closed form and applied as a line
(:func:`edl6dof.vehicle.propulsion.engine_models.line_in_step`), so the impulse of a pulse does not depend on
the step, nor does the displacement that it leaves.

A leak passes through the seat of the valve, in addition to what the valve lets through: with the level n of
the valve and the leak l, both as shares of the full flow, the flow is l + (1 - l) n.  Only the latch valve of
the branch stops it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import field_validator

from edl6dof.config.base import REQUIRED, Capacity, Hardware, Key, Vec3, param, unique_names, unit_vector
from edl6dof.config.dtype import dtype_of
from edl6dof.config.units import G0
from edl6dof.interface.capacities import MAX_BRANCHES, MAX_TANKS, MAX_THRUSTERS
from edl6dof.interface.effectors import ThrusterGroup
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import add, clamp, cross, put3, scale, take3
from edl6dof.vehicle.propulsion.engine_models import line_in_step
from edl6dof.vehicle.propulsion.feed_system import draw, load_within_reach


class Thruster(Hardware):
    """One reaction-control thruster."""

    name: Key = param(REQUIRED, "name, unique in the vehicle", record=False)
    group: ThrusterGroup = param(
        REQUIRED,
        (
            "purpose: horizontal hazard avoidance and roll; axial parallel to the engine; pitch and yaw; "
            "fine pointing"
        ),
    )
    position_m: Vec3 = param(REQUIRED, "nozzle position in B")
    direction: Vec3 = param(REQUIRED, "unit vector of the force on the vehicle in B")
    thrust_n: float = param(
        REQUIRED, "steady vacuum thrust", ge=0.0, le=5000.0, usual=(0.1, 5000, "attitude control thrusters")
    )
    thrust_factor: float = param(
        1.0, "true thrust divided by thrust_n; the flight software assumes thrust_n", ge=0.0, le=1.5
    )
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

    _unit_length = field_validator("direction")(unit_vector)

    @property
    def full_flow_kg_s(self) -> float:
        """Propellant flow at full thrust, kg/s."""
        return self.thrust_n / (self.specific_impulse_s * G0)


class Branch(Hardware):
    """One propellant branch."""

    name: Key = param(REQUIRED, "name, unique in the vehicle", record=False)
    thrusters: list[Key] = param(REQUIRED, "thrusters behind its latch valve", record=False, min_length=1)


class RcsParams(Hardware):
    """The thruster set and its interaction with the flow."""

    thrusters: Annotated[list[Thruster], Capacity(MAX_THRUSTERS)] = param(
        None, "thrusters; empty for none", factory=list, max_length=MAX_THRUSTERS
    )
    branches: Annotated[list[Branch], Capacity(MAX_BRANCHES)] = param(
        None,
        "propellant branches, each behind one latch valve; empty: one branch for each thruster",
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

    _names_differ = field_validator("thrusters", "branches")(unique_names)

    @property
    def laid_branches(self) -> list[Branch]:
        """Branches as given; without any, one for each thruster with its name."""
        return self.branches or [Branch(name=jet.name, thrusters=[jet.name]) for jet in self.thrusters]


RCS = dtype_of(RcsParams)


def branch_problems(branches: Sequence[Branch], thrusters: Sequence[str]) -> dict[str, str]:
    """Problems by dotted key: each thruster must be on one branch, unless there are no branches."""
    given = Counter(name for branch in branches for name in branch.thrusters)
    problems = {
        f"branches.{k}.thrusters.{j}": f"no thruster named {name!r}; names: {', '.join(thrusters) or 'none'}"
        for k, branch in enumerate(branches)
        for j, name in enumerate(branch.thrusters)
        if name not in thrusters
    }
    twice = [name for name in thrusters if given[name] > 1]
    missing = [name for name in thrusters if branches and given[name] == 0]
    words = [f"{', '.join(twice)} on more than one"] if twice else []
    words += [f"{', '.join(missing)} on none"] if missing else []
    if missing and not twice and not problems:  # probably new thrusters
        place = f"thrusters.{thrusters.index(missing[0])}.name"
        problems[place] = f"must be on one of vehicle.rcs.branches (got {words[0]})"
    elif words:
        problems["branches"] = f"every thruster must be on one branch (got {'; '.join(words)})"
    return problems


def fill_branches(record: np.void, branches: Sequence[Branch], thrusters: Sequence[Thruster]) -> None:
    """Fill a ``BRANCHES`` record of zeros; each thruster lies on one of the ``branches``."""
    record["count"] = len(branches)
    for i, jet in enumerate(thrusters):
        own = next(k for k, branch in enumerate(branches) if jet.name in branch.thrusters)
        record["of"][i] = own
        record["full_flow"][own] += jet.full_flow_kg_s


@kernel
def climb(level, duration, slope):
    """Two integrals of a level over ``duration`` at ``slope`` (1/s) within 0 .. 1, and the new level."""
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
    """Level of a valve open in an interval, over a step: line (mean, slope in 1/s), and value at the end."""
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
    """Force and moment of all thrusters in vacuum and their propellant flow, linear over a step.  Flow is
    proportional to thrust, except with some faults, so that the velocity gained agrees with the propellant
    used.  The loss of force to the air flow (:func:`efficiency`) changes within the step.

    Updates ``valves.level`` and ``valves.mean`` (the mean thrust fraction of each thruster, logged and drawn
    as plumes); writes ``rcs_force``, ``rcs_moment`` (mean, N and N m about the origin of B),
    ``rcs_force_slope``, ``rcs_moment_slope`` (N/s, N m/s), ``rcs_flow`` (mean, kg/s out of each tank) and
    ``rcs_flow_slope`` (kg/s2) of ``inputs``, whose ``filled`` marks the tanks that are not empty.  ``loads``
    are the thrusters' ``FEEDS``, ``branch`` is the branch of each thruster, and the flow is added to ``used``
    (kg) of each branch.
    """
    for k in range(MAX_TANKS):
        inputs.rcs_flow[k] = inputs.rcs_flow_slope[k] = 0.0
    force = moment = force_slope = moment_slope = (0.0, 0.0, 0.0)
    for i in range(rcs.n_thrusters):
        opens, closes = valves.open_time[i], valves.close_time[i]
        leak, flow_leak = valves.leak[i], valves.flow_leak[i]
        if valves.level[i] == 0.0 and flow_leak == 0.0 and (closes <= t or opens >= t + step):
            valves.mean[i] = 0.0
            continue
        jet = rcs.thrusters[i]
        rise = valves.rise[i] if valves.rise[i] > 0.0 else jet.rise
        decay = valves.decay[i] if valves.decay[i] > 0.0 else jet.decay
        mean, slope, level = linear_level(
            valves.level[i], rise, decay, t, step, open_time=opens, close_time=closes
        )
        valves.level[i] = level
        within = load_within_reach(loads, i, inputs.filled)
        if mean == 0.0 and flow_leak == 0.0 or within == 0.0:
            valves.mean[i] = 0.0
            continue
        thrust = jet.thrust * jet.thrust_factor
        full_flow = thrust / (jet.specific_impulse * G0)
        drawn = (1.0 - valves.flow_lost[i]) * (1.0 - valves.feed_lost)
        feed = (loads, i, inputs.filled, within)
        passing = flow_leak + (1.0 - flow_leak) * mean
        draw(feed, passing * drawn * full_flow, inputs.rcs_flow, 0)
        draw(feed, (1.0 - flow_leak) * slope * drawn * full_flow, inputs.rcs_flow_slope, 0)
        used[branch[i]] += passing * drawn * full_flow * step
        kept = (1.0 - valves.lost[i]) * (1.0 - valves.feed_lost)
        mean = (leak + (1.0 - leak) * mean) * kept
        slope *= (1.0 - leak) * kept
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
