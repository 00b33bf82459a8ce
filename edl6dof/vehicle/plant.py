"""The Plant record: everything about the true vehicle that changes in flight."""

from __future__ import annotations

import numpy as np

from edl6dof.vehicle.mass import BODY
from edl6dof.vehicle.rcs import MAX_THRUSTERS
from edl6dof.vehicle.surroundings import KEPT

#: Layout of the integrated state ``y``.
POSITION, VELOCITY, ATTITUDE, RATE, PROPELLANT, THRUST, HEAT, CANOPY_POSITION, CANOPY_VELOCITY = 0, 3, 6, 10, 13, 14, 15, 16, 19
STATES = 22
STATE_NAMES = (
    *(f"position {c} (I)" for c in "xyz"),
    *(f"velocity {c} (I)" for c in "xyz"),
    *(f"attitude quaternion {c}" for c in "wxyz"),
    *(f"body rate {c}" for c in "pqr"),
    "propellant mass",
    "engine thrust",
    "heat load",
    *(f"canopy position {c} (I)" for c in "xyz"),
    *(f"canopy velocity {c} (I)" for c in "xyz"),
)
#: Components that exist without a free canopy.
STATES_VEHICLE = 16

#: Things that happen once, in the order of the flight; ``due`` holds when.
EVENTS = ("trim_wing", "mortar", "heat_shield", "landing_legs", "backshell", "ignition", "cut_off")
TRIM_WING, MORTAR, HEAT_SHIELD_OFF, LEGS_OUT, BACKSHELL_OFF, IGNITION, CUT_OFF = range(7)

#: How many faults one flight may have, and the time that stands for "not yet".
MAX_FAULTS = 16
NOT_BEGUN = 1e99

VALVES = np.dtype(
    [
        ("opens", "f8", (MAX_THRUSTERS,)),
        ("closes", "f8", (MAX_THRUSTERS,)),
        ("level", "f8", (MAX_THRUSTERS,)),
        ("mean", "f8", (MAX_THRUSTERS,)),  # thrust over steady thrust, mean of the last step
        ("lost", "f8", (MAX_THRUSTERS,)),  # share of the thrust that a fault takes away
        ("fault", "i8", (MAX_THRUSTERS,)),  # which fault each thruster has, 0 for none
    ],
    align=True,
)

#: Quantities evaluated with the derivatives at the last point of the trajectory; sensors and the log read them.
OUTPUT = np.dtype(
    [
        ("altitude", "f8"),
        ("sin_lat", "f8"),
        ("cos_lat", "f8"),
        ("sin_lon", "f8"),
        ("cos_lon", "f8"),
        ("density", "f8"),
        ("pressure", "f8"),
        ("temperature", "f8"),
        ("speed_of_sound", "f8"),
        ("mach", "f8"),
        ("dynamic_pressure", "f8"),
        ("heat_flux", "f8"),
        ("gravity_I", "f8", (3,)),
        ("v_air_B", "f8", (3,)),
        ("v_air_I", "f8", (3,)),
        ("wind_N", "f8", (3,)),
        ("aero_force_B", "f8", (3,)),
        ("aero_moment_B", "f8", (3,)),
        ("load_force_B", "f8", (3,)),  # all but engine and thrusters
        ("load_moment_B", "f8", (3,)),
        ("canopy_acceleration_I", "f8", (3,)),
        ("specific_force_B", "f8", (3,)),
        ("disturbance_moment_B", "f8", (3,)),
        ("riser_tension", "f8"),
        ("engine_thrust", "f8"),
        ("mass", "f8"),
        ("centre", "f8", (3,)),
        ("inertia", "f8", (6,)),
        ("pads", "i8"),
        ("wing_opening", "f8"),
    ],
    align=True,
)

#: A part that has left the vehicle: a point mass with drag.
DEBRIS = np.dtype(
    [
        ("active", "i8"),
        ("mass", "f8"),
        ("drag_area", "f8"),
        ("r_I", "f8", (3,)),
        ("v_I", "f8", (3,)),
        ("a_I", "f8", (3,)),  # of the step before
        ("kept", KEPT),
    ],
    align=True,
)

#: Largest values met since the initial state (:mod:`edl6dof.vehicle.peaks`).
PEAKS = np.dtype([("load", "f8"), ("dynamic_pressure", "f8"), ("heat_flux", "f8"), ("riser_tension", "f8")], align=True)

PLANT = np.dtype(
    [
        ("t", "f8"),
        ("y", "f8", (STATES,)),
        ("attached", "i8", (3,)),
        ("canopy", "i8"),
        ("legs", "i8"),
        ("running", "i8"),
        ("starting", "i8"),
        ("touched", "i8"),
        ("thrust_command", "f8"),
        # of a point mass: bank angle at ``bank_time``, where it is going, angle of attack
        ("bank", "f8"),
        ("bank_time", "f8"),
        ("bank_command", "f8"),
        ("alpha", "f8"),
        ("line_stretch_time", "f8"),
        ("wing_start", "f8"),
        ("wing_lost", "f8"),  # share of the opening that a fault takes away
        ("thrust_lost", "f8"),  # share of the engine's thrust that a fault takes away
        ("thrust_held", "f8"),  # level at which a fault holds the throttle, N
        ("phase_seen", "f8", (MAX_FAULTS,)),  # when each fault's phase was entered
        ("fault_since", "f8", (MAX_FAULTS,)),
        ("touchdown_time", "f8"),
        ("due", "f8", (len(EVENTS),)),
        ("done", "f8", (len(EVENTS),)),
        ("dry", BODY),
        ("valves", VALVES),
        ("velocity_gain", "f8", (3,)),  # integral of the specific force in B, m/s
        ("rcs_force", "f8", (3,)),
        ("rcs_moment", "f8", (3,)),
        ("rcs_flow", "f8"),
        ("latitude", "f8"),
        ("longitude", "f8"),
        ("ground_elevation", "f8"),
        ("ground_slope", "f8", (2,)),
        ("agl", "f8"),
        ("touchdown", "f8", (STATES,)),
        ("peaks", PEAKS),
        ("debris", DEBRIS, (2,)),
        ("out", OUTPUT),
        ("kept", KEPT),
        # whether ``out`` and the ground belong to the present state, so that the next step need not evaluate them
        ("fresh", "i8"),
        # scratch of the integrator
        ("k", "f8", (4, STATES)),
        ("trial", "f8", (STATES,)),
        ("y0", "f8", (STATES,)),
        ("level0", "f8", (MAX_THRUSTERS,)),
        ("velocity_gain0", "f8", (3,)),
    ],
    align=True,
)
