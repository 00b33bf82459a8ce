"""Direction of the force that the thrusters do not explain: whether the air meets the vehicle head on.

A body of revolution feels air that meets it along its axis as a force along that axis, whatever the wind; a
force across it shows an angle of attack, or a thruster that fires without a command.  The angle of attack
that navigation works out shows these only as far as the wind is known.

Source: the acceleration ratios technique of entry reconstruction (Withers et al. 2003, Planetary and Space
Science 51, 541-561), without its aerodynamic table.
"""

from __future__ import annotations

from edl6dof.kernels import kernel
from edl6dof.spatial.elementary import exp
from edl6dof.spatial.frames import total_angle_of_attack
from edl6dof.spatial.vector import scale


@kernel
def force_angle(lag, force_B, dt, last):
    """Angle (rad) of ``force_B`` (N) from the -x axis of B, smoothed.

    Args:
        lag: first-order lag, s; outlasts a leak that diagnosis stops.
        force_B: force that the commanded thrusters do not explain, N, B.
        dt: since the last call, s.
        last: what the last call returned, rad.
    """
    return last + (1.0 - exp(-dt / lag)) * (total_angle_of_attack(scale(-1.0, force_B)) - last)
