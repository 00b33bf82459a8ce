"""What the eyes have in common: the copy that flies looks along directions turned by a small rotation from
those that the flight computer believes; and the ground that one sees is laid where its middle looks.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Hardware, param
from edl6dof.config.dtype import in_si
from edl6dof.kernels import kernel
from edl6dof.sensors.patch import LEVEL, clear, lay_patch
from edl6dof.spatial.stream import Stream
from edl6dof.vehicle.aerodynamics.shape import CONFIG_CAPSULE


class EyeParams(Hardware):
    """An eye."""

    misalignment_deg: float = param(
        0.02,
        "error of its direction about each axis, drawn for each case",
        status="estimate",
        ge=0.0,
        le=10.0,
    )


#: The copy that flies: its turn, a small rotation in B (rad); constant error of its ranges (m); key of its
#: noise.
EYE_UNIT = np.dtype([("turn", "f8", (3,)), ("bias", "f8"), ("key", "i8")], align=True)


def draw_eye(params: EyeParams, rng: Stream, unit: np.void) -> None:
    """Draw the turn of the copy that flies, and the key of its noise."""
    unit["turn"] = in_si(params)["misalignment"] * rng.standard_normal(3)
    unit["key"] = rng.keys()


@kernel
def reach_of(params, plant):
    """How far (m) an eye sees: nowhere through the heat shield."""
    return params.longest if plant.shape != CONFIG_CAPSULE else 0.0


@kernel
def lay_in_view(case, tables, origin, axes, height, reach, patch):
    """Tabulate the ground around the point that a camera or lidar looks at, if it is within ``reach`` (m);
    ``origin``, ``axes`` and ``height`` are those of :func:`~edl6dof.sensors.sight.sight`.
    """
    ahead = axes[0]
    way = height / max(-ahead[2], LEVEL)
    if way <= reach:
        lay_patch(case, tables, origin[0] + way * ahead[0], origin[1] + way * ahead[1], patch)
    else:
        clear(patch)
