"""Update of the error-state filter by a position fix from landmarks.

The fix is that of the exposure, carried on by the solution's own way since then. Its error therefore contains
the way by the velocity error, the attitude error at the sensitivity of the fix, and the displacement of the
map, a considered error that all fixes share. Gaussian elimination decorrelates the three components (L D L').

Source: Bierman, Factorization Methods for Discrete Sequential Estimation (1977), chapter III: whitening of
correlated readings; Schmidt 1966, considered errors.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.filters.kalman.measurement_update import (
    apply_gain,
    clear_row,
    explained_by,
    optimal_gain,
    predicted_variance,
    weighted_noise,
)
from edl6dof.fsw.navigation.filters.kalman.states import (
    ATTITUDE_ERROR,
    MAP_OFFSET,
    POSITION,
    VELOCITY,
    WIDTH,
)
from edl6dof.kernels import kernel
from edl6dof.spatial.vector import put3, take3


@kernel
def update_by_landmarks(params, fix, memory):
    """Update covariance and correction with a ``fix`` (``POSITION_FIX``)."""
    rows, innovation, spread = memory.rows, memory.innovation, memory.spread
    for i in range(3):
        clear_row(rows[i])
        rows[i, POSITION + i] = rows[i, MAP_OFFSET + i] = 1.0
        rows[i, VELOCITY + i] = -fix.age
        put3(rows[i], ATTITUDE_ERROR, take3(fix.turn[i], 0))
        innovation[i] = fix.error[i]
        put3(spread[i], 0, take3(fix.covariance[i], 0))
    for k in range(3):
        for i in range(k + 1, 3):
            factor = spread[i, k] / spread[k, k]
            innovation[i] -= factor * innovation[k]
            for j in range(3):
                spread[i, j] -= factor * spread[k, j]
            for j in range(WIDTH):
                rows[i, j] -= factor * rows[k, j]
    for i in range(3):
        row, noise = rows[i], spread[i, i]
        own = predicted_variance(memory.covariance, memory.considered, row, memory.product)
        rest = innovation[i] - explained_by(row, memory.correction)
        weighted = weighted_noise(rest, own + noise, noise, params.gate, params.huber)
        if weighted >= 0.0:
            optimal_gain(memory, own + weighted)
            apply_gain(memory, own + weighted, rest)
