"""Balance of a flight: what its state has become since the start, and what it was given on the way."""

from __future__ import annotations

import numpy as np

from edl6dof.environment.gravity import potential_F
from edl6dof.kernels import kernel
from edl6dof.metrics.figures import from_si
from edl6dof.spatial.frames import rotate_z
from edl6dof.spatial.vector import dot, norm, sub, take3
from edl6dof.vehicle.motion.balance import vehicle_mass
from edl6dof.vehicle.plant import POSITION, VELOCITY
from edl6dof.vehicle.surroundings import planet_rotation


def balance_figures(cases: np.ndarray, plants: np.ndarray) -> dict[str, float]:
    """Errors of the balance of energy, momentum, also that of separations alone, and mass.

    Args:
        cases: the truth of the flight, shape (1,).
        plants: its plant, shape (1,).
    """
    return from_si("balance", _errors(cases, plants))


@kernel
def potential(planet, t, r_I):
    """Potential of gravitation (J/kg) at ``r_I`` (m) and time ``t`` (s)."""
    c, s = planet_rotation(planet, t)
    return potential_F(planet.gravity, rotate_z(c, s, r_I))


@kernel
def _errors(cases, plants):
    """Energy counts from rest in I at the equator of the ellipsoid; its error is the share of that at the
    start, or of the work since if that is more, the error of mass the share of the mass at the start.
    """
    case, plant, kept, planet = cases[0], plants[0], plants[0].balance, cases[0].planet
    v, v_start = take3(plant.y, VELOCITY), take3(kept.v_I, 0)
    momentum = norm(sub(sub(v, v_start), take3(kept.velocity, 0)))
    start = potential(planet, 0.0, take3(kept.r_I, 0))
    end = potential(planet, plant.t, take3(plant.y, POSITION))
    ground = potential(planet, 0.0, (planet.equatorial_radius, 0.0, 0.0))
    kinetic, kinetic_start = 0.5 * dot(v, v), 0.5 * dot(v_start, v_start)
    energy = (kinetic - end) - (kinetic_start - start) - kept.work
    whole = max(kinetic_start + abs(ground - start), abs(kept.work))
    share = abs(energy) / whole if whole > 0.0 else 0.0
    mass = vehicle_mass(case, plant) + kept.lost - kept.mass
    return share, momentum, kept.separations, abs(mass) / kept.mass
