"""How much more drag and lift than believed is measured: one number each, low-pass filtered, for every law
that predicts.

The believed drag is that in the expected mean wind, through which a prediction flies as well.  The
accelerometer feels density, mass, unexpected wind and aerodynamic errors together; so does the trajectory,
and the ratio of measured to believed drag carries them into a prediction without telling them apart.  Source:
the density and lift-to-drag estimates of fully numerical entry guidance (Lu 2014, section V.C; Brunner & Lu
2008, eqs. 33-34), first-order fading-memory filters.
"""

from __future__ import annotations

from math import exp

import numpy as np

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.prediction.airframe import believed_aero
from edl6dof.fsw.navigation.derived import expected_wind, model_atmosphere
from edl6dof.jit import kernel
from edl6dof.spatial.vector import clamp


class AirDataParams(Params):
    """Filtered ratio of measured to believed drag, and of measured to believed lift-to-drag ratio."""

    time_constant_s: float = param(8.0, "memory of the filters", gt=0.0, le=1000.0)
    least_drag_m_s2: float = param(0.5, "drag below which nothing is learnt", gt=0.0)
    limit: float = param(0.5, "largest deviation of a ratio from one", gt=0.0, lt=1.0)


AIR_DATA = np.dtype([("drag", "f8"), ("lift", "f8"), ("t", "f8")], align=True)


@kernel
def measure_air(onboard, nav, memory):
    """Update ``memory`` (``AIR_DATA``) with this cycle's accelerometer reading."""
    p = onboard.guidance.entry.air_data
    if memory.drag == 0.0:
        memory.drag, memory.lift, memory.t = 1.0, 1.0, nav.t
    density, _, _ = model_atmosphere(onboard.atmosphere, nav.altitude)
    area, lift_to_drag = believed_aero(onboard.vehicle, nav.mach, nav.speed)
    to_north, to_east = expected_wind(onboard.atmosphere, nav.altitude)
    north, east, down = nav.v_N[0] - to_north, nav.v_N[1] - to_east, nav.v_N[2]
    believed = 0.5 * density * (north * north + east * east + down * down) * area / onboard.vehicle.entry_mass
    share = 1.0 - exp(-max(nav.t - memory.t, 0.0) / p.time_constant)
    memory.t = nav.t
    if nav.drag < p.least_drag or believed < p.least_drag:
        return
    memory.drag += share * (clamp(nav.drag / believed, 1.0 - p.limit, 1.0 + p.limit) - memory.drag)
    if lift_to_drag > 0.0:
        ratio = nav.lift / nav.drag / lift_to_drag
        memory.lift += share * (clamp(ratio, 1.0 - p.limit, 1.0 + p.limit) - memory.lift)
