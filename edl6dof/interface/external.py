"""The record by which a flight is commanded from outside: what stands in the place of what a part of the
flight software works out.

Whoever steps a flight writes it between two cycles (:mod:`edl6dof.sim.simulation`); the flight software reads
it after the part in question has run (:mod:`edl6dof.fsw.external`).  Nothing of the true state is in it but
what its writer puts there.
"""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.records import FLAG

#: Which commands are given, by the name of each.
GIVEN = np.dtype(
    [
        ("estimate", FLAG),  # r_I, v_I, q_I2B, w_B, height_above_ground
        ("coarse_spot", FLAG),  # coarse_L
        ("safe_spot", FLAG),  # fine_L
        ("bank", FLAG),  # bank
        ("bank_rate", FLAG),  # bank_rate
        ("thrust", FLAG),  # thrust_N
        ("throttle", FLAG),  # throttle
        ("isolate", FLAG),  # isolated
        ("torque", FLAG),  # torque_B
        ("duties", FLAG),  # duty
    ],
    align=True,
)

EXTERNAL = np.dtype(
    [
        ("given", GIVEN),  # which of the following count; each until it is taken back
        ("r_I", "f8", (3,)),  # m, I: position of the centre of mass, in the place of navigation's
        ("v_I", "f8", (3,)),  # m/s, I: its inertial velocity
        ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
        ("w_B", "f8", (3,)),  # rad/s, B: rate of B relative to I
        ("height_above_ground", "f8"),  # m: of the centre of mass
        ("coarse_L", "f8", (2,)),  # m: east and north of the landing site, where powered descent is to end
        ("fine_L", "f8", (2,)),  # m: east and north of the landing site, where the lander is to stand
        ("bank", "f8"),  # rad: bank angle, in the place of entry guidance's
        ("bank_rate", "f8"),  # rad/s: rate of the commanded bank angle
        ("thrust_N", "f8", (3,)),  # N, north, east, down: thrust vector, in the place of powered guidance's
        ("throttle", "f8"),  # thrust over full thrust, in the place of powered guidance's
        ("isolated", FLAG, (MAX_THRUSTERS,)),  # thrusters to be used no more
        ("torque_B", "f8", (3,)),  # N m, B: in the place of attitude control's
        ("duty", "f8", (MAX_THRUSTERS,)),  # of each thruster, 0..1, in the place of allocation's
    ],
    align=True,
)
