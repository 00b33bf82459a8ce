"""Guards: whether what the solution says of height and vertical can be true.

Three verdicts, each with a switch.  The height lies below the ground though no footpad touches it; the height
jumps by more than its own uncertainty against the velocity; beams of the radar have an echo although, as the
attitude has it, they look above the horizon.  Against the first two a guard tells the last plausible height,
carried on with the vertical velocity: below the ground for as long as it lasts, after a jump until the new
height has stood for a while.  Against the third it has the vertical recovered.

Source: Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN: a saturated gyro turned the attitude over, a
negative height followed, and the parachute was released in 3.7 km.
"""

from __future__ import annotations

from math import sin

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.jit import kernel
from edl6dof.records import FLAG, whole
from edl6dof.spatial.frames import geodetic, ned_to_fixed
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import dot, take3

#: Verdicts, a bit for each.
BELOW_GROUND, JUMP, ABOVE_HORIZON = 1, 2, 4


class GuardParams(Params):
    """Guards of height and vertical: what is told when they cannot be true."""

    below_ground: bool = param(True, "whether a height below the ground is withheld")
    jump: bool = param(True, "whether a height that contradicts the velocity is withheld")
    vertical: bool = param(True, "whether an echo from above the horizon has the vertical recovered")
    margin_m: float = param(10.0, "how far below the ground, or off, may be", gt=0.0, le=1e4)
    sigmas: float = param(5.0, "how far off it may be besides, in standard deviations", gt=0.0, le=100.0)
    patience_s: float = param(3.0, "how long a height off the expected one is withheld", ge=0.0, le=100.0)
    horizon_deg: float = param(10.0, "least angle of a beam below the horizon", ge=0.0, le=90.0)
    lost_deg: float = param(
        60.0, "standard deviation of an attitude that is found to be wrong", gt=0.0, le=180.0
    )


GUARD = np.dtype(
    [
        ("verdict", whole(0, BELOW_GROUND + JUMP + ABOVE_HORIZON)),  # what cannot be true in this cycle
        ("begun", FLAG),  # whether a height was told
        ("height", "f8"),  # m: told last
        ("sigma", "f8"),  # m: what the filter claimed then
        ("withheld", "f8"),  # s: for how long a height has been withheld
    ],
    align=True,
)


@kernel
def height_and_climb(planet, site, r, v, terrain):
    """Height above the ground (m) that lies ``terrain`` higher than the landing site, its rate (m/s), and the
    unit vector up (I).
    """
    s_lat, c_lat, s_lon, c_lon, altitude = geodetic(planet.equatorial_radius, planet.flattening, r)
    up = ned_to_fixed(s_lat, c_lat, s_lon, c_lon, (0.0, 0.0, -1.0))
    spin = planet.rotation_rate
    return altitude - site.altitude - terrain, dot((v[0] + spin * r[1], v[1] - spin * r[0], v[2]), up), up


@kernel
def guarded_height(params, height, climb, sigma, contact, dt, memory):
    """The height to tell, m, of a cycle of ``dt`` seconds in which the solution says ``height``, ``climb``
    (m/s) and ``sigma`` (m); ``contact``: whether a footpad touches the ground.
    """
    memory.verdict = 0
    expected = memory.height + climb * dt if memory.begun != 0 else height
    off = params.margin + params.sigmas * max(sigma, memory.sigma)
    if height < -params.margin and contact == 0:
        memory.verdict |= BELOW_GROUND
    if abs(height - expected) > off:
        memory.verdict |= JUMP
    below = params.below_ground != 0 and memory.verdict & BELOW_GROUND
    jumped = params.jump != 0 and memory.verdict & JUMP and memory.withheld < params.patience
    if below or jumped:
        memory.withheld += dt
        height = max(expected, 0.0)
    else:
        memory.withheld = 0.0
        memory.sigma = sigma
    memory.begun, memory.height = 1, height
    return height


@kernel
def vertical_is_wrong(params, instruments, radar, q, up):
    """Whether several beams have an echo though the attitude ``q`` has them look less than the least angle
    below the horizon; ``up``: unit vector, I.  One alone may have failed.
    """
    if radar.fresh == 0:
        return False
    least, seen = sin(params.horizon), 0
    for i in range(instruments.n_beams):
        if radar.locked[i] != 0 and -dot(from_frame(q, take3(instruments.beam_axis[i], 0)), up) < least:
            seen += 1
    return seen > 1


@kernel
def guard_vertical(params, instruments, radar, q, up, memory, recovery):
    """Have ``recovery`` (``RECOVERY``) find the vertical again where it is wrong."""
    if not vertical_is_wrong(params, instruments, radar, q, up):
        return
    memory.verdict |= ABOVE_HORIZON
    if params.vertical != 0 and recovery.variance == 0.0:
        recovery.variance = params.lost**2
