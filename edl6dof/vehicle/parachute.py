"""Disk-gap-band parachute: canopy as its own body on an elastic riser, inflation, Mach-dependent drag.

The canopy is a point mass with apparent mass whose axis lies along the riser.  Axial and normal force act on
it in its own air-relative velocity.  Drag area, opening load, Mach efficiency and inflation follow the model
used for the Mars Science Laboratory: Cruz, Way, Shidner et al., "Parachute Models Used in the Mars Science
Laboratory Entry, Descent, and Landing Simulation", AIAA 2013-1276 (numbers second hand, see the reference
data).  Left out: the thrust term of growing apparent mass (the opening-load factor was fitted without it) and
canopy attitude of its own.
"""

from __future__ import annotations

from math import pi, sin, sqrt
from typing import ClassVar

import numpy as np

from edl6dof.config.base import REQUIRED, Hardware, Key, Vec3, param
from edl6dof.config.dtype import dtype_of
from edl6dof.jit import kernel
from edl6dof.spatial.vector import clamp

PACKED, EXTRACTING, INFLATING, RELEASED = range(4)


class ParachuteParams(Hardware):
    """Geometry, inflation, aerodynamics and suspension of a parachute, of which one flies at a time."""

    former: ClassVar = {"mortar_delay_s": "delay_s of the event that deploys the parachute"}

    name: Key = param(REQUIRED, "name that events call it by", record=False)
    diameter_m: float = param(1.0, "nominal diameter; the reference area is pi/4 of its square", gt=0.0)
    drag_coefficient: float = param(
        0.62,
        "axial force coefficient at low Mach number, on the nominal area",
        status="published",
        source="MSL, Cruz et al. 2013",
        gt=0.0,
    )
    mortar_speed_m_s: float = param(
        30.0, "speed of the pack relative to the vehicle at mortar fire", status="estimate", gt=0.0
    )
    pack_drag_area_m2: float = param(
        0.3, "drag area of the pack before line stretch", status="estimate", ge=0.0
    )
    line_length_m: float = param(
        1.0, "from the bridle confluence to the canopy with lines taut, unloaded", gt=0.0
    )
    confluence_m: Vec3 = param((0.0, 0.0, 0.0), "bridle confluence point in B (the bridle is taken as rigid)")
    stiffness_n_m: float = param(40000.0, "of lines and riser together", status="estimate", gt=0.0)
    damping_ratio: float = param(
        0.1, "of the riser with the canopy's own mass", status="estimate", ge=0.0, le=1.0
    )
    inflation_speed_m_s: float = param(
        27.2, "diameter over inflation time", status="published", source="MSL, Cruz et al. 2013", gt=0.0
    )
    inflation_exponent: float = param(
        4.0, "growth of the drag area with time", status="published", source="MSL, Cruz et al. 2013", gt=0.0
    )
    opening_load_factor: float = param(
        1.344,
        "drag-area overshoot at full inflation",
        status="published",
        source="MSL, Cruz et al. 2013",
        ge=1.0,
    )
    overshoot_decay_s: float = param(0.25, "time in which the overshoot is gone", status="estimate", gt=0.0)
    apparent_mass_factor: float = param(0.75, "K in K rho (4/3) pi (0.35 D)^3", status="estimate", ge=0.0)
    area_oscillation: float = param(
        0.0, "relative drag-area oscillation above Mach 1.4", status="estimate", ge=0.0, lt=1.0
    )
    area_oscillation_frequency_hz: float = param(3.0, "its frequency", status="estimate", gt=0.0)
    normal_slope: float = param(
        0.35, "normal-force coefficient slope far above the trim angle, per rad", status="estimate", ge=0.0
    )
    trim_angle_deg: float = param(
        8.0, "canopy angle of attack at which the normal force vanishes", status="estimate", ge=0.0, le=30.0
    )
    drag_factor: float = param(1.0, "drag over its table value", gt=0.0)
    pack: str | None = param(
        None, "part that is the packed parachute; none: its deployment is only noted", record=False
    )
    carried_by: str | None = param(
        None, "part that it hangs from: it goes where that part goes", record=False
    )


PARACHUTE_PARAMS = dtype_of(ParachuteParams)

#: Indices of the parts that a parachute is packed as and hangs from; -1 for none.
SUSPENSION = np.dtype([("pack", "i8"), ("carrier", "i8")], align=True)


@kernel
def mach_efficiency(mach):
    """Drag over its subsonic value (Cruz et al. 2013, as implemented for MSL); continuous, 0.61 beyond Mach
    2.6.
    """
    if mach <= 0.7:
        return 1.0
    if mach <= 0.94:
        return 1.0 - 0.33 * (mach - 0.7) / 0.24
    if mach <= 1.4:
        s = (1.4 - mach) / 0.46
        return 1.0 - 0.33 * s * s
    if mach <= 1.85:
        s = (mach - 1.4) / 0.45
        return 1.0 - 0.16 * s * s
    return 0.84 - 0.23 * min((mach - 1.85) / 0.75, 1.0)


@kernel
def inflation(chute, since_line_stretch):
    """Drag-area fraction after line stretch: a power law up to the opening load factor, then a decay to
    one.
    """
    if since_line_stretch <= 0.0:
        return 0.0
    x = since_line_stretch * chute.inflation_speed / chute.diameter
    if x < 1.0:
        return chute.opening_load_factor * x**chute.inflation_exponent
    fade = (since_line_stretch - chute.diameter / chute.inflation_speed) / chute.overshoot_decay
    return 1.0 + (chute.opening_load_factor - 1.0) * max(1.0 - fade, 0.0)


@kernel
def nominal_area(chute):
    """Nominal area, m2."""
    return 0.25 * pi * chute.diameter * chute.diameter


@kernel
def apparent_mass(chute, density, fraction):
    """Apparent mass of the canopy, kg; it grows with the cube of the projected radius."""
    radius = 0.35 * chute.diameter * sqrt(clamp(fraction, 0.0, 1.0))
    return chute.apparent_mass_factor * density * (4.0 / 3.0) * pi * radius * radius * radius


@kernel
def riser_tension(chute, canopy_mass, distance, stretch_rate):
    """Tension (N) of lines and riser: zero when slack, never a push."""
    stretch = distance - chute.line_length
    if stretch <= 0.0:
        return 0.0
    damping = 2.0 * chute.damping_ratio * sqrt(chute.stiffness * canopy_mass)
    return max(chute.stiffness * stretch + damping * stretch_rate, 0.0)


@kernel
def canopy_force(chute, fraction, density, mach, t, v_air, axis):
    """Aerodynamic force on the canopy (3-tuple, same frame as its inputs).

    Args:
        chute: parachute record.
        fraction: inflated drag-area fraction.
        density: air density at the canopy, kg/m3.
        mach: its Mach number.
        t: time, s (phase of the area oscillation).
        v_air: air-relative velocity of the canopy.
        axis: unit vector from the canopy to the vehicle.

    The normal force is restoring beyond the trim angle and destabilising inside it, which makes the canopy
    cone and swing.
    """
    speed2 = v_air[0] * v_air[0] + v_air[1] * v_air[1] + v_air[2] * v_air[2]
    speed = sqrt(speed2)
    if speed < 1e-6:
        return 0.0, 0.0, 0.0
    area = nominal_area(chute) * fraction
    if mach > 1.4:
        area *= 1.0 + chute.area_oscillation * sin(2.0 * pi * chute.area_oscillation_frequency * t)
    along = v_air[0] * axis[0] + v_air[1] * axis[1] + v_air[2] * axis[2]
    cosine = clamp(along / speed, -1.0, 1.0)
    sine = sqrt(1.0 - cosine * cosine)
    pressure = 0.5 * density * speed2
    axial = pressure * area * chute.drag_coefficient * chute.drag_factor * mach_efficiency(mach) * abs(cosine)
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
