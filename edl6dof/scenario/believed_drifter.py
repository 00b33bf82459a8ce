"""What the flight computer believes of the backshell that leaves the lander, with the canopy above it."""

from __future__ import annotations

from math import pi

import numpy as np

from edl6dof.vehicle.vehicle import VehicleParams


def believe_drifter(record: np.void, vehicle: VehicleParams) -> None:
    """Fill a ``DRIFTER`` record of zeros from the nominal backshell and the parachute that it carries; of a
    vehicle without one it stays zero.
    """
    masses = {part.name: part.mass_kg for part in vehicle.parts}
    shells = [part for part in vehicle.parts if part.shape == "backshell"]
    for chute in vehicle.parachutes:
        if shells and chute.carried_by == shells[0].name:
            record["mass"] = shells[0].mass_kg + (masses[chute.pack] if chute.pack is not None else 0.0)
            canopy = pi / 4.0 * chute.diameter_m * chute.diameter_m * chute.drag_coefficient
            record["drag_area"] = shells[0].drag_area_m2 + canopy
            record["length"] = chute.line_length_m
