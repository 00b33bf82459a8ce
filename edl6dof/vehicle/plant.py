"""The records of the true vehicle in flight: its state, the quantities that follow from the state, the
integrator's scratch, and the largest loads.

Kernels call the ``STATE`` record ``plant``, the ``OUTPUTS`` record ``outputs``, the ``WORKSPACE`` ``work``.
"""

from __future__ import annotations

from edl6dof.interface.capacities import (
    MAX_ACCELEROMETERS,
    MAX_BEAMS,
    MAX_BRANCHES,
    MAX_CONTACTS,
    MAX_ENGINES,
    MAX_EVENTS,
    MAX_FAULTS,
    MAX_FOOTPADS,
    MAX_GYROS,
    MAX_PARACHUTES,
    MAX_PARTS,
    MAX_SURFACES,
    MAX_TANKS,
    MAX_THRUSTERS,
    MAX_TRACKERS,
)
from edl6dof.interface.effectors import THRUSTER_FAILURES
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, TIME_IF_EVER, record, whole
from edl6dof.vehicle.mass import BODY, SHAPES
from edl6dof.vehicle.parachutes.parachute import BY_STRETCH, PACKED, RELEASED, SLACK

#: Modes of a reading: correct; stuck at the last one before the fault; at the end of the range without the
#: flag of saturation; none; at the end of the range with that flag; of something other than the ground.
WORKING, STUCK, HARDOVER, OUTAGE, SATURATED, FALSE_LOCK = range(6)

#: One reading, in its own unit: rad/s of a gyro, m/s2 of an accelerometer, m and m/s of a beam, rad of a star
#: tracker, kg/s of a flow meter.
READING_FAULT = record(
    ("mode", whole(0, FALSE_LOCK)),
    ("offset", "f8"),  # added to the reading; the reading itself at a false lock
    ("noise", "f8"),  # standard deviation of the noise added to the reading
)

#: Commands to camera, lidar and stereo cameras in this cycle.
IMAGER_COMMANDS = record(("camera_trigger", FLAG), ("scan", FLAG))

#: Effect of the faults of instruments; faults write it, sensors read it.
INSTRUMENT_FAULTS = record(
    ("gyro", READING_FAULT, (MAX_GYROS,)),
    ("accelerometer", READING_FAULT, (MAX_ACCELEROMETERS,)),
    ("range", READING_FAULT, (MAX_BEAMS,)),
    ("speed", READING_FAULT, (MAX_BEAMS,)),
    ("flow", READING_FAULT, (MAX_BRANCHES,)),
    ("stars", READING_FAULT, (MAX_TRACKERS,)),
    ("camera_lost", FLAG),
    ("lidar_lost", FLAG),
    ("stereo_lost", FLAG),
    ("landmarks_lost", FLAG),
    ("mirror_stuck", FLAG),  # that of the lidar, which turns the fan of rays from row to row
)


#: Layout of the integrated state ``y``.
POSITION, VELOCITY, ATTITUDE, RATE, HEAT, PROPELLANT = 0, 3, 6, 10, 13, 14
#: Components that exist without a free canopy: propellant of each tank, and thrust of each engine last.
THRUST = PROPELLANT + MAX_TANKS
STATES_VEHICLE = THRUST + MAX_ENGINES
CANOPY_POSITION = STATES_VEHICLE
CANOPY_VELOCITY = CANOPY_POSITION + 3
STATES = CANOPY_VELOCITY + 3
STATE_NAMES = (
    *(f"position {c} (I)" for c in "xyz"),
    *(f"velocity {c} (I)" for c in "xyz"),
    *(f"attitude quaternion {c}" for c in "wxyz"),
    *(f"body rate {c}" for c in "pqr"),
    "heat load",
    *(f"propellant in tank {k}" for k in range(MAX_TANKS)),
    *(f"thrust of engine {k}" for k in range(MAX_ENGINES)),
    *(f"canopy position {c} (I)" for c in "xyz"),
    *(f"canopy velocity {c} (I)" for c in "xyz"),
)


@kernel
def take_attitude(y):
    """``q_I2B`` in the integrated state, as a tuple."""
    return y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3]


#: Value of the time at which a fault began, until it begins.
NOT_BEGUN = 1e99

VALVES = record(
    ("open_time", "f8", (MAX_THRUSTERS,)),
    ("close_time", "f8", (MAX_THRUSTERS,)),
    ("level", "f8", (MAX_THRUSTERS,)),
    ("mean", "f8", (MAX_THRUSTERS,)),  # thrust over steady thrust, mean of the last step
    ("lost", "f8", (MAX_THRUSTERS,)),  # share of the thrust that a fault takes away
    ("flow_lost", "f8", (MAX_THRUSTERS,)),  # share of the propellant flow lost
    ("feed_lost", "f8"),  # share of thrust and flow that all thrusters lose with their feed
    ("leak", "f8", (MAX_THRUSTERS,)),  # share of the thrust that a shut valve lets through
    ("flow_leak", "f8", (MAX_THRUSTERS,)),  # share of the propellant flow that it lets through
    ("rise", "f8", (MAX_THRUSTERS,)),  # s: that of a slow valve; 0: as built
    ("decay", "f8", (MAX_THRUSTERS,)),  # s
    # how each thruster fails, 0 for one that works
    ("fault", whole(0, len(THRUSTER_FAILURES)), (MAX_THRUSTERS,)),
)

#: Quantities that follow from the state, evaluated with the derivatives, each after those that it follows
#: from: sensors, telemetry and figures read them.
OUTPUTS = record(
    ("sin_lat", "f8"),
    ("cos_lat", "f8"),
    ("sin_lon", "f8"),
    ("cos_lon", "f8"),
    ("altitude", "f8"),  # above the ellipsoid
    ("height_above_areoid", "f8"),
    ("density", "f8"),
    ("pressure", "f8"),
    ("temperature", "f8"),
    ("speed_of_sound", "f8"),
    ("wind_N", "f8", (3,)),
    ("v_air_I", "f8", (3,)),
    ("q_I2B", "f8", (4,)),
    ("v_air_B", "f8", (3,)),
    ("mass", "f8"),
    ("centre", "f8", (3,)),
    ("inertia", "f8", (6,)),
    ("mach", "f8"),
    ("dynamic_pressure", "f8"),
    ("heat_flux", "f8"),  # convective and radiative
    ("radiative_heat_flux", "f8"),
    ("wing_opening", "f8"),  # smallest of the surfaces commanded to open
    ("aero_force_B", "f8", (3,)),
    ("aero_moment_B", "f8", (3,)),
    ("riser_tension", "f8"),
    ("riser_margin", "f8"),  # m: positive while it is taut
    ("canopy_acceleration_I", "f8", (3,)),  # without gravitation
    ("canopy_weight", "f8"),  # factor on gravitation due to its apparent mass
    ("pads", whole(0, MAX_FOOTPADS)),
    ("load_force_B", "f8", (3,)),  # of all but engine and thrusters
    ("load_moment_B", "f8", (3,)),
    ("engine_thrust", "f8"),
    ("gravity_I", "f8", (3,)),
    ("specific_force_B", "f8", (3,)),
    ("disturbance_moment_B", "f8", (3,)),
    ("latitude", "f8"),
    ("longitude", "f8"),
    ("elevation", "f8"),  # of the ground, above the areoid
    ("height", "f8"),  # above the ground
)

#: States of a part that has left the vehicle: separated in this step, at rest on the ground, falling.
LOOSE, RESTING, FALLING = 1, 2, 3
#: A part that has left the vehicle: a point mass with drag.
DEBRIS = record(
    ("active", whole(0, FALLING)),
    ("mass", "f8"),
    ("drag_area", "f8"),
    ("r_I", "f8", (3,)),
    ("v_I", "f8", (3,)),
    ("a_I", "f8", (3,)),  # of the step before
)

#: Largest values met since the initial state (:mod:`edl6dof.vehicle.motion.balance`).
PEAKS = record(
    ("entry_load", "f8"),  # up to the first deployment of a parachute
    ("entry_load_time", "f8"),
    ("parachute_load", "f8"),  # while a parachute is out
    ("dynamic_pressure", "f8"),
    ("dynamic_pressure_time", "f8"),
    ("heat_flux", "f8"),
    ("heat_flux_time", "f8"),
    ("radiative_heat_flux", "f8"),
    ("riser_tension", "f8"),
)

#: Start of a flight, and the sums of momentum, energy and mass gained and lost since then
#: (:mod:`edl6dof.vehicle.motion.balance`).
BALANCE = record(
    # at the start, t = 0
    ("mass", "f8"),
    ("r_I", "f8", (3,)),
    ("v_I", "f8", (3,)),
    # since then
    ("velocity", "f8", (3,)),  # m/s, I: gained by forces and separations
    ("separations", "f8"),  # m/s: momentum per mass missing after separations, sum of magnitudes
    ("work", "f8"),  # J/kg: of all forces but gravitation
    ("lost", "f8"),  # kg: propellant used, and parts that have left
)

#: Inputs of the derivative in addition to time and state, set for a step
#: (:mod:`edl6dof.vehicle.motion.runge_kutta`); sensors read the thruster loads of the last step.
INPUTS = record(
    ("middle", "f8"),  # s: time of the middle of the step
    ("rcs_force", "f8", (3,)),  # N, B: mean over the step, in vacuum
    ("rcs_moment", "f8", (3,)),  # N m, B, about its origin
    ("rcs_force_slope", "f8", (3,)),  # N/s, about the middle of the step; 0 after the step
    ("rcs_moment_slope", "f8", (3,)),  # N m/s
    ("rcs_flow", "f8", (MAX_TANKS,)),  # kg/s, out of each tank: mean over the step
    ("rcs_flow_slope", "f8", (MAX_TANKS,)),  # kg/s2
    ("thrust_goal", "f8", (MAX_ENGINES,)),  # N: goal of each engine's thrust, mean over the step
    (
        "thrust_goal_slope",
        "f8",
        (MAX_ENGINES,),
    ),  # N/s: slope of the goal, about the middle of the step
    ("filled", FLAG, (MAX_TANKS,)),  # whether each tank has propellant to give
    ("riser", whole(BY_STRETCH, SLACK)),  # held in one state during a step
    ("noncentral_I", "f8", (3,)),  # m/s2, I: noncentral part of gravitation
    ("areoid", "f8", (4,)),  # plane of its height (m) above the ellipsoid: slope (F), constant
    ("ground_altitude", "f8"),  # m above the ellipsoid: the plane of the ground
    ("ground_slope", "f8", (2,)),  # rise of that plane per metre towards north and east
    # planes under each point of the landing gear: altitude (m) below the centre of mass, rises per metre
    ("footing", "f8", (MAX_CONTACTS, 3)),
)

#: All that changes in flight and does not follow from anything else: the start of the next step, and the part
#: of a checkpoint that is the vehicle.
STATE = record(
    ("t", "f8"),
    ("y", "f8", (STATES,)),  # integrated state
    ("attached", FLAG, (MAX_PARTS,)),
    ("parachute", whole(0, MAX_PARACHUTES - 1)),  # the one deployed last
    ("canopy", whole(PACKED, RELEASED)),  # state of that canopy
    ("legs", FLAG),
    ("running", FLAG, (MAX_ENGINES,)),
    ("starting", FLAG),
    ("touched", FLAG),
    ("thrust_command", "f8", (MAX_ENGINES,)),
    # of a point mass, rad: bank angle at ``bank_time``, commanded bank angle, angle of attack
    ("bank", "f8"),
    ("bank_time", "f8"),
    ("bank_command", "f8"),
    ("alpha", "f8"),
    ("line_stretch_time", TIME_IF_EVER, (MAX_PARACHUTES,)),
    ("wing_start", "f8", (MAX_SURFACES,)),
    ("wing_lost", "f8", (MAX_SURFACES,)),  # share of the opening that a fault takes away
    ("thrust_lost", "f8", (MAX_ENGINES,)),  # share of the thrust that a fault takes away
    ("thrust_held", "f8", (MAX_ENGINES,)),  # level at which a fault holds the throttle, N
    ("thrust_turned", "f8", (MAX_ENGINES, 2)),  # rad: by how much a fault turns it about y and z of B
    ("canopy_lost", "f8", (MAX_PARACHUTES,)),  # share of the drag area that a fault takes away
    ("leak", "f8", (MAX_TANKS,)),  # kg/s, leak of each tank by a fault
    ("blocked", FLAG, (MAX_TANKS,)),  # tanks whose feed a fault has shut
    ("phase_seen", "f8", (MAX_FAULTS,)),  # when each fault's phase was entered
    ("fault_since", "f8", (MAX_FAULTS,)),
    ("touchdown_time", TIME_IF_EVER),
    ("moved_time", "f8"),  # s: last time at which the vehicle moved over the ground
    ("exhausted_time", TIME_IF_EVER, (MAX_TANKS,)),  # when each tank ran empty
    ("due", "f8", (MAX_EVENTS,)),  # s: when each event is to happen
    ("done", TIME_IF_EVER, (MAX_EVENTS,)),  # s: when each event happened
    ("dry", BODY),  # of the lander and the attached parts
    ("shape", whole(0, len(SHAPES) - 1)),  # shape in the flow
    ("valves", VALVES),
    ("inputs", INPUTS),
    ("velocity_gain", "f8", (3,)),  # integral of the specific force in B, m/s
    ("separation_gain", "f8", (3,)),  # m/s, B: jumps of it by separations and mortars
    ("branch_used", "f8", (MAX_BRANCHES,)),  # kg, propellant that went through each branch
    ("touchdown", "f8", (STATES,)),
    ("debris", DEBRIS, (MAX_PARTS,)),  # by the numbers of the parts
    ("instruments", INSTRUMENT_FAULTS),  # effects of faults on them
    ("balance", BALANCE),
    ("imagers", IMAGER_COMMANDS),  # to landing camera, lidar and stereo cameras
)

#: Scratch of the integrator: never saved, and not used after the step that wrote it, except to find the
#: reason why a step failed.
WORKSPACE = record(
    ("stage", "f8", (STATES,)),  # a stage of the integrator
    ("k", "f8", (4, STATES)),  # derivatives in its stages
    # at the start of the step
    ("t0", "f8"),
    ("y0", "f8", (STATES,)),
    ("level0", "f8", (MAX_THRUSTERS,)),
    ("velocity_gain0", "f8", (3,)),
    ("branch_used0", "f8", (MAX_BRANCHES,)),
    ("t_failed", "f8"),  # end of a step that failed
    ("thrust", "f8", (MAX_ENGINES,)),  # N: of each engine, mean of the step
    # contributions of the step to the balance, by the names of ``BALANCE``
    ("velocity", "f8", (3,)),
    ("work", "f8"),
    ("lost", "f8"),
)
