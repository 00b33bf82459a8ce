"""Newtonian and free-molecular flow on flat panels: coefficients of a closed surface of triangles.

What faces the flow is seen by it (n.v > 0), whatever stands before it: right for a convex body.  Of one that
is not, a part in the shadow of another is counted as though nothing shaded it (:func:`hull_share`).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from edl6dof.spatial.arrays import lengths, product


class Panels(NamedTuple):
    """Triangles in B: centres (m), outward unit normals, and areas (m2); shapes (n, 3), (n, 3), (n,)."""

    centre: np.ndarray
    normal: np.ndarray
    area: np.ndarray


class References(NamedTuple):
    """What makes coefficients of forces and moments: area (m2), lengths of roll, pitch and yaw (m), and the
    point in B that moments are about.
    """

    area: float
    lengths: np.ndarray
    point: np.ndarray


#: Largest net area of a surface that counts as closed, and least volume that counts as one, as a share.
_CLOSED = 2e-3


def panels_of(corners: np.ndarray) -> Panels:
    """Panels of triangles [triangle, corner, xyz] in B, turned outwards; triangles without area are left out.

    Raises:
        ValueError: they do not close, so that pressure has no resultant.
    """
    twice = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = lengths(twice)
    kept = size > 1e-14 * max(float(size.max()), 1e-300)
    twice, size, corners = twice[kept], size[kept], corners[kept]
    centre, area = corners.mean(axis=1), 0.5 * size
    total = float(area.sum())
    open_share = float(lengths(0.5 * twice.sum(axis=0))) / total if total else 1.0
    if open_share > _CLOSED:
        raise ValueError(
            "the mesh is not closed, or its triangles do not all turn one way round: "
            f"{100.0 * open_share:.2g} % of its area is not met by the rest"
        )
    volume = float(np.sum((centre - centre.mean(axis=0)) * (0.5 * twice))) / 3.0
    if abs(volume) < 1e-9 * total * sqrt(total):
        raise ValueError("the mesh encloses no volume")
    return Panels(centre, np.sign(volume) * twice / size[:, None], area)


def hull_share(panels: Panels, corners: np.ndarray) -> float:
    """Volume of the body over that of its convex hull: 1 for a convex one, whose panels shade no other."""
    from scipy.spatial import ConvexHull  # here: no flight needs it

    volume = np.sum((panels.centre - panels.centre.mean(axis=0)) * panels.normal * panels.area[:, None]) / 3.0
    return float(volume / ConvexHull(corners.reshape(-1, 3)).volume)


def integrals(panels: Panels, directions: np.ndarray, to: References) -> tuple[np.ndarray, ...]:
    """Coefficients [direction, (CX, CY, CZ, Cl, Cm, Cn)] of three flows.

    Args:
        panels: the surface.
        directions: unit vectors of the body's velocity through the air in B, shape (n, 3).
        to: references of the coefficients.

    Returns:
        Newtonian pressure (n.v)^2 on what the flow sees; a pressure coefficient of one there; and
        free-molecular flow, hyperthermal and diffuse from a cold wall: 2 against the velocity per projected
        area.
    """
    arm = panels.centre - to.point
    turning = np.cross(arm, panels.normal)
    facing = np.maximum(product(directions, panels.normal.T), 0.0)
    seen = (facing > 0.0) * panels.area
    pressure, shadow = facing * facing * panels.area, facing * panels.area
    newton, wet = (
        _coefficients(product(-w, panels.normal), product(-w, turning), to) for w in (pressure, seen)
    )
    met = shadow.sum(axis=1)[:, None]
    rare = _coefficients(-2.0 * met * directions, -2.0 * np.cross(product(shadow, arm), directions), to)
    return newton, wet, rare


def _coefficients(force: np.ndarray, moment: np.ndarray, to: References) -> np.ndarray:
    return np.concatenate((force, moment / to.lengths), axis=1) / to.area
