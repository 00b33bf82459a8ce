"""One scalar reading: through the gate into covariance and correction."""

from __future__ import annotations

from math import sqrt

from edl6dof.fsw.navigation.filters.kalman.gate import weighted_noise
from edl6dof.fsw.navigation.filters.kalman.scalar_update import (
    expected_by,
    fold_in,
    predicted_variance,
    weigh,
)
from edl6dof.fsw.navigation.filters.kalman.states import POSITION, WIDTH
from edl6dof.jit import kernel
from edl6dof.spatial.vector import dot, put3, scale, take3


@kernel
def clear(row):
    """A row of nothing."""
    for j in range(WIDTH):
        row[j] = 0.0


@kernel
def keep_place(up, gain):
    """Let a reading move the position along ``up`` alone.

    Radar and stars see where over the planet the vehicle is through the direction of the vertical, a few
    micrometres per second squared for a hundred metres: less than beams out of place, slopes and the gravity
    of mountains feign.  So the place is considered, with what it means for the other states, and not
    estimated.
    """
    put3(gain, POSITION, scale(dot(up, take3(gain, POSITION)), up))


@kernel
def take_in(params, noise, innovation, up, trusted, row, memory):
    """Take a reading that sees ``row`` into the covariance and the correction, if the gate lets it and it is
    ``trusted``.

    Returns its innovation over its standard deviation, and whether the gate lets it.
    """
    own = predicted_variance(memory.covariance, memory.considered, row, memory.product)
    rest = innovation - expected_by(row, memory.correction)
    variance = own + noise
    weighted = weighted_noise(rest, variance, noise, params.gate, params.huber)
    if trusted and weighted >= 0.0:
        weigh(memory.product, own + weighted, memory.gain)
        keep_place(up, memory.gain)
        fold_in(
            memory.covariance,
            memory.product,
            memory.gain,
            memory.correction,
            variance=own + weighted,
            innovation=rest,
        )
    return rest / sqrt(variance), weighted >= 0.0
