"""The outer shape of a vehicle: as its file states it, or from aerodynamics, mass and landing gear."""

from __future__ import annotations

from itertools import pairwise
from math import cos, pi, radians, sin, sqrt, tan
from typing import NamedTuple

import numpy as np

from edl6dof.config.base import Vec3, stated
from edl6dof.vehicle.vehicle import BodyShape, LanderKind, VehicleParams

#: A corner of a profile: station x in B and radius, m.
Corner = tuple[float, float]
#: Relative difference up to which two moments of inertia count as equal.
_EQUAL = 0.01
#: Half angle of a forebody of which nothing is known, deg: that of the Viking family.
_HALF_ANGLE = 70.0


class Outline(NamedTuple):
    """Shape of the entry vehicle in B, m and rad.

    Attributes:
        body: ``sphere_cone``, ``sphere``, ``box`` or ``none``.
        centre: middle of a sphere or a box.
        sides: of the box along x, y, z that just holds the body.
        forebody: corners of a sphere-cone's front from the nose to the shoulder.
        afterbody: corners from the shoulder to the lid.
        lander: kind of lander inside the entry vehicle.
    """

    body: BodyShape
    centre: np.ndarray
    sides: np.ndarray
    forebody: list[Corner]
    afterbody: list[Corner]
    lander: LanderKind

    @property
    def size(self) -> float:
        """Largest dimension, m."""
        return float(self.sides.max())

    @property
    def radius(self) -> float:
        """Half the largest width across x, m."""
        return 0.5 * float(self.sides[1:].max())

    @property
    def flank_angle(self) -> float:
        """Angle between the axis and the first cone of the afterbody, rad."""
        (x0, r0), (x1, r1) = self.afterbody[:2]
        return float(np.arctan2(r0 - r1, x0 - x1))

    def radius_at(self, x: np.ndarray) -> np.ndarray:
        """Return the radius (m) of a sphere-cone at stations ``x`` (m in B), 0 ahead of it and behind it."""
        stations, radii = np.transpose([*self.forebody, *self.afterbody])
        order = np.argsort(stations, kind="stable")
        return np.interp(x, stations[order], radii[order], left=0.0, right=0.0)


def outline(vehicle: VehicleParams) -> Outline:
    """Return the shape of a vehicle."""
    body = vehicle.appearance.body
    body = _body(vehicle) if body == "derived" else body
    lander = vehicle.appearance.lander
    lander = _lander(vehicle) if lander == "derived" else lander
    centre = np.array(vehicle.mass.entry_centre_m)
    if body != "sphere_cone":
        sides = _sides(vehicle) if body == "box" else np.full(3, diameter(vehicle))
        return Outline(body, centre, sides, [], [], lander)
    forebody = _forebody(vehicle)
    afterbody = _afterbody(vehicle, forebody[-1])
    length = forebody[0][0] - afterbody[-1][0]
    wide = 2.0 * forebody[-1][1]
    return Outline(body, centre, np.array([length, wide, wide]), forebody, afterbody, lander)


def diameter(vehicle: VehicleParams) -> float:
    """Return the largest diameter, m: as stated, of the aerodynamics' capsule, or of their reference area."""
    aero = vehicle.aero
    if vehicle.appearance.diameter_m is not None:
        return vehicle.appearance.diameter_m
    if aero.model == "capsule":
        return aero.capsule.diameter_m
    area = aero.constant.reference_area_m2
    if aero.model == "lift_drag":
        area = aero.lift_drag.reference_area_m2
    elif aero.model == "body":
        area = aero.body.reference_area_m2
    return 2.0 * sqrt(area / pi)


def _body(vehicle: VehicleParams) -> BodyShape:
    if vehicle.aero.model == "capsule":
        return "sphere_cone"
    if vehicle.landing_gear.footpads_m and vehicle.showing("backshell") is None:
        return "none"
    x, y, z = sorted(_inertia(vehicle))
    if z - x <= _EQUAL * z:
        return "sphere"
    return "sphere_cone" if min(y - x, z - y) <= _EQUAL * z else "box"


def _lander(vehicle: VehicleParams) -> LanderKind:
    if vehicle.landing_gear.footpads_m:
        return "legs"
    return "platform" if vehicle.engines else "none"


def _inertia(vehicle: VehicleParams) -> Vec3:
    mass = vehicle.mass
    return mass.entry_inertia_kg_m2 or mass.lander_inertia_kg_m2 or (1.0, 1.0, 1.0)


def _sides(vehicle: VehicleParams) -> np.ndarray:
    """Sides of a box: as stated, or of a solid one of the vehicle's mass and moments of inertia."""
    if vehicle.appearance.size_m is not None:
        return np.abs(vehicle.appearance.size_m)
    inertia = np.array(_inertia(vehicle))
    return np.sqrt(6.0 / vehicle.mass.entry_kg * (inertia.sum() - 2.0 * inertia))


def _forebody(vehicle: VehicleParams) -> list[Corner]:
    """Sphere, cone and shoulder from the nose to the largest diameter."""
    look, capsule = vehicle.appearance, vehicle.aero.capsule
    own = vehicle.aero.model == "capsule"
    wide = 0.5 * diameter(vehicle)
    nose = look.nose_radius_m or (capsule.nose_radius_m if own else vehicle.nose_radius_m)
    edge = look.shoulder_radius_m
    if edge is None:
        edge = capsule.shoulder_radius_m if own else 0.05 * wide
    edge = min(edge, 0.5 * wide)
    # angle at which sphere and shoulder meet the cone, from the axis
    half = look.cone_half_angle_deg or (capsule.cone_half_angle_deg if own else _HALF_ANGLE)
    cone = radians(90.0 - half)
    nose = min(nose, (wide - edge * (1.0 - sin(cone))) / sin(cone))
    front = [
        (look.nose_x_m - nose * (1.0 - cos(a)), max(nose * sin(a), 1e-4)) for a in np.linspace(0.0, cone, 7)
    ]
    corners = [(look.nose_x_m - nose * (1.0 - cos(cone)), nose * sin(cone))]
    if own and capsule.forebody_break_radius_m is not None:  # the first cone of a biconic capsule
        (x, r), r_break = corners[0], capsule.forebody_break_radius_m
        corners.append((x - (r_break - r) * tan(cone), r_break))
        cone = radians(90.0 - stated(capsule.forebody_second_cone_angle_deg))
    x0, r0 = corners[-1]
    r1 = wide - edge * (1.0 - sin(cone))
    x1 = x0 - (r1 - r0) * tan(cone)
    flank = [point for ends in pairwise(corners) for point in ends]
    flank += [(x0 + (x1 - x0) * k, r0 + (r1 - r0) * k) for k in (0.34, 0.67)]
    turn = np.linspace(cone, 0.5 * pi, 6)
    shoulder = [(x1 - edge * (cos(cone) - cos(a)), wide - edge * (1.0 - sin(a))) for a in turn]
    return [*front, *flank, *shoulder]


def _afterbody(vehicle: VehicleParams, shoulder: Corner) -> list[Corner]:
    """From the shoulder to the lid: as stated, the two cones of the aerodynamics' capsule, or flat."""
    x0, r0 = shoulder
    if stated := vehicle.appearance.backshell_m:
        return [shoulder, *((x0 - abs(back), min(abs(radius), r0)) for back, radius in stated)]
    if vehicle.aero.model != "capsule":
        return [shoulder, (x0 - 0.04 * r0, 0.9 * r0)]
    shape = vehicle.aero.capsule
    r1 = min(shape.backshell_break_radius_m, r0)
    r2 = min(shape.backshell_base_radius_m, r1)
    x1 = x0 - (r0 - r1) / tan(radians(shape.backshell_cone_angle_deg))
    x2 = x1 - (r1 - r2) / tan(radians(shape.backshell_second_cone_angle_deg))
    return [shoulder, (x1, r1), (x2, r2)]
