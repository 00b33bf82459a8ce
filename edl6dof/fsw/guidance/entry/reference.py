"""Reference trajectory: the entry planned before the flight, with an open-loop bank profile.

It is computed on the ground (:mod:`edl6dof.scenario.planned_entry`) with a bank profile that is linear in
speed between points and constant beyond the ends. By default the profile is shifted, by one number added to
cos(bank), so that it ends at the aim point. Its drag and range are tabulated over the square root of twice
the specific energy, which is near the speed. Sources: bank profile in segments over speed, Zheng & Cui 2015,
section 3.2; with linear ones, Yan, Sun & Guo 2016, section 3.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Annotated, Self

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Capacity, Params, param
from edl6dof.fsw.guidance.entry.airframe import believed_aero
from edl6dof.fsw.navigation.derived import model_atmosphere
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.spatial import arrays
from edl6dof.spatial.elementary import acos, cos, sin
from edl6dof.spatial.table_index import held_cell
from edl6dof.spatial.vector import clamp

MAX_POINTS = 32


class BankPoint(Params):
    """One point of a bank profile."""

    at: float = param(REQUIRED, "speed in m/s, or time from t = 0 in s", ge=0.0, le=20e3)
    bank_deg: float = param(
        REQUIRED, "bank angle at the point; linear between points, constant beyond them", ge=-180.0, le=180.0
    )


def must_ascend(points: Sequence[BankPoint]) -> None:
    """Refuse points that do not ascend.

    Raises:
        ValueError: the points do not ascend.
    """
    if any(after.at <= before.at for before, after in zip(points, points[1:], strict=False)):
        raise ValueError("the points must ascend in 'at'")


@kernel
def bank_at(points, count, x):
    """Bank angle (rad) of the first ``count`` ``points`` at speed or time ``x``."""
    if x <= points[0].at:
        return points[0].bank
    for i in range(count - 1):
        low, high = points[i], points[i + 1]
        if x < high.at:
            return low.bank + (x - low.at) / (high.at - low.at) * (high.bank - low.bank)
    return points[count - 1].bank


NODES = 256
#: Standard deviation of the window that smooths the planned drag, s.
SMOOTHED = 1.0


class ReferenceBankParams(Params):
    """Open-loop bank profile of the reference trajectory: magnitude over speed; zero in heading alignment."""

    points: Annotated[list[BankPoint], Capacity(MAX_POINTS)] = param(
        None,
        "points of the profile, ascending in speed (m/s); magnitudes",
        factory=lambda: [BankPoint(at=1500.0, bank_deg=90.0)],
        min_length=1,
        max_length=MAX_POINTS,
    )
    fit_range: bool = param(
        True, "whether cos(bank) is shifted, by one constant, so that the reference ends at the aim point"
    )

    @model_validator(mode="after")
    def _ascend(self) -> Self:
        must_ascend(self.points)
        if any(point.bank_deg < 0.0 for point in self.points):
            raise ValueError("the points must have no negative bank_deg: the side is the reversal logic's")
        return self


REFERENCE = record(
    ("first", "f8"),  # m/s: sqrt(2E) of the first node, at the end of the entry
    ("spacing", "f8"),  # m/s: from node to node
    ("shift", "f8"),  # of cos(bank)
    ("handover", "f8"),  # m/s: sqrt(2E) where range control ends; ``first`` without heading alignment
    ("coast", "f8"),  # m: planned range from there to the end
    ("drag", "f8", (NODES,)),
    ("drag_rate", "f8", (NODES,)),
    ("drag_acceleration", "f8", (NODES,)),
    ("ground", "f8", (NODES,)),  # drag times ground range per energy: near cos(gamma) R/r
)

#: The planned entry in rows from the start to where the parachute opens.
PLANNED = record(
    ("t", "f8"),  # s
    ("altitude", "f8"),  # m
    ("speed", "f8"),  # m/s, relative to the planet
    ("path_angle", "f8"),  # rad
    ("azimuth", "f8"),  # rad
    ("energy", "f8"),  # J/kg
    ("beyond", "f8"),  # m, downrange beyond the aim point, on the great circle from the start
    ("aside", "f8"),  # m, crossrange, positive right of the aim point
    ("latitude", "f8"),  # rad
    ("longitude", "f8"),  # rad
    ("bank", "f8"),  # rad, commanded
    ("side", "f8"),  # +1 to bank right, -1 left; 0 before the steering has chosen
    ("mach", "f8"),
    ("drag", "f8"),  # m/s2, in the expected wind, as load and dynamic pressure
    ("load", "f8"),  # m/s2
    ("dynamic_pressure", "f8"),  # Pa
    ("density", "f8"),  # kg/m3
)


@kernel
def point_mass(onboard, h, v, gamma, bank):
    """Rates of altitude (m/s), speed (m/s2), flight-path angle (rad/s) and ground range (m/s), and the drag
    acceleration (m/s2).
    """
    planet, vehicle = onboard.planet, onboard.vehicle
    r = planet.equatorial_radius + h
    g = planet.mu / (r * r)
    density, sound, _ = model_atmosphere(onboard.atmosphere, h)
    area, lift_to_drag = believed_aero(vehicle, v / sound, v)
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
    """Bank angle (rad) of the open-loop profile at ``speed`` (m/s), its cosine shifted by ``shift``, within
    the limits of all laws; zero in heading alignment, where the bank is to either side.
    """
    entry = onboard.guidance.entry
    if speed <= max(entry.align_speed, entry.heading.speed):
        return 0.0
    p = entry.reference_bank
    wanted = cos(bank_at(p.points, p.n_points, speed)) + shift
    return acos(clamp(wanted, cos(entry.bank_max), cos(entry.bank_min)))


@kernel
def node_of(reference, energy_speed):
    """Node below ``energy_speed`` = sqrt(2E) (m/s) and fraction of the way to the next; limited to
    the ends.
    """
    return held_cell((energy_speed - reference.first) / reference.spacing, NODES - 1)


def last_controlled(planned: np.ndarray, entry: np.void) -> int:
    """Index of the row of a plan at which heading alignment or level wings end range control, or the last."""
    ended = planned["speed"] <= max(entry["align_speed"], entry["heading"]["speed"])
    return int(np.argmax(ended)) if ended.any() else len(planned) - 1


def fill_reference(planned: np.ndarray, table: np.void, end: int) -> None:
    """Tabulate the planned entry into a ``REFERENCE`` record; its shift is kept. ``end``: row at which range
    control ends.

    The drag is smoothed first, over a few seconds, so that the short lift-up of a reversal, which comes at
    another time in flight, leaves no step in the derivatives. The derivatives are those of the tabulated drag
    along the planned loss of energy; the ground range matches the plan along the tabulated drag.
    """
    t, energy = planned["t"], planned["energy"]
    u = np.sqrt(2.0 * np.maximum(energy, 0.0))
    drag = _smoothed(t, planned["drag"])
    rate = np.gradient(drag, t)
    # keep the part in which the energy is strictly decreasing
    keep = np.concatenate(([True], np.diff(np.minimum.accumulate(u)) < 0.0))
    nodes = np.linspace(u[keep][-1], u[keep][0], NODES)
    table["first"], table["spacing"] = nodes[0], nodes[1] - nodes[0]
    table["handover"], table["coast"] = u[end], planned["beyond"][-1] - planned["beyond"][end]
    columns = {
        "drag": drag,
        "drag_rate": rate,
        "drag_acceleration": np.gradient(rate, t),
        "ground": -drag * np.gradient(planned["beyond"], t) / np.gradient(energy, t),
    }
    for name, values in columns.items():
        table[name] = arrays.interpolate(nodes, u[keep][::-1], values[keep][::-1])


def _smoothed(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return weighted means of positive ``values``, of their logarithms, over a window of ``SMOOTHED``
    seconds: a normal window times 1.5 - 0.5 x^2, which preserves a parabola and so the peak of drag.
    """
    even = t[0] + (t[1] - t[0]) * np.arange(ceil((t[-1] - t[0]) / (t[1] - t[0])))
    reach = int(4.0 * SMOOTHED / (t[1] - t[0]))
    x2 = np.square(np.arange(-reach, reach + 1) * (t[1] - t[0]) / SMOOTHED)
    window = arrays.exp(-0.5 * x2) * (1.5 - 0.5 * x2)
    logs = np.pad(
        arrays.interpolate(even, t, arrays.log(np.maximum(values, 1e-12))),
        reach,
        mode="reflect",
        reflect_type="odd",
    )
    means = np.zeros_like(even)
    for k, weight in enumerate(window / window.sum()):
        means += weight * logs[k : k + len(even)]
    return arrays.exp(arrays.interpolate(t, even, means))
