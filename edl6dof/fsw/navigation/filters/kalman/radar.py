"""A look at the radar: range and speed of each beam, one scalar after the other.

A beam that is excluded is still compared with what it should return, so that it can be given back.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.filters.kalman.antenna import place_antenna
from edl6dof.fsw.navigation.filters.kalman.ranges import look_at_ranges
from edl6dof.fsw.navigation.filters.kalman.speeds import look_at_speeds
from edl6dof.jit import kernel


@kernel
def look_at_radar(params, onboard, health, sensed, motion, solution, memory):
    """Take in a fresh look at the radar, into covariance and correction."""
    q, lever, velocity, swing, up, height = place_antenna(onboard, motion, solution, sensed.t)
    radar = sensed.radar
    ranges, off_ranges = look_at_ranges(
        params, onboard, health, radar, q, lever, up, height, solution, memory
    )
    speeds, off_speeds = look_at_speeds(
        params, onboard, health, radar, q, up, velocity, swing, solution, memory
    )
    solution.beams_used, solution.beams_refused, solution.looked = ranges | speeds, off_ranges | off_speeds, 1
    memory.radar_t = sensed.t
