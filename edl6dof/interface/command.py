"""Commands: of the flight software to the effectors, and external ones that replace a part of it.

A program that steps a flight writes ``EXTERNAL`` between two cycles (:mod:`edl6dof.sim.simulation`); the
flight software reads it after the replaced part has run (:mod:`edl6dof.fsw.external`).  It contains nothing
of the true state except what that program writes.
"""

from __future__ import annotations

from edl6dof.interface.capacities import (
    MAX_BRANCHES,
    MAX_ENGINES,
    MAX_EVENTS,
    MAX_PHASES,
    MAX_THRUSTERS,
)
from edl6dof.interface.effectors import ENGINE_FULL, ENGINE_OFF
from edl6dof.records import FLAG, record, whole

COMMAND = record(
    ("valve_open_time", "f8", (MAX_THRUSTERS,)),  # s, flight time, of each thruster
    ("valve_close_time", "f8", (MAX_THRUSTERS,)),  # s, flight time; no pulse if not after the opening
    ("request", FLAG, (MAX_EVENTS,)),  # events requested in this cycle, by their numbers
    ("thrust", "f8", (MAX_ENGINES,)),  # N, of each engine
    ("engine_mode", whole(ENGINE_OFF, ENGINE_FULL)),  # of edl6dof.interface.effectors, of all engines
    # for a vehicle without attitude dynamics
    ("steering", FLAG),  # the angles below are commanded
    ("bank", "f8"),  # rad, about the planet-relative velocity, zero with lift up, positive to the right
    ("alpha", "f8"),  # rad: commanded angle of attack, positive nose up
    ("phase", whole(0, MAX_PHASES - 1, of="phases")),  # present mission phase
    ("latch_closed", FLAG, (MAX_BRANCHES,)),  # the latch valve of each propellant branch is closed
    ("camera_trigger", FLAG),  # the landing camera takes an image now
    ("scan", FLAG),  # the lidar begins a scan now, and the stereo cameras take a pair of images
)


#: Flags of the external commands in force, by name.
GIVEN = record(
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
)

EXTERNAL = record(
    ("given", GIVEN),  # commands in force, each until it is withdrawn
    ("r_I", "f8", (3,)),  # m, I: position of the centre of mass, replaces that of navigation
    ("v_I", "f8", (3,)),  # m/s, I: its inertial velocity
    ("q_I2B", "f8", (4,)),  # attitude of B in I, unit quaternion, scalar first
    ("w_B", "f8", (3,)),  # rad/s, B: rate of B relative to I
    ("height_above_ground", "f8"),  # m: of the centre of mass
    ("coarse_L", "f8", (2,)),  # m: east and north of the landing site, where powered descent is to end
    ("fine_L", "f8", (2,)),  # m: east and north of the landing site, where the lander is to stand
    ("bank", "f8"),  # rad: bank angle, replaces that of entry guidance
    ("bank_rate", "f8"),  # rad/s: rate of the commanded bank angle
    ("thrust_N", "f8", (3,)),  # N, north, east, down: thrust vector, replaces that of powered guidance
    ("throttle", "f8"),  # thrust over full thrust, replaces that of powered guidance
    ("isolated", FLAG, (MAX_THRUSTERS,)),  # thrusters to be taken out of use
    ("torque_B", "f8", (3,)),  # N m, B: replaces that of attitude control
    ("duty", "f8", (MAX_THRUSTERS,)),  # of each thruster, 0..1, replaces that of allocation
)
