"""The record by which guidance speaks to attitude control and engine."""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.guidance.powered.relaxation import EVERYTHING
from edl6dof.interface.engine import ENGINE_FULL, ENGINE_OFF
from edl6dof.records import FLAG, whole

GUIDE = np.dtype(
    [
        ("bank", "f8"),  # commanded bank angle, rad
        ("alpha", "f8"),  # commanded angle of attack, rad
        ("thrust_direction_N", "f8", (3,)),  # unit vector, north-east-down
        ("thrust", "f8"),  # demanded engine thrust, N
        ("engine_mode", whole(ENGINE_OFF, ENGINE_FULL)),
        ("full_wanted", FLAG),  # the law asks for full level now
        ("translating", FLAG),  # lateral force is demanded of the horizontal thrusters
        ("force_N", "f8", (2,)),  # that force, north and east, N
        ("reference_drag", "f8"),
        ("range_to_go", "f8"),
        ("crossrange", "f8"),
        ("least_bank", "f8"),  # smallest bank magnitude that entry guidance allows now, rad
        ("side", "f8"),  # that entry guidance banks to: +1 right, -1 left, 0 before it has begun
        ("downrange_to_go", "f8"),  # along the course until the aim point lies abeam, m
        ("drag_ratio", "f8"),  # measured over believed drag
        ("drag_trend", "f8"),  # of it with height, 1/m
        ("lift_ratio", "f8"),  # measured over believed lift-to-drag ratio
        ("time_to_go", "f8"),
        ("relaxed", whole(0, EVERYTHING)),  # how many constraints powered guidance gives up, in their order
        ("landing_error", "f8"),  # m: how far from rest at the target it then expects to end
        ("stop_height", "f8"),  # m, above ground: where a thrust that is held brings the lander to rest
        ("spot_chosen", FLAG),  # the spot to land on, by hazard detection
        # inner quantities of the laws that have them
        ("surface", "f8"),  # sliding surface, m/s3
        ("virtual", "f8"),  # virtual state of saturation, m/s3
        ("drag_estimate", "f8"),  # drag acceleration, m/s2
        ("drag_rate", "f8"),  # and its rate, m/s3
        ("drag_disturbance", "f8"),  # estimated disturbance of the second derivative of drag, m/s4
        ("path_disturbance", "f8"),  # estimated disturbance of the flight-path rate, rad/s
    ],
    align=True,
)
