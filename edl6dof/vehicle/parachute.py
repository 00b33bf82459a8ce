"""Parachute: canopy as its own body on an elastic riser; how it fills and drags is its model's.

The canopy is a point mass with apparent mass whose axis lies along the riser.  Axial and normal force act on
it in its own air-relative velocity.  Inflation, opening load and drag over Mach number are those of a model
(:mod:`edl6dof.vehicle.parachute_models`).  Left out: the thrust term of growing apparent mass (opening-load
factors are fitted without it) and canopy attitude of its own.
"""

from __future__ import annotations

from math import pi, sin, sqrt
from typing import ClassVar

import numpy as np

from edl6dof.config.base import REQUIRED, Hardware, Key, Vec3, param
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.jit import kernel
from edl6dof.spatial.vector import clamp
from edl6dof.vehicle.parachute_models.disk_gap_band import DiskGapBandParams
from edl6dof.vehicle.parachute_models.registry import (
    ParachuteChoice,
    efficiency_of_model,
    inflation_of_model,
)

PACKED, EXTRACTING, INFLATING, RELEASED = range(4)


class ParachuteParams(ParachuteChoice, Hardware):
    """Geometry, inflation, aerodynamics and suspension of a parachute, of which one flies at a time."""

    former: ClassVar = {
        "mortar_delay_s": "delay_s of the event that deploys the parachute",
        **{key: f"disk_gap_band: {{{key}: ...}}" for key in DiskGapBandParams.model_fields},
    }

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

    def inflated(self, since_line_stretch_s: np.ndarray) -> np.ndarray:
        """Share of the full drag area at times after line stretch, s."""
        record = np.zeros(1, PARACHUTE_PARAMS)[0]
        fill(record, self)
        share = np.zeros(len(since_line_stretch_s))
        inflations(record, since_line_stretch_s, share)
        return share


PARACHUTE_PARAMS = dtype_of(ParachuteParams)

#: Indices of the parts that a parachute is packed as and hangs from; -1 for none.
SUSPENSION = np.dtype([("pack", "i8"), ("carrier", "i8")], align=True)


@kernel
def inflation(chute, since_line_stretch):
    """Share of the full drag area at a time (s) after line stretch: none before, then as its model has it."""
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
    efficiency = efficiency_of_model(chute.model, chute, chute, mach)
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
