"""Newtonian and free-molecular coefficients: integrals over the surface of a capsule of one or two cones, and
over a closed surface of triangles.

The capsule is a convex body of revolution, so the only shadowing is n.v < 0, and the integrals over the
azimuth are closed form: with flow direction (cos a, 0, sin a) and normal (nx, nr cos phi), n.v = nx cos a +
nr sin a cos phi, positive for |phi| < phi0.

On a surface of triangles every panel with n.v > 0 counts as windward, which is exact for a convex body.  A
body that is not convex has windward panels in the shadow of others; the shadow is left out
(:func:`hull_share`).
"""

from __future__ import annotations

from math import pi, radians, sqrt
from typing import NamedTuple

import numpy as np

from edl6dof.config.base import stated
from edl6dof.spatial import arrays
from edl6dof.spatial.arrays import lengths, product
from edl6dof.spatial.elementary import cos, hypot, pow, sin, tan
from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams

BASE_SUCTION = 0.2  # [E] mean base pressure coefficient of a bluff body at Mach 0


class Rings(NamedTuple):
    """Surface of revolution: station and radius (m), outward normal (axial, radial), weight = radius x
    meridian length (m2).
    """

    x: np.ndarray
    r: np.ndarray
    nx: np.ndarray
    nr: np.ndarray
    weight: np.ndarray


def stagnation_pressure_coefficient(mach: np.ndarray, heat_capacity_ratio: float) -> np.ndarray:
    """Return the stagnation pressure coefficient Cp_max of the Newtonian integral at each Mach number, with
    the shape of ``mach``; ``heat_capacity_ratio``: ratio of specific heats behind the shock.

    Supersonic: Rayleigh's pitot formula. Subsonic: isentropic stagnation pressure plus a base suction (0.2 at
    rest, decreasing to 0 at Mach 1) that stands for the wake, which the Newtonian integral leaves out [E].

    One ratio stands for the whole shock layer. In carbon dioxide 1.33 gives up to 1.3 % more than vibrations
    that stay frozen, and up to 0.8 % (Mach 2) or 3.4 % (Mach 30) less than vibrations in equilibrium.

    Source: Anderson, Modern Compressible Flow, eq. 8.80 (recalled).
    """
    mach = np.asarray(mach, dtype=np.float64)
    g = heat_capacity_ratio
    m2 = np.square(np.maximum(mach, 1.0))
    pitot = (
        arrays.pow((g + 1.0) * (g + 1.0) * m2 / (4.0 * g * m2 - 2.0 * (g - 1.0)), g / (g - 1.0))
        * (1.0 - g + 2.0 * g * m2)
        / (g + 1.0)
    )
    s2 = np.square(np.minimum(mach, 1.0))
    stagnation = arrays.pow(1.0 + 0.5 * (g - 1.0) * s2, g / (g - 1.0))
    subsonic = (stagnation - 1.0) / (0.5 * g * s2) + BASE_SUCTION * (1.0 - s2)
    return np.where(mach >= 1.0, (pitot - 1.0) / (0.5 * g * m2), subsonic)


def base_pressure_coefficient(mach: np.ndarray, heat_capacity_ratio: float) -> np.ndarray:
    """Return the mean pressure coefficient of the leeward surface at each Mach number, with the shape of
    ``mach``.

    Supersonic: Gaubeaud's correlation, which tends to -2 / (g M^2), the value of a vacuum (g: ratio of
    specific heats). Subsonic: from the suction of a bluff body at rest to that at Mach 1, with the square of
    the Mach number [E].

    Source: Gaubeaud, as used for the aerodynamics of Stardust (Mitcheltree et al., AIAA 97-2304; recalled).
    """
    mach, g = np.asarray(mach, dtype=np.float64), heat_capacity_ratio
    m = np.maximum(mach, 1.0)
    share = pow(2.0 / (g + 1.0), 1.4) * arrays.pow(m, -2.8) * (2.0 * g * m * m - (g - 1.0)) / (g + 1.0)
    behind = 2.0 / (g * m * m) * (share - 1.0)
    s2 = np.square(np.minimum(mach, 1.0))
    return np.where(mach >= 1.0, behind, s2 * behind - BASE_SUCTION * (1.0 - s2))


def continuum(newton: np.ndarray, wet: np.ndarray, mach: np.ndarray, ratio: float) -> np.ndarray:
    """Coefficients at each Mach number (first axis): modified Newtonian pressure on the windward surface,
    base pressure on the rest.  ``newton``, ``wet``: integrals of (n.v)^2 and of 1 over the windward surface;
    ``ratio``: of specific heats behind the shock.
    """
    mach = np.asarray(mach, dtype=float)
    # the suction of a bluff body at rest is the base's own part here
    suction = BASE_SUCTION * np.maximum(1.0 - np.square(mach), 0.0)
    stagnation, base = stagnation_pressure_coefficient(mach, ratio), base_pressure_coefficient(mach, ratio)
    shape = (-1, *(1 for _ in newton.shape))
    return (stagnation - suction).reshape(shape) * newton - base.reshape(shape) * wet


def newtonian_coefficients(
    rings: Rings, angle: np.ndarray, mach: np.ndarray, heat_capacity_ratio: float, size: tuple[float, float]
) -> np.ndarray:
    """Continuum coefficients [Mach, angle, (CA, CN, Cm)] of a capsule at total angles (rad, 0..pi); ``size``:
    reference diameter, and station of the moment reference, m.
    """
    newton, _ = surface_integrals(rings, angle, *size)
    return continuum(newton, windward_integrals(rings, angle, *size), mach, heat_capacity_ratio)


def capsule_rings(capsule: CapsuleParams, points: int = 24) -> Rings:
    """Rings of nose, forebody cones, shoulder, backshell cones and lid, Gauss-Legendre points on each."""
    rn, rs, rmax = capsule.nose_radius_m, capsule.shoulder_radius_m, 0.5 * capsule.diameter_m
    nose, back = radians(capsule.cone_half_angle_deg), radians(capsule.backshell_cone_angle_deg)
    back2 = radians(capsule.backshell_second_cone_angle_deg)
    r1, x1 = rn * cos(nose), -rn * (1.0 - sin(nose))
    pieces, cone = [_arc(-rn, 0.0, rn, 0.5 * pi, nose, points)], nose
    if (r_break := capsule.forebody_break_radius_m) is not None:
        if r_break <= r1:
            raise ValueError("nose radius and forebody_break_radius_m leave no room for the first cone")
        x_break = x1 - (r_break - r1) / tan(nose)
        pieces.append(_line(x1, r1, x_break, r_break, points))
        x1, r1 = x_break, r_break
        cone = radians(stated(capsule.forebody_second_cone_angle_deg))
    r2 = rmax - rs * (1.0 - cos(cone))
    if r2 <= r1:
        raise ValueError("nose and shoulder radii leave no room for the cone")
    x2 = x1 - (r2 - r1) / tan(cone)
    x_shoulder = x2 - rs * sin(cone)
    x3, r3 = x_shoulder - rs * sin(back), rmax - rs * (1.0 - cos(back))
    r4, r5 = capsule.backshell_break_radius_m, capsule.backshell_base_radius_m
    x4 = x3 - (r3 - r4) / tan(back)
    x5 = x4 - (r4 - r5) / tan(back2)
    pieces += [
        _line(x1, r1, x2, r2, points),
        _arc(x_shoulder, rmax - rs, rs, cone, 0.0, points),
        _arc(x_shoulder, rmax - rs, rs, 0.0, -back, points),
        _line(x3, r3, x4, r4, points),
        _line(x4, r4, x5, r5, points),
        _line(x5, r5, x5, 0.0, points),
    ]
    return Rings(*(np.concatenate(column) for column in zip(*pieces, strict=True)))


def surface_integrals(
    rings: Rings, angle: np.ndarray, diameter: float, x_ref: float
) -> tuple[np.ndarray, np.ndarray]:
    """Newtonian (per unit Cp_max) and free-molecular coefficients [angle, (CA, CN, Cm)] at total angles (rad,
    0..pi); Cm about (x_ref, 0, 0) and ``diameter``.

    Newtonian: Cp = Cp_max (n.v)^2.  Free molecular: hyperthermal, diffuse, cold fully accommodated wall:
    force 2 qbar per projected area against the velocity.  Source: Regan & Anandakrishnan, Dynamics of
    Atmospheric Re-Entry, ch. 11-12 (recalled).
    """
    area, ca, sa = 0.25 * pi * diameter * diameter, arrays.cos(angle)[:, None], arrays.sin(angle)[:, None]
    a, b, bound = _windward(rings, angle)
    # Integrals of 1, cos, cos^2, cos^3 over the windward arc |phi| < bound; b >= 0 for angles 0..pi.
    s, c = arrays.sin(bound), arrays.cos(bound)
    m0, m1, m2, m3 = 2.0 * bound, 2.0 * s, bound + s * c, 2.0 * s - 2.0 / 3.0 * s * s * s
    arm = rings.x - x_ref

    def total(density: np.ndarray) -> np.ndarray:
        return (density * rings.weight).sum(axis=1) / area

    flat, wave = a * a * m0 + 2 * a * b * m1 + b * b * m2, a * a * m1 + 2 * a * b * m2 + b * b * m3
    moment = -total(wave * (rings.r * rings.nx - arm * rings.nr)) / diameter
    newton = np.stack((total(flat * rings.nx), total(wave * rings.nr), moment), axis=1)
    shadow, tilt = a * m0 + b * m1, a * m1 + b * m2
    moment = -2.0 * total(tilt * rings.r * ca - shadow * arm * sa) / diameter
    rare = np.stack((2.0 * total(shadow) * ca[:, 0], 2.0 * total(shadow) * sa[:, 0], moment), axis=1)
    return newton, rare


def windward_integrals(rings: Rings, angle: np.ndarray, diameter: float, x_ref: float) -> np.ndarray:
    """Coefficients [angle, (CA, CN, Cm)] of a pressure coefficient of 1 on the windward surface; one on the
    leeward surface alone gives the opposite values.
    """
    area, bound = 0.25 * pi * diameter * diameter, _windward(rings, angle)[2]
    along, across = 2.0 * bound * rings.nx, 2.0 * arrays.sin(bound)
    turning = -across * (rings.r * rings.nx - (rings.x - x_ref) * rings.nr) / diameter
    return np.stack(
        [(part * rings.weight).sum(axis=1) / area for part in (along, across * rings.nr, turning)], axis=1
    )


def _windward(rings: Rings, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """a and b of n.v = a + b cos phi, at every total angle and ring, and the azimuth up to which n.v > 0."""
    a, b = rings.nx * arrays.cos(angle)[:, None], rings.nr * arrays.sin(angle)[:, None]
    tiny = b < 1e-14
    ratio = np.where(tiny, -np.sign(a), -a / np.where(tiny, 1.0, b))
    return a, b, arrays.acos(np.clip(ratio, -1.0, 1.0))


def _arc(x: float, r: float, radius: float, start: float, end: float, points: int) -> Rings:
    """Arc around (x, r); the normal turns from elevation ``start`` (towards +x) down to ``end``."""
    node, weight = arrays.gauss_legendre(points)
    elevation = start + 0.5 * (end - start) * (node + 1.0)
    nx, nr = arrays.sin(elevation), arrays.cos(elevation)
    rr = r + radius * nr
    return Rings(x + radius * nx, rr, nx, nr, rr * radius * 0.5 * abs(end - start) * weight)


def _line(x0: float, r0: float, x1: float, r1: float, points: int) -> Rings:
    """Cone from (x0, r0) aft to (x1, r1); the normal points away from the axis (aft for a disc)."""
    node, weight = arrays.gauss_legendre(points)
    t, length = 0.5 * (node + 1.0), hypot(x1 - x0, r1 - r0)
    r, one = r0 + t * (r1 - r0), np.ones(points)
    return Rings(
        x0 + t * (x1 - x0), r, one * (r1 - r0) / length, one * (x0 - x1) / length, r * 0.5 * length * weight
    )


class Panels(NamedTuple):
    """Triangles in B: centres (m), outward unit normals, and areas (m2); shapes (n, 3), (n, 3), (n,)."""

    centre: np.ndarray
    normal: np.ndarray
    area: np.ndarray


class References(NamedTuple):
    """References of coefficients of forces and moments: area (m2), lengths of roll, pitch and yaw (m), and
    the point in B that moments are about.
    """

    area: float
    lengths: np.ndarray
    point: np.ndarray


#: Largest net area of a surface that counts as closed, over its total area.
_CLOSED = 2e-3


def panels_of(corners: np.ndarray) -> Panels:
    """Panels of triangles [triangle, corner, xyz] in B, turned outwards; triangles without area are left out.

    Raises:
        ValueError: the triangles do not form a closed surface, or enclose no volume.
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
    """Volume of the body over that of its convex hull: 1 for a convex body, whose panels shade no other."""
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
        Newtonian pressure (n.v)^2 on the windward panels; a pressure coefficient of 1 on these; and
        free-molecular flow, hyperthermal and diffuse from a cold wall: a force of 2 qbar per projected area
        against the velocity.
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
