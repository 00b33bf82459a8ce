"""The shape of a parachute: canopy and lines, in the size that the vehicle file gives."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np

from edl6dof.replay.scene.mesh import ORANGE, RGB, WHITE, Mesh, merge, revolve
from edl6dof.vehicle.vehicle import VehicleParams


def canopy(vehicle: VehicleParams, number: int) -> tuple[Mesh, np.ndarray]:
    """Disk-gap-band canopy of a parachute of the vehicle, and its lines; x from the bridle confluence to the
    canopy, skirt at the line length.

    Returns:
        mesh, and the lines as segments (n, 2, 3).
    """
    diameter, length = vehicle.parachutes[number].diameter_m, vehicle.parachutes[number].line_length_m
    r, band, gap, height = 0.34 * diameter, 0.12 * diameter, 0.035 * diameter, 0.20 * diameter
    gores, vent = 24, 0.06

    def paint(i: int, j: int) -> RGB:
        return ORANGE if i // 2 % 2 == 0 else WHITE

    skirt = length
    dome = [(skirt + band + gap + height * cos(a), r * sin(a)) for a in np.linspace(vent, pi / 2.0, 10)]
    mesh = merge(
        [
            revolve(
                [(skirt, 0.97 * r), (skirt + band, r)],
                lambda i, j: ORANGE if i // 6 % 2 == 0 else WHITE,
                2 * gores,
            ),
            revolve(dome, paint, 2 * gores),
        ]
    )
    turn = np.linspace(0.0, 2.0 * pi, gores, endpoint=False)
    rim = np.stack([np.full(gores, skirt), 0.97 * r * np.cos(turn), 0.97 * r * np.sin(turn)], axis=-1)
    riser = np.array([0.13 * length, 0.0, 0.0])
    top = rim + [band + gap, 0.0, 0.0]
    lines = [
        np.stack([np.broadcast_to(riser, rim.shape), rim], axis=1),
        np.stack([rim + [band, 0.0, 0.0], top], axis=1),
    ]
    return mesh, np.concatenate([np.array([[[0.0, 0.0, 0.0], riser]]), *lines])
