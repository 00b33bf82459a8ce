"""Fading-memory filters of the ratio of measured drag to that of the believed air and vehicle, and of the
speed.

Changes by the vehicle's own motion (climb, deceleration, drag coefficient) are in the believed drag at once;
the rest (gusts, density waves, thrusters, noise) passes a first-order filter. Where the air is as believed,
or differs by a factor, the filtered drag is the measured one without lag.

In a wind the lift does work on the planet-relative velocity, and none on the air-relative one: the speed that
believed drag and energy are formed with changes by drag and gravity alone, and takes up the rest slowly.
Otherwise the reference drag, a function of energy, would change with every change of the bank angle. Source:
the fading-memory filters of density and lift-to-drag ratio of numerical entry guidance (Brunner & Lu 2008,
eqs. 33-34; Lu 2014, section V.C); that of the speed is this software's.
"""

from __future__ import annotations

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial.elementary import exp, sin


class DragFilterParams(Params):
    """Fading memories of measured drag and speed."""

    time_constant_s: float = param(
        1.0,
        "memory of the ratio of measured to believed drag; 0: drag and energy as measured",
        status="estimate",
        ge=0.0,
        le=100.0,
    )
    speed_time_constant_s: float = param(
        10.0,
        "memory of other changes of the speed than by drag and gravity",
        status="estimate",
        gt=0.0,
        le=100.0,
    )
    least_drag_m_s2: float = param(
        0.5, "drag below which drag and energy are as measured", status="estimate", gt=0.0
    )


#: Time (s), filtered speed (m/s), rate of the speed (m/s2), filtered ratio of drag; ratio 0: not started.
DRAG_FILTER = record(("t", "f8"), ("speed", "f8"), ("rate", "f8"), ("ratio", "f8"))


@kernel
def filter_drag(params, atmosphere, vehicle, nav, memory):
    """Put the filtered drag and the energy at the filtered speed in place of the measured ones in ``nav``.

    ``atmosphere`` and ``vehicle`` are the believed ones, ``memory`` is a ``DRAG_FILTER``.
    """
    p = params
    density, _, _ = model_atmosphere(atmosphere, nav.altitude)
    area, _ = believed_aero(vehicle, nav.mach, nav.speed)
    per_square = 0.5 * density * area / vehicle.entry_mass
    if p.time_constant == 0.0 or min(nav.drag, per_square * nav.speed * nav.speed) < p.least_drag:
        memory.ratio = 0.0
        return
    rate = -nav.drag - nav.gravity * sin(nav.flight_path_angle)
    if memory.ratio == 0.0:
        memory.speed, memory.ratio = nav.speed, nav.drag / (per_square * nav.speed * nav.speed)
    else:
        dt = nav.t - memory.t
        memory.speed += 0.5 * dt * (memory.rate + rate)
        memory.speed += (1.0 - exp(-dt / p.speed_time_constant)) * (nav.speed - memory.speed)
        ratio = nav.drag / (per_square * memory.speed * memory.speed)
        memory.ratio += (1.0 - exp(-dt / p.time_constant)) * (ratio - memory.ratio)
    memory.t, memory.rate = nav.t, rate
    nav.drag = memory.ratio * per_square * memory.speed * memory.speed
    nav.energy += 0.5 * (memory.speed * memory.speed - nav.speed * nav.speed)
