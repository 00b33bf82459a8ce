"""The record that crosses from the flight software to the plant: what the effectors are told in a base
cycle.
"""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import (
    MAX_BRANCHES,
    MAX_ENGINES,
    MAX_EVENTS,
    MAX_PHASES,
    MAX_THRUSTERS,
)
from edl6dof.interface.engine import ENGINE_FULL, ENGINE_OFF
from edl6dof.records import FLAG, whole

COMMAND = np.dtype(
    [
        ("opens", "f8", (MAX_THRUSTERS,)),  # s, flight time: when the valve of each thruster opens
        ("closes", "f8", (MAX_THRUSTERS,)),  # s, flight time: when it closes; not after it opens for no pulse
        ("request", FLAG, (MAX_EVENTS,)),  # events requested in this cycle, by their numbers
        ("thrust", "f8", (MAX_ENGINES,)),  # N, of each engine
        ("engine_mode", whole(ENGINE_OFF, ENGINE_FULL)),  # of edl6dof.interface.engine, of all engines
        # what a vehicle without attitude dynamics follows
        ("steering", FLAG),  # it is to follow the angles below
        ("bank", "f8"),  # rad, about the air-relative velocity, zero with lift up, positive to the right
        ("alpha", "f8"),  # rad: commanded angle of attack, positive nose up
        ("phase", whole(0, MAX_PHASES - 1, of="phases")),  # present mission phase
        ("shut", FLAG, (MAX_BRANCHES,)),  # propellant branches whose latch valve is shut
        ("expose", FLAG),  # the landing camera takes an image now
        ("scan", FLAG),  # the lidar begins a scan now, and the stereo cameras take a pair of images
    ],
    align=True,
)
