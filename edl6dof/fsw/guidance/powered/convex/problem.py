"""The convex landing problem of the flight computer, and its solution: the plan.

Least fuel for a point mass that comes to rest at the origin; axes east, north, up.  Lossless convexification:
the thrust acceleration u and its bound s, |u| <= s, low <= s <= high, where low and high are the thrust
limits over the mass along the plan.  Thrust may begin at full level, beyond a gap in what the engine can do;
there low and high are both full thrust over mass.  Sources: Acikmese & Ploen 2007, J. Guidance 30(5);
Acikmese, Carson, Blackmore 2013, IEEE Trans. Control Systems Technology 21(6).
"""

from __future__ import annotations

import numpy as np

from edl6dof.records import COUNT, FLAG

#: Controls of a plan, each held constant.
CONTROLS = 30

LANDING = np.dtype(
    [
        ("mass", "f8"),  # kg
        ("low", "f8"),  # N, least thrust
        ("high", "f8"),  # N, largest thrust
        ("low_now", "f8"),  # N, least and largest thrust in the first seconds
        ("high_now", "f8"),
        ("now", "f8"),  # s, how long they hold
        ("full", "f8"),  # N, thrust of the start
        ("exhaust_speed", "f8"),  # m/s
        ("gravity", "f8"),  # m/s2, downwards
        ("position", "f8", (3,)),  # m, from the landing point
        ("velocity", "f8", (3,)),  # m/s
        ("slope", "f8"),  # tangent of the least angle of the lander over the horizon; negative: none
        ("cos_tilt", "f8"),  # of the largest tilt of thrust
        ("cos_last_tilt", "f8"),  # of that of the last control
        ("miss_price", "f8"),  # 1/s: velocity worth a metre of horizontal miss
    ],
    align=True,
)

PLAN = np.dtype(
    [
        ("time", "f8"),  # s, of flight
        ("full_time", "f8"),  # s of it at full thrust, at the start
        ("u", "f8", (CONTROLS, 3)),  # m/s2
        # the primer vector is primer_end + pull * (time to go)
        ("primer_end", "f8", (3,)),
        ("pull", "f8", (3,)),  # 1/s
        ("glide", "f8", (CONTROLS, 3)),  # multipliers of the glide slope where each control ends
        ("fuel", "f8"),  # kg
        ("cost", "f8"),  # m/s: velocity spent, and the worth of the miss
        ("miss", "f8"),  # m, horizontal, where the landing point cannot be reached
        ("height_error", "f8"),  # m, at the end
        ("end_velocity", "f8", (3,)),  # m/s
        ("change", "f8"),  # of the primer, in the last iteration
        ("iterations", COUNT),  # of the last solution
        ("converged", FLAG),
        # the grid and what an iteration works with
        ("step", "f8", (CONTROLS,)),  # s
        ("to_go", "f8", (CONTROLS,)),  # s, from the middle of each control
        ("slant", "f8", (CONTROLS,)),  # second basis function of the end; the first is constant
        ("mass", "f8", (CONTROLS,)),  # kg, in the middle of each control
        ("w", "f8", (CONTROLS, 3)),  # m/s2, the iterate within its bounds
        ("push", "f8", (CONTROLS, 3)),  # of the glide slope on the primer
        ("row", "f8", (CONTROLS,)),  # factor of the glide slope where each control ends
    ],
    align=True,
)
