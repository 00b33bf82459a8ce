"""Parachute: canopy as its own body on an elastic riser, and the bridle of three legs between the vehicle and
the confluence, at which the riser begins; a model gives filling and drag.

The canopy is a point mass with apparent mass whose axis lies along the riser.  Axial and normal force act on
it in its own air-relative velocity.  Inflation, opening load and drag over Mach number are those of a model
(:mod:`edl6dof.vehicle.parachutes.canopy_models`).  Left out: the thrust term of growing apparent mass
(opening-load factors are fitted without it) and canopy attitude of its own.  The skirt hangs on lines all
around, which turn the canopy back with half the square of its radius times their stiffness: 0.5 (5.6 m)^2 40
kN/m = 630 kN m/rad for the canopy of Tianwen-1.  A pitching moment coefficient of 0.02 on 200 m2 and 16 m
turns it by 0.01 rad at 100 Pa, and it swings at 28 rad/s against 1 to 3 rad/s of the vehicle: its axis is
that of the riser to 0.6 deg, less than the uncertainty of the trim angle (5 to 10 deg).

The legs do not stretch (the stiffness of lines and riser includes theirs), but go slack.  The confluence is
the point nearest to the canopy that all legs can reach, in the intersection of three balls about the
attachments.  While every leg pulls it stays where they meet, as if fixed to the vehicle.  A pull from outside
the cone of the legs slackens one or two of them; the confluence then swings about the others, and arm and
attitude stiffness are smaller than those of a fixed point.  As the nearest point it moves across the riser
only, so that rate of stretch and work of the riser are those of a point fixed to the vehicle.  Left out: mass
and stretch of the legs, and that they can wrap around the vehicle.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import field_validator, model_validator

from edl6dof.config.base import REQUIRED, Capacity, Hardware, Key, Vec3, group, param
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.arrays import lengths
from edl6dof.spatial.elementary import sin
from edl6dof.spatial.vector import add, clamp, cross, dot, norm, scale, sub, take3, unit
from edl6dof.vehicle.parachutes.canopy_models import (
    MachTable,
    ParachuteChoice,
    efficiency_of_model,
    inflation_of_model,
    tabulated,
)

LEGS = 3
#: Relative tolerance on the length of a leg when its reach is tested.
_ROUNDING = 1e-12
#: Index of the choice of ``area_oscillates`` in records.
ALWAYS = 0
PACKED, EXTRACTING, INFLATING, RELEASED = range(4)
#: Riser in the derivative: as its stretch says, or held for a step, so that the step is smooth.
BY_STRETCH, TAUT, SLACK = range(3)


class ParachuteParams(ParachuteChoice, Hardware):
    """Geometry, inflation, aerodynamics and suspension of a parachute, of which one flies at a time."""

    name: Key = param(REQUIRED, "name in events", record=False)
    diameter_m: float = param(
        REQUIRED,
        "nominal diameter; the reference area is pi/4 of its square",
        gt=0.0,
        usual=(0.5, 50, "drogue of Stardust to ringsails of Orion"),
    )
    drag_coefficient: float = param(
        REQUIRED,
        "axial force coefficient at low Mach number, on the nominal area",
        gt=0.0,
        usual=(0.2, 1.2, "ribbon to ringsail"),
    )
    mach_efficiency: MachTable = group(
        MachTable, "drag over its value at low Mach number, by Mach; without points that of the model"
    )
    wake_factor: MachTable = group(
        MachTable,
        "drag in the wake of the forebody over that in the free stream, by Mach; without points 1: "
        "coefficients measured behind a capsule contain the loss",
    )
    mortar_speed_m_s: float = param(
        REQUIRED,
        "speed of the pack relative to the vehicle at mortar fire",
        gt=0.0,
        usual=(5, 60, "mortars that have flown"),
    )
    pack_drag_area_m2: float = param(
        0.3,
        "drag area of the pack before line stretch",
        status="estimate",
        ge=0.0,
        usual=(0.001, 3, "packs of drogues and main canopies"),
    )
    line_length_m: float = param(
        REQUIRED,
        "distance from the bridle confluence to the canopy with lines taut, unloaded",
        gt=0.0,
        usual=(0.5, 100, "one to two diameters"),
    )
    confluence_m: Vec3 = param(REQUIRED, "bridle confluence point in B, with every leg of the bridle taut")
    bridle_attachments_m: Annotated[list[Vec3], Capacity(LEGS)] = param(
        None,
        "points in B where the three legs of the bridle begin, of a length that reaches the confluence; "
        "none: the confluence is fixed to the vehicle",
        factory=list,
        max_length=LEGS,
    )
    stiffness_n_m: float = param(40000.0, "stiffness of lines and riser together", status="estimate", gt=0.0)
    damping_ratio: float = param(
        0.1, "damping ratio of the riser with the mass of the canopy", status="estimate", ge=0.0, le=1.0
    )
    apparent_mass_factor: float = param(
        0.75,
        "K in K rho (4/3) pi (0.35 D)^3",
        status="estimate",
        ge=0.0,
        usual=(0, 2, "the air inside a canopy and as much around it"),
    )
    area_oscillation: float = param(
        0.0,
        "relative drag-area oscillation at supersonic speed",
        status="estimate",
        ge=0.0,
        lt=1.0,
        usual=(0, 0.3, "disk-gap-band canopies above Mach 1.4"),
    )
    area_oscillation_mach: float = param(
        1.4,
        "Mach number above which the area oscillates",
        status="recalled",
        source="Sengupta et al. 2009",
        ge=0.0,
    )
    area_oscillation_frequency_hz: float = param(
        3.0, "frequency of the area oscillation", status="estimate", gt=0.0
    )
    area_oscillates: Literal["always", "open"] = param(
        "always",
        "always: also while the canopy fills; open: once it is open, for an opening load factor fitted to "
        "measured loads, which contains the oscillation until then",
    )
    normal_slope: float = param(
        0.35, "normal-force coefficient slope far above the trim angle, per rad", status="estimate", ge=0.0
    )
    trim_angle_deg: float = param(
        8.0, "canopy angle of attack at which the normal force vanishes", status="estimate", ge=0.0, le=30.0
    )
    drag_factor: float = param(1.0, "true drag divided by its nominal value", gt=0.0)
    pack: str | None = param(
        None, "part that is the packed parachute; none: its deployment is only recorded", record=False
    )
    carried_by: str | None = param(None, "part that it hangs from, and with which it leaves", record=False)

    @field_validator("bridle_attachments_m")
    @classmethod
    def _three_legs(cls, value: list[Vec3]) -> list[Vec3]:
        if len(value) not in (0, LEGS):
            raise ValueError(f"must be three points, or none (got {len(value)})")
        return value

    @model_validator(mode="after")
    def _legs_span_a_cone(self) -> Self:
        if self.bridle_attachments_m:
            legs = np.array(self.confluence_m) - np.array(self.bridle_attachments_m)
            longest = lengths(legs).max()
            if abs(dot(legs[0], cross(legs[1], legs[2]))) <= 1e-6 * longest * longest * longest:
                raise ValueError(
                    "bridle_attachments_m must not lie in one plane with confluence_m, nor on one line"
                )
        return self

    def inflated(self, since_line_stretch_s: np.ndarray) -> np.ndarray:
        """Share of the full drag area at times after line stretch, s."""
        record = np.zeros(1, PARACHUTE_PARAMS)[0]
        fill(record, self)
        share = np.zeros(len(since_line_stretch_s))
        inflations(record, since_line_stretch_s, share)
        return share


PARACHUTE_PARAMS = dtype_of(ParachuteParams)

#: Indices of the parts that a parachute is packed as and hangs from; -1 for none.
SUSPENSION = record(("pack", "i8"), ("carrier", "i8"))


@kernel
def inflation(chute, since_line_stretch):
    """Share of the full drag area at a time (s) after line stretch: 0 before, then by the model of the
    canopy.
    """
    if not since_line_stretch > 0.0:  # not a number where the lines were never taut
        return 0.0
    return inflation_of_model(chute.model, chute, chute, since_line_stretch)


@kernel
def inflations(chute, since_line_stretch, found):
    """:func:`inflation` at several times, into ``found``."""
    for i in range(len(found)):
        found[i] = inflation(chute, since_line_stretch[i])


@kernel
def nominal_area(chute):
    """Nominal area, m2."""
    return 0.25 * pi * chute.diameter * chute.diameter


@kernel
def drag_efficiency(chute, mach):
    """Return the drag divided by its value at low Mach number in the free stream, including the loss in the
    wake.
    """
    if chute.mach_efficiency.n_mach > 0:
        efficiency = tabulated(chute.mach_efficiency, mach)
    else:
        efficiency = efficiency_of_model(chute.model, chute, chute, mach)
    if chute.wake_factor.n_mach > 0:
        efficiency *= tabulated(chute.wake_factor, mach)
    return efficiency


@kernel
def apparent_mass(chute, density, fraction):
    """Apparent mass of the canopy, kg; it grows with the cube of the projected radius."""
    radius = 0.35 * chute.diameter * sqrt(clamp(fraction, 0.0, 1.0))
    return chute.apparent_mass_factor * density * (4.0 / 3.0) * pi * radius * radius * radius


@kernel
def riser_tension(chute, canopy_mass, distance, stretch_rate, held):
    """Tension (N) of lines and riser, and its margin (m): positive while spring and damper pull, negative
    where they would push or are too short to reach.  ``held``: taut or slack whatever the margin, or
    ``BY_STRETCH``.
    """
    stretch = distance - chute.line_length
    damping = 2.0 * chute.damping_ratio * sqrt(chute.stiffness * canopy_mass)
    tension = chute.stiffness * stretch + damping * stretch_rate
    margin = min(stretch, tension / chute.stiffness)
    if held == SLACK or (held == BY_STRETCH and margin <= 0.0):
        tension = 0.0
    return tension, margin


@kernel
def canopy_force(chute, fraction, density, mach, t, v_air, axis):
    """Aerodynamic force on the canopy (3-tuple, in the frame of its inputs) at an inflated ``fraction`` of
    the drag area, air ``density`` (kg/m3), Mach number and time ``t`` (s, phase of the area oscillation);
    ``v_air``: air-relative velocity (m/s), ``axis``: unit vector from the canopy to the vehicle.

    The normal force is restoring beyond the trim angle and destabilising inside it, which makes the canopy
    cone and swing.
    """
    speed2 = v_air[0] * v_air[0] + v_air[1] * v_air[1] + v_air[2] * v_air[2]
    speed = sqrt(speed2)
    if speed < 1e-6:
        return 0.0, 0.0, 0.0
    area = nominal_area(chute) * fraction
    oscillates = chute.area_oscillates == ALWAYS or fraction == 1.0
    if mach > chute.area_oscillation_mach and oscillates:
        area *= 1.0 + chute.area_oscillation * sin(2.0 * pi * chute.area_oscillation_frequency * t)
    along = v_air[0] * axis[0] + v_air[1] * axis[1] + v_air[2] * axis[2]
    cosine = clamp(along / speed, -1.0, 1.0)
    sine = sqrt(1.0 - cosine * cosine)
    pressure = 0.5 * density * speed2
    efficiency = drag_efficiency(chute, mach)
    axial = pressure * area * chute.drag_coefficient * chute.drag_factor * efficiency * abs(cosine)
    pack = pressure * chute.pack_drag_area / speed
    # direction of v_air across the axis
    inverse = 1.0 / (speed * sine) if sine > 1e-9 else 0.0
    nx = (v_air[0] - along * axis[0]) * inverse
    ny = (v_air[1] - along * axis[1]) * inverse
    nz = (v_air[2] - along * axis[2]) * inverse
    trim = sin(chute.trim_angle)
    relative = sine / trim if trim > 0.0 else 0.0
    shape = 1.0 - 2.0 / (1.0 + relative * relative) if trim > 0.0 else 1.0
    normal = pressure * area * chute.normal_slope * sine * shape
    sign = 1.0 if cosine >= 0.0 else -1.0
    return (
        -axial * sign * axis[0] - normal * nx - pack * v_air[0],
        -axial * sign * axis[1] - normal * ny - pack * v_air[1],
        -axial * sign * axis[2] - normal * nz - pack * v_air[2],
    )


@kernel
def confluence(chute, canopy_B):
    """Start of the riser (m, B) for a canopy at ``canopy_B``; ``chute.confluence`` without a bridle."""
    meeting = take3(chute.confluence, 0)
    if chute.n_bridle_attachments == 0 or _all_taut(chute.bridle_attachments, meeting, canopy_B):
        return meeting
    return _nearest(chute.bridle_attachments, meeting, canopy_B)


@kernel
def _all_taut(attachments, meeting, canopy):
    """True if all three legs are in tension when the canopy pulls on the point where they meet."""
    a = sub(meeting, take3(attachments[0], 0))
    b = sub(meeting, take3(attachments[1], 0))
    c = sub(meeting, take3(attachments[2], 0))
    pull = sub(canopy, meeting)
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    volume = dot(a, bc)
    return volume * dot(pull, bc) >= 0.0 and volume * dot(pull, ca) >= 0.0 and volume * dot(pull, ab) >= 0.0


@kernel
def _nearest(attachments, meeting, canopy):
    """Point nearest to the canopy that every leg reaches, with three, two, one or no leg taut."""
    if _reached(attachments, meeting, canopy):
        return canopy
    first = take3(attachments[0], 0)
    across = unit(cross(sub(take3(attachments[1], 0), first), sub(take3(attachments[2], 0), first)))
    other = sub(meeting, scale(2.0 * dot(sub(meeting, first), across), across))
    best = _nearer(attachments, meeting, canopy, meeting, other)
    for k in range(LEGS):
        a = take3(attachments[k], 0)
        b = take3(attachments[(k + 1) % LEGS], 0)
        length = norm(sub(meeting, a))
        alone = add(a, scale(length, unit(sub(canopy, a))))
        best = _nearer(attachments, meeting, canopy, best, alone)
        # two taut legs hold a circle about the line between their attachments
        axis = unit(sub(b, a))
        along = dot(sub(meeting, a), axis)
        out = sub(canopy, a)
        out = unit(sub(out, scale(dot(out, axis), axis)))
        radius = sqrt(length * length - along * along)
        pair = add(a, add(scale(along, axis), scale(radius, out)))
        best = _nearer(attachments, meeting, canopy, best, pair)
    return best


@kernel
def _nearer(attachments, meeting, canopy, best, point):
    """``point`` if the legs reach it and it is nearer to the canopy than ``best``, else ``best``."""
    if norm(sub(canopy, point)) < norm(sub(canopy, best)) and _reached(attachments, meeting, point):
        return point
    return best


@kernel
def _reached(attachments, meeting, point):
    """True if every leg is long enough for a point."""
    for k in range(LEGS):
        a = take3(attachments[k], 0)
        if norm(sub(point, a)) > norm(sub(meeting, a)) * (1.0 + _ROUNDING):
            return False
    return True
