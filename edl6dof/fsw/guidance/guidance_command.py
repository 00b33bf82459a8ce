"""The output of guidance to attitude control and engine, and the constraints that powered guidance relaxes.

Where no landing satisfies all constraints, a law relaxes them one after another; the last resort, full thrust
against the velocity, is common to all laws (:mod:`~edl6dof.fsw.guidance.powered.stopping`).
"""

from __future__ import annotations

from edl6dof.interface.effectors import ENGINE_FULL, ENGINE_OFF
from edl6dof.kernels import kernel
from edl6dof.records import FLAG, record, whole

#: The constraints, in the order in which they are relaxed.
CONSTRAINTS = ("throttle dwell", "arrival height", "glide slope", "tilt", "target", "throttle band")
#: Numbers of relaxed constraints, named after the last one.
DWELL, ARRIVAL, GLIDE_SLOPE, TILT, TARGET, EVERYTHING = range(1, len(CONSTRAINTS) + 1)

#: For each number of relaxed constraints: flight time at which it was first relaxed (s; 0: never), and the
#: landing error expected then (m).
RELAXED = record(("t", "f8", (EVERYTHING,)), ("landing_error", "f8", (EVERYTHING,)))


def in_words(relaxed: int) -> str:
    """Describe the action of guidance with the first ``relaxed`` constraints relaxed."""
    if relaxed == EVERYTHING:
        return "braking at full thrust"
    return f"constraints relaxed up to the {CONSTRAINTS[relaxed - 1]}"


@kernel
def note_relaxed(t, goal, memory):
    """Store in a ``RELAXED`` record when the ``GUIDE`` record ``goal`` relaxes constraints; ``t``: flight
    time (s).
    """
    last = goal.relaxed - 1
    if last >= 0 and memory.t[last] == 0.0:
        memory.t[last], memory.landing_error[last] = t, goal.landing_error


#: Output of guidance.
GUIDE = record(
    ("bank", "f8"),  # rad: commanded bank angle, positive right wing down
    ("alpha", "f8"),  # rad: commanded angle of attack, positive nose up
    ("thrust_direction_N", "f8", (3,)),  # 1, N: unit vector of the thrust force, north, east, down
    ("thrust", "f8"),  # N: commanded engine thrust, all engines together
    # of edl6dof.interface.effectors: 0 off, 1 throttled, 2 full level
    ("engine_mode", whole(ENGINE_OFF, ENGINE_FULL)),
    ("full_wanted", FLAG),  # the law asks for full level now
    ("translating", FLAG),  # lateral force is demanded of the horizontal thrusters
    ("force_N", "f8", (2,)),  # N, N: lateral force for the horizontal thrusters, north and east
    ("reference_drag", "f8"),  # m/s2: drag that the entry law tracks, if it tracks one
    ("range_to_go", "f8"),  # m: great circle to the aim point on the equatorial radius
    ("crossrange", "f8"),  # m: of the aim point; positive when the velocity points to the right of it
    ("least_bank", "f8"),  # rad: smallest bank magnitude that entry guidance allows now
    ("side", "f8"),  # side that entry guidance banks to: +1 right, -1 left, 0 before it has begun
    ("downrange_to_go", "f8"),  # m: along the course until the aim point lies abeam; negative beyond it
    ("drag_ratio", "f8"),  # measured over believed drag
    ("drag_trend", "f8"),  # 1/m: change of that ratio with height
    ("lift_ratio", "f8"),  # measured over believed lift-to-drag ratio
    # m/s, N: wind above the expected one, north and east, in predictions of the entry
    ("wind_shift_N", "f8", (2,)),
    ("time_to_go", "f8"),  # s: until the powered target is reached
    ("relaxed", whole(0, EVERYTHING)),  # number of constraints that powered guidance relaxes, in their order
    ("landing_error", "f8"),  # m: expected distance from rest at the target with relaxed constraints
    ("stop_height", "f8"),  # m, above ground: where a stuck throttle brings the lander to rest
    ("spot_chosen", FLAG),  # hazard detection has chosen the spot to land on
    ("surface", "f8"),  # m/s3: sliding surface
    ("virtual", "f8"),  # m/s3: virtual state of saturation
    ("drag_estimate", "f8"),  # m/s2: estimated drag
    ("drag_rate", "f8"),  # m/s3: estimated rate of drag
    ("drag_disturbance", "f8"),  # m/s4: estimated disturbance of the second derivative of drag
    ("path_disturbance", "f8"),  # rad/s: estimated disturbance of the flight-path rate
)
