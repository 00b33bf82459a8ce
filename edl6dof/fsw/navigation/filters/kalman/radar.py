"""A look at the radar: speed and range of each beam, one scalar after the other.

What is excluded is still compared with what it should be, so that it can be given back.  The speeds come
first: no ground explains a wrong one, so the beam looks at something else, and its range is worth nothing.
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
    speeds, off_speeds = look_at_speeds(
        params,
        onboard,
        health,
        radar,
        q,
        up=up,
        velocity=velocity,
        swing=swing,
        solution=solution,
        memory=memory,
    )
    ranges, off_ranges = look_at_ranges(
        params,
        onboard,
        health,
        radar,
        speeds,
        q=q,
        lever=lever,
        up=up,
        height=height,
        solution=solution,
        memory=memory,
    )
    solution.beams_used, solution.looked = ranges | speeds, 1
    solution.ranges_refused, solution.speeds_refused = off_ranges, off_speeds
    memory.radar_t = sensed.t
