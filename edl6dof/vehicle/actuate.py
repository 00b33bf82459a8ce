"""Actuation: commands of the flight software set valves, engines and events; faults act in between."""

from __future__ import annotations

from edl6dof.interface.capacities import (
    MAX_ENGINES,
    MAX_PARACHUTES,
    MAX_SURFACES,
    MAX_TANKS,
    MAX_THRUSTERS,
)
from edl6dof.interface.effectors import ENGINE_FULL
from edl6dof.kernels import kernel
from edl6dof.spatial.random_numbers import uniform
from edl6dof.spatial.table_index import endless_cell
from edl6dof.vehicle.motion.point_mass import POINT_MASS, command_bank
from edl6dof.vehicle.plant import NOT_BEGUN, WORKING


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
            plant.valves.leak[i] = plant.valves.flow_leak[i] = 0.0


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
def is_present(fault, age):
    """Return whether a fault is present ``age`` s after it began.  An intermittent one is present in the
    first of its intervals, and in each other one at random.
    """
    if age >= fault.duration - 1e-9:
        return False
    interval = endless_cell(age / fault.params.interval + 1e-9)
    return interval == 0 or uniform(fault.key, interval) < fault.params.presence


@kernel
def clear_readings(readings):
    """Let all readings be correct."""
    for i in range(readings.shape[0]):
        readings[i].mode = WORKING
        readings[i].offset = readings[i].noise = 0.0


@kernel
def clear_effects(plant):
    """Remove the effects of all faults on the vehicle and its instruments."""
    valves, instruments = plant.valves, plant.instruments
    valves.feed_lost = 0.0
    for i in range(MAX_THRUSTERS):
        valves.fault[i] = 0
        valves.lost[i] = valves.flow_lost[i] = valves.leak[i] = valves.flow_leak[i] = 0.0
        valves.rise[i] = valves.decay[i] = 0.0
    for i in range(MAX_SURFACES):
        plant.wing_lost[i] = 0.0
    for i in range(MAX_ENGINES):
        plant.thrust_lost[i] = plant.thrust_turned[i, 0] = plant.thrust_turned[i, 1] = 0.0
    for i in range(MAX_PARACHUTES):
        plant.canopy_lost[i] = 0.0
    for i in range(MAX_TANKS):
        plant.leak[i], plant.blocked[i] = 0.0, 0
    clear_readings(instruments.gyro)
    clear_readings(instruments.accelerometer)
    clear_readings(instruments.range)
    clear_readings(instruments.speed)
    clear_readings(instruments.flow)
    clear_readings(instruments.stars)
    instruments.camera_lost = instruments.lidar_lost = instruments.stereo_lost = instruments.mirror_stuck = 0
    instruments.landmarks_lost = 0


@kernel
def inflict(kinds, case, command, plant):
    """Let every fault that is present act on the commanded actuators; effects last for one base cycle."""
    faults = case.faults
    if faults.count > 0:
        clear_effects(plant)
    for i in range(faults.count):
        fault = faults.slots[i]
        if plant.fault_since[i] == NOT_BEGUN:
            begin(fault, i, command, plant)
        since = plant.fault_since[i]
        if since != NOT_BEGUN and is_present(fault, plant.t - since):
            kinds(fault.params.kind, fault, case, since=since, command=command, plant=plant)
