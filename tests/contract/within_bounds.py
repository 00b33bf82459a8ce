"""Kernels that index tables, memories and rings, for a process in which numba's bounds check is on:
``onboard`` or ``world``, as its argument says.

The records come from the standard input: to make them, all that plans an entry would be compiled with the
check.
"""

import pickle
import sys

import numpy as np

from edl6dof.config.dtype import in_si
from edl6dof.environment.atmosphere import air
from edl6dof.environment.terrain import ground
from edl6dof.environment.wind import wind
from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS, update_effectiveness
from edl6dof.fsw.allocation.registry import ALLOCATION, ALLOCATORS, DEMAND, share_out
from edl6dof.fsw.diagnosis.diagnose import DiagnosisParams
from edl6dof.fsw.diagnosis.residual import DELAY, ORDER, RESIDUAL, add_signature, whiten
from edl6dof.fsw.estimation.registry import ACTIVITY
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.guidance.entry.drag_velocity import profile_range
from edl6dof.fsw.guidance.entry.laws.etpc import at_speed
from edl6dof.fsw.guidance.entry.range_update import range_scale
from edl6dof.fsw.guidance.entry.reference import node_of
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.sensed import SENSED
from edl6dof.sensors.imu import DEPTH, READINGS, ImuParams, measure
from edl6dof.vehicle.aerodynamics.capsule import capsule_coefficients

ANY = (np.nan, np.inf, -np.inf, 1e300, -1e300, 9.3e18, -9.3e18, 5e-324, -1.0, 0.0)


def world(case, tables, x):
    """What the tables of the world hold, each with the words in which a number enters it."""
    gas = case["planet"]["gas"]
    return {
        "air": air(case["atmosphere"], gas, tables["atmosphere"], x)[0],
        "wind": wind(case["wind"], tables["atmosphere"], x)[0],
        "ground, latitude": ground(case["terrain"], tables["terrain"], x, 1.0)[0],
        "ground, longitude": ground(case["terrain"], tables["terrain"], 0.4, x)[0],
    }


def flown_by(case, tables, onboard, x):
    """The same of the vehicle and of its flight computer."""
    capsule, gas = case["vehicle"]["aero"]["capsule"], case["planet"]["gas"]
    return {
        "aerodynamics, Mach": capsule_coefficients(capsule, tables["aero"], gas, x, 1e-3, 0.2)[0],
        "aerodynamics, angle": capsule_coefficients(capsule, tables["aero"], gas, 5.0, 1e-3, x)[0],
        "model atmosphere": model_atmosphere(onboard["atmosphere"], x)[0],
        "airframe": believed_aero(onboard["vehicle"], x, 1e9)[0],
        "reference": node_of(onboard["reference"], x)[1],
        "range scale": x + range_scale(onboard["reference"], x, 1e5, 0.0, 0.4),
        "influence": at_speed(onboard["plan"]["etpc"], x)[1],
        "profile": profile_range(onboard["plan"]["adaptive_hinf"], x),
    }


def rings(case, tables, plant, outputs):
    """Readings under way with the longest delay, and the rings of the residual, for more than a turn."""
    readings, sensed = np.zeros(1, READINGS)[0], np.zeros(1, SENSED)[0]
    params = in_si(ImuParams(delay_cycles=DEPTH - 1))
    for _ in range(2 * DEPTH + 1):
        measure(params, params, case, tables, plant, outputs, readings, sensed)
    memory, activity = np.zeros(1, RESIDUAL)[0], np.zeros(1, ACTIVITY)[0]
    turns = 2 * (DELAY + ORDER + 1) + 1
    for _ in range(turns):
        whiten(in_si(DiagnosisParams()), np.ones(6), activity, MAX_THRUSTERS, memory)
        add_signature(MAX_THRUSTERS - 1, np.ones(6), memory)
    assert (readings["taken"], memory["taken"]) == (2 * DEPTH + 1, turns)


def allocation(onboard):
    """Demands of any size on the table of thrusters, any one of which is dead."""
    vehicle, params = onboard["vehicle"], onboard["allocation"]
    effectiveness, rng = np.zeros(1, EFFECTIVENESS)[0], np.random.default_rng(1)
    update_effectiveness(vehicle, 0b111, np.zeros(MAX_THRUSTERS), effectiveness)
    count = int(vehicle["n_thrusters"])
    for dead in range(count):
        found, demand, healthy = np.zeros(1, ALLOCATION)[0], np.zeros(1, DEMAND)[0], np.ones(32, "i8")
        healthy[dead], demand["groups"], demand["translating"] = 0, 0b1111, dead % 2
        demand["wrench"] = rng.normal(size=6) * 10.0 ** rng.uniform(0.0, 3.3)
        given = params, params, vehicle, healthy, effectiveness, demand
        method = ALLOCATORS.names.index("table")
        share_out(method, *given, found["method"], found["duty"], found["unallocated"])
        assert np.any(found["duty"] > 0.0)


def main():
    records = pickle.load(sys.stdin.buffer)
    of_the_world = sys.argv[1] == "world"
    for (case,), (shared,), (onboard,), _, _ in records:
        for x in ANY:
            found = world(case, shared, x) if of_the_world else flown_by(case, shared, onboard, x)
            assert not np.isnan(x) or all(np.isnan(value) for value in found.values()), found
    if not of_the_world:
        case, shared, onboard, plant, outputs = (one[0] for one in records[0])
        rings(case, shared, plant, outputs)
        allocation(onboard)
    print("kept within bounds")


main()
