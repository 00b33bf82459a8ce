"""Reference trajectory: a point mass over a non-rotating sphere with onboard density, drag and lift, at constant bank.

Flown once on the ground before the mission: the bank angle is solved so that the range from entry interface to the aim point is met at
parachute speed.  What guidance needs of it is tabulated over the square root of twice the specific energy, which is near the speed.
Equations of motion: Wu, Cui & Cui 2013, eqs. 1-3 and 7.
"""

from __future__ import annotations

from math import cos, sin, sqrt

import numpy as np

from edl6dof.fsw.navigation import model_atmosphere
from edl6dof.jit import kernel

NODES = 256
STEPS = 6000

REFERENCE = np.dtype(
    [
        ("first", "f8"),
        ("spacing", "f8"),
        ("bank", "f8"),
        ("drag", "f8", (NODES,)),
        ("drag_rate", "f8", (NODES,)),
        ("drag_acceleration", "f8", (NODES,)),
        ("cos_path", "f8", (NODES,)),
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
    density, _, _ = model_atmosphere(onboard.atmosphere, h)
    drag = 0.5 * density * v * v * vehicle.drag_area / vehicle.entry_mass
    lift = drag * vehicle.lift_to_drag
    return (
        v * sin(gamma),
        -drag - g * sin(gamma),
        lift * cos(bank) / v + (v / r - g / v) * cos(gamma),
        v * cos(gamma) * planet.equatorial_radius / r,
        drag,
    )


@kernel
def fly(onboard, entry, bank, align_speed, final_speed, dt, history):
    """Fly the point mass to ``final_speed``; rows of ``history`` are (sqrt(2E), range, drag, cos gamma, time). Returns the row count.

    ``entry`` is (altitude, speed, flight-path angle, curvature radius correction of the true altitude datum = 0).
    """
    h, v, gamma, s, t = entry[0], entry[1], entry[2], 0.0, 0.0
    planet = onboard.planet
    count = 0
    while v > final_speed and h > -5000.0 and count < history.shape[0]:
        sigma = bank if v > align_speed else 0.0
        a = point_mass(onboard, h, v, gamma, sigma)
        energy = 0.5 * v * v + planet.mu * (1.0 / planet.equatorial_radius - 1.0 / (planet.equatorial_radius + h))
        row = history[count]
        row[0], row[1], row[2], row[3], row[4] = sqrt(2.0 * max(energy, 0.0)), s, a[4], cos(gamma), t
        count += 1
        b = point_mass(onboard, h + 0.5 * dt * a[0], v + 0.5 * dt * a[1], gamma + 0.5 * dt * a[2], sigma)
        c = point_mass(onboard, h + 0.5 * dt * b[0], v + 0.5 * dt * b[1], gamma + 0.5 * dt * b[2], sigma)
        d = point_mass(onboard, h + dt * c[0], v + dt * c[1], gamma + dt * c[2], sigma)
        h += dt * (a[0] + 2.0 * (b[0] + c[0]) + d[0]) / 6.0
        v += dt * (a[1] + 2.0 * (b[1] + c[1]) + d[1]) / 6.0
        gamma += dt * (a[2] + 2.0 * (b[2] + c[2]) + d[2]) / 6.0
        s += dt * (a[3] + 2.0 * (b[3] + c[3]) + d[3]) / 6.0
        t += dt
    return count


@kernel
def solve_bank(onboard, entry, wanted, align_speed, final_speed, dt, history):
    """Constant bank angle (rad) whose range is ``wanted`` (m), by bisection on its cosine; the nearest bound when out of reach."""
    low, high = -0.5, 1.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        bank = np.arccos(middle)
        n = fly(onboard, entry, bank, align_speed, final_speed, dt, history)
        if history[n - 1, 1] < wanted:
            low = middle
        else:
            high = middle
    return np.arccos(0.5 * (low + high))


def fill_reference(onboard: np.ndarray, entry: tuple[float, float, float], wanted: float, align: float, final: float) -> None:
    """Solve the reference for a range of ``wanted`` metres and tabulate it into ``onboard[0]["reference"]``.

    Args:
        onboard: onboard record array of length one, its models filled.
        entry: altitude (m), planet-relative speed (m/s) and flight-path angle (rad) at entry interface.
        wanted: ground range to the aim point, m.
        align: speed below which the bank angle is zero, m/s.
        final: speed at which the range counts, m/s.
    """
    history = np.zeros((STEPS, 5))
    dt = 0.1
    bank = solve_bank(onboard[0], entry, wanted, align, final, dt, history)
    n = fly(onboard[0], entry, bank, align, final, dt, history)
    u, s, drag, cos_path, t = history[:n].T
    drag_rate = np.gradient(drag, t)
    drag_acceleration = np.gradient(drag_rate, t)
    # the energy falls from the moment drag beats nothing; keep the part where it is strictly decreasing
    keep = np.concatenate(([True], np.diff(np.minimum.accumulate(u)) < 0.0))
    nodes = np.linspace(u[keep][-1], u[keep][0], NODES)
    table = onboard["reference"][0]
    table["first"], table["spacing"], table["bank"] = nodes[0], nodes[1] - nodes[0], bank
    columns = {
        "drag": drag,
        "drag_rate": drag_rate,
        "drag_acceleration": drag_acceleration,
        "cos_path": cos_path,
        "range": s[-1] - s,
    }
    for name, values in columns.items():
        table[name] = np.interp(nodes, u[keep][::-1], values[keep][::-1])
