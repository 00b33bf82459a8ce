"""One base cycle of navigation: from the readings of the instruments to the estimated state."""

from __future__ import annotations

import numpy as np

from edl6dof.fsw.navigation.filters.registry import GIVEN, NAVIGATION_FILTERS
from edl6dof.fsw.navigation.solution import ESTIMATE, INSTRUMENT_HEALTH, MOTION, SOLUTION
from edl6dof.jit import kernel
from edl6dof.spatial.vector import put3, take3

#: What navigation remembers.
NAVIGATION = np.dtype(
    [
        ("estimate", ESTIMATE),
        ("motion", MOTION),
        ("solution", SOLUTION),
        ("health", INSTRUMENT_HEALTH),
        ("filter", NAVIGATION_FILTERS.memory),
    ],
    align=True,
)


@kernel
def take_given(sensed, estimate):
    """Take the word of ideal instruments."""
    for i in range(4):
        estimate.q_I2B[i] = sensed.q_I2B[i]
    put3(estimate.r_I, 0, take3(sensed.r_I, 0))
    put3(estimate.v_I, 0, take3(sensed.v_I, 0))
    put3(estimate.w_B, 0, take3(sensed.w_B, 0))
    put3(estimate.specific_force_B, 0, take3(sensed.specific_force_B, 0))
    put3(estimate.imu_rate_B, 0, take3(sensed.imu_rate_B, 0))
    put3(estimate.imu_gain_B, 0, take3(sensed.imu_gain_B, 0))
    estimate.height_above_ground = sensed.height_above_ground


@kernel
def estimate_state(onboard, sensed, memory):
    """Bring ``memory.estimate`` up to the cycle of ``sensed``.

    Args:
        onboard: ``ONBOARD`` record.
        sensed: ``SENSED`` record.
        memory: ``NAVIGATION`` record, updated.
    """
    estimate = memory.estimate
    estimate.t = sensed.t
    estimate.footpad_contact, estimate.wing_open = sensed.footpad_contact, sensed.wing_open
    if onboard.navigation.filter == GIVEN:
        take_given(sensed, estimate)
