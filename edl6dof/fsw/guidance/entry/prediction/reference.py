"""Reference trajectory: a point mass over a non-rotating sphere with onboard density, drag and lift, at an
open-loop bank profile.

Flown once on the ground before the mission with an open-loop bank profile in three segments over speed
(constant, linear, constant). Unless told otherwise the profile is shifted, by one number added to cos(bank),
so that the range from entry interface to the aim point is met at parachute speed.  What guidance needs of it
is tabulated over the square root of twice the specific energy, which is near the speed.
Sources: equations of motion, Wu, Cui & Cui 2013, eqs. 1-3 and 7; three-segment bank profile, Zheng & Cui
2015, section 3.2, with the linear middle segment of Yan, Sun & Guo 2016, section 3.
"""

from __future__ import annotations

from math import acos, cos, sin, sqrt
from typing import Self

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import Params, param
from edl6dof.fsw.guidance.entry.prediction.airframe import believed_aero
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.jit import kernel
from edl6dof.spatial.lookups import held_cell
from edl6dof.spatial.vector import clamp

NODES = 256
STEPS = 6000
#: Least cosine of the reference bank angle: never more than 120 deg, so that there is authority left to bring
#: the lift down.
LEAST_COSINE = -0.5


class ReferenceBankParams(Params):
    """Open-loop bank profile of the reference trajectory: constant, linear in speed, constant; zero in
    alignment.
    """

    fast_bank_deg: float = param(90.0, "bank above fast_speed_m_s", ge=0.0, le=180.0)
    fast_speed_m_s: float = param(
        3500.0, "speed above which the bank is constant", status="published", source="Yan 2016", gt=0.0
    )
    slow_bank_deg: float = param(90.0, "bank below slow_speed_m_s", ge=0.0, le=180.0)
    slow_speed_m_s: float = param(
        1500.0, "speed below which the bank is constant", status="published", source="Yan 2016", gt=0.0
    )
    fit_range: bool = param(
        True, "whether cos(bank) is shifted, alike at all speeds, so that the range ends at the aim point"
    )

    @model_validator(mode="after")
    def _speeds_fall(self) -> Self:
        if not self.slow_speed_m_s < self.fast_speed_m_s:
            raise ValueError("slow_speed_m_s must be below fast_speed_m_s")
        return self


REFERENCE = np.dtype(
    [
        ("first", "f8"),
        ("spacing", "f8"),
        ("shift", "f8"),
        ("drag", "f8", (NODES,)),
        ("drag_rate", "f8", (NODES,)),
        ("drag_acceleration", "f8", (NODES,)),
        ("cos_path", "f8", (NODES,)),  # ground distance per path length: cos(gamma) R/r
        ("range", "f8", (NODES,)),
    ],
    align=True,
)


@kernel
def point_mass(onboard, h, v, gamma, bank):
    """Rates of (altitude, speed, flight-path angle, ground range) and the drag acceleration."""
    planet, vehicle = onboard.planet, onboard.vehicle
    r = planet.equatorial_radius + h
    g = planet.mu / (r * r)
    density, sound, _ = model_atmosphere(onboard.atmosphere, h)
    area, lift_to_drag = believed_aero(vehicle, v / sound)
    drag = 0.5 * density * v * v * area / vehicle.entry_mass
    lift = drag * lift_to_drag
    return (
        v * sin(gamma),
        -drag - g * sin(gamma),
        lift * cos(bank) / v + (v / r - g / v) * cos(gamma),
        v * cos(gamma) * planet.equatorial_radius / r,
        drag,
    )


@kernel
def reference_bank(onboard, shift, speed):
    """Bank angle (rad) of the open-loop profile at a speed, its cosine shifted by ``shift`` but kept above
    -0.5.

    Heading alignment banks to either side of zero: from there on the reference flies with wings level.
    """
    entry = onboard.guidance.entry
    if speed <= max(entry.align_speed, entry.heading.speed):
        return 0.0
    p = entry.reference_bank
    share = clamp((speed - p.slow_speed) / (p.fast_speed - p.slow_speed), 0.0, 1.0)
    return acos(clamp(cos(p.slow_bank + share * (p.fast_bank - p.slow_bank)) + shift, LEAST_COSINE, 1.0))


@kernel
def node_of(reference, energy_speed):
    """Node below ``energy_speed`` = sqrt(2E) (m/s) in the table, and the share of the way to the next; held
    at both ends.
    """
    return held_cell((energy_speed - reference.first) / reference.spacing, NODES - 1)


@kernel
def fly(onboard, entry, shift, final_speed, dt, history):
    """Fly the point mass to ``final_speed``; rows of ``history`` are (sqrt(2E), range, drag, ground per path,
    time). Returns the row count, and the altitude (m) and flight-path angle (rad) at which it ends.

    ``entry`` is (altitude, speed, flight-path angle, curvature radius correction of the true altitude datum =
    0).
    """
    h, v, gamma, s, t = entry[0], entry[1], entry[2], 0.0, 0.0
    planet = onboard.planet
    count = 0
    while v > final_speed and h > -5000.0 and count < history.shape[0]:
        sigma = reference_bank(onboard, shift, v)
        a = point_mass(onboard, h, v, gamma, sigma)
        energy = 0.5 * v * v + planet.mu * (
            1.0 / planet.equatorial_radius - 1.0 / (planet.equatorial_radius + h)
        )
        row = history[count]
        row[0], row[1], row[2], row[3], row[4] = sqrt(2.0 * max(energy, 0.0)), s, a[4], a[3] / v, t
        count += 1
        b = point_mass(onboard, h + 0.5 * dt * a[0], v + 0.5 * dt * a[1], gamma + 0.5 * dt * a[2], sigma)
        c = point_mass(onboard, h + 0.5 * dt * b[0], v + 0.5 * dt * b[1], gamma + 0.5 * dt * b[2], sigma)
        d = point_mass(onboard, h + dt * c[0], v + dt * c[1], gamma + dt * c[2], sigma)
        h += dt * (a[0] + 2.0 * (b[0] + c[0]) + d[0]) / 6.0
        v += dt * (a[1] + 2.0 * (b[1] + c[1]) + d[1]) / 6.0
        gamma += dt * (a[2] + 2.0 * (b[2] + c[2]) + d[2]) / 6.0
        s += dt * (a[3] + 2.0 * (b[3] + c[3]) + d[3]) / 6.0
        t += dt
    return count, h, gamma


@kernel
def solve_shift(onboard, entry, wanted, final_speed, dt, history):
    """Shift of cos(bank) whose range is ``wanted`` (m), by bisection; the nearest bound when out of reach."""
    low, high = LEAST_COSINE - 1.0, 1.0 - LEAST_COSINE
    for _ in range(40):
        middle = 0.5 * (low + high)
        n, _, _ = fly(onboard, entry, middle, final_speed, dt, history)
        if history[n - 1, 1] < wanted:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def fill_reference(
    onboard: np.ndarray, entry: tuple[float, float, float], wanted: float, final: float
) -> tuple[float, float]:
    """Fly the reference, for a range of ``wanted`` metres if that is to be fitted, and tabulate it into
    ``onboard[0]["reference"]``; returns the altitude (m) and flight-path angle (rad) at which it ends.

    Args:
        onboard: onboard record array of length one, its models filled.
        entry: altitude (m), planet-relative speed (m/s) and flight-path angle (rad) at entry interface.
        wanted: ground range to the aim point, m.
        final: speed at which the range counts, m/s.
    """
    history = np.zeros((STEPS, 5))
    dt = 0.1
    fitted = onboard["guidance"]["entry"]["reference_bank"]["fit_range"][0]
    shift = solve_shift(onboard[0], entry, wanted, final, dt, history) if fitted else 0.0
    n, altitude, path_angle = fly(onboard[0], entry, shift, final, dt, history)
    u, s, drag, cos_path, t = history[:n].T
    drag_rate = np.gradient(drag, t)
    drag_acceleration = np.gradient(drag_rate, t)
    # the energy falls from the moment drag beats nothing; keep the part where it is strictly decreasing
    keep = np.concatenate(([True], np.diff(np.minimum.accumulate(u)) < 0.0))
    nodes = np.linspace(u[keep][-1], u[keep][0], NODES)
    table = onboard["reference"][0]
    table["first"], table["spacing"], table["shift"] = nodes[0], nodes[1] - nodes[0], shift
    columns = {
        "drag": drag,
        "drag_rate": drag_rate,
        "drag_acceleration": drag_acceleration,
        "cos_path": cos_path,
        "range": s[-1] - s,
    }
    for name, values in columns.items():
        table[name] = np.interp(nodes, u[keep][::-1], values[keep][::-1])
    return altitude, path_angle
