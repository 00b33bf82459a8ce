"""Actuation: commands of the flight software set valves, engines and events; faults act in between."""

from __future__ import annotations

from edl6dof.interface.effectors import ENGINE_FULL
from edl6dof.kernels import kernel
from edl6dof.vehicle.motion.point_mass import POINT_MASS, command_bank
from edl6dof.vehicle.plant import NOT_BEGUN


@kernel
def actuate(kinds, case, command, plant):
    """Pass the commands of the flight software on to valves, engines, point mass and imagers, and schedule
    requested events with their delay; faults and latch valves override the commands.
    """
    vehicle = case.vehicle
    for i in range(vehicle.rcs.n_thrusters):
        plant.valves.open_time[i] = command.valve_open_time[i]
        plant.valves.close_time[i] = command.valve_close_time[i]
    if case.dynamics == POINT_MASS and command.steering != 0:
        command_bank(case, plant, command.bank, command.alpha)
    for i in range(vehicle.n_engines):
        plant.thrust_command[i] = command.thrust[i]
    plant.starting = 1 if command.engine_mode == ENGINE_FULL else 0
    for i in range(case.events.n_events):
        if command.request[i] != 0:
            plant.due[i] = plant.t + case.events.events[i].delay
    plant.imagers.camera_trigger, plant.imagers.scan = command.camera_trigger, command.scan
    inflict(kinds, case, command, plant)
    for i in range(vehicle.rcs.n_thrusters):
        # a closed latch valve stops the flow, whatever the thruster's own valve does
        if command.latch_closed[case.branches.of[i]] != 0:
            plant.valves.open_time[i] = plant.valves.close_time[i] = plant.t


@kernel
def begin(fault, index, command, plant):
    """Store the start of ``fault``, number ``index``, in the first base cycle at or after its time."""
    started = plant.t
    if fault.phase >= 0:
        if command.phase < fault.phase:
            return
        if plant.phase_seen[index] == NOT_BEGUN:
            plant.phase_seen[index] = plant.t
        started = plant.t - plant.phase_seen[index]
    if started >= fault.after - 1e-9:
        plant.fault_since[index] = plant.t


@kernel
def inflict(kinds, case, command, plant):
    """Let every fault that has begun act on the commanded actuators."""
    faults = case.faults
    for i in range(faults.count):
        fault = faults.slots[i]
        if plant.fault_since[i] == NOT_BEGUN:
            begin(fault, i, command, plant)
        if plant.fault_since[i] != NOT_BEGUN:
            kinds(fault.params.kind, fault, case, since=plant.fault_since[i], command=command, plant=plant)
