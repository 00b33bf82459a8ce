"""Occlusion of an imager's view by parts that have left the vehicle: discs as large as their drag areas.

The drag area of a backshell or of a canopy is about that of its silhouette (drag coefficients of 1.0 to 1.2,
and 0.62 of a nominal area of which an open canopy shows 0.6). A canopy that went with the part that carries
it hangs its lines' length above that.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from edl6dof.interface.capacities import MAX_PARTS
from edl6dof.kernels import kernel
from edl6dof.records import whole
from edl6dof.sensors.imager import imager_attitude
from edl6dof.spatial.quaternion import from_frame, to_frame
from edl6dof.spatial.vector import add, dot, norm, put3, scale, sub, take3, unit
from edl6dof.vehicle.parachutes.parachute import RELEASED
from edl6dof.vehicle.plant import ATTITUDE, POSITION

#: A disc for each part, and one for what hangs above it.
_MOST = 2 * MAX_PARTS
DISCS = np.dtype(
    [
        ("n", whole(0, _MOST)),
        ("to", "f8", (_MOST, 3)),  # m: from the imager to the middle, along its own axes
        ("radius", "f8", (_MOST,)),  # m
    ],
    align=True,
)


@kernel
def find_discs(case, plant, outputs, position, turn, discs):
    """List the discs of all parts that have left the vehicle, for an imager at ``position`` (m, B) that is
    turned relative to B by ``turn`` (rad, B, small).
    """
    y, spin, chute = plant.y, case.planet.rotation_rate, plant.parachute
    q = (y[ATTITUDE], y[ATTITUDE + 1], y[ATTITUDE + 2], y[ATTITUDE + 3])
    place = add(take3(y, POSITION), from_frame(q, sub(position, take3(outputs.centre, 0))))
    axes = imager_attitude(plant, turn)
    discs.n = 0
    for k in range(case.vehicle.n_parts):
        part, r, v = plant.debris[k], take3(plant.debris[k].r_I, 0), take3(plant.debris[k].v_I, 0)
        if part.active == 0:
            continue
        own, to_part = part.drag_area, sub(r, place)
        if plant.canopy == RELEASED and k == case.suspension[chute].carrier:
            own = min(own, case.vehicle.parts[k].drag_area)
            above = unit((-v[0] - spin * r[1], -v[1] + spin * r[0], -v[2]))
            middle = add(to_part, scale(case.vehicle.parachutes[chute].line_length, above))
            _note(axes, middle, part.drag_area - own, discs)
        _note(axes, to_part, own, discs)


@kernel
def _note(axes, to_middle, area, discs):
    """Add a disc of this area (m2) at a place (m, I, from the imager) for an imager of this attitude."""
    if area > 0.0:
        put3(discs.to[discs.n], 0, to_frame(axes, to_middle))
        discs.radius[discs.n] = sqrt(area / pi)
        discs.n += 1


@kernel
def is_hidden(discs, direction):
    """Test whether a disc lies along ``direction``, a unit vector of the imager's own axes."""
    for k in range(discs.n):
        to = take3(discs.to[k], 0)
        distance, radius = norm(to), discs.radius[k]
        if distance <= radius:
            return True
        share = radius / distance
        if dot(to, direction) >= distance * sqrt(1.0 - share * share):
            return True
    return False
