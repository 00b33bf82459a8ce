"""Force and torque of each thruster, by numpy, about the centres of mass of the configurations."""

import numpy as np

#: Parts of Tianwen-1 that are gone, a bit for each: heat shield, backshell, parachute pack.
ENTRY, LANDER, UNDER_CHUTE = 0, 0b111, 0b101


def wrenches(thrusters, count, centre):
    """Force and torque columns by numpy, independent of the kernel."""
    force = thrusters["thrust"][:count, None] * thrusters["direction"][:count]
    return np.hstack([force, np.cross(thrusters["position"][:count] - centre, force)]).T
