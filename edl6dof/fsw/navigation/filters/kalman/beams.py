"""Which beams of the radar there are to look at."""

from __future__ import annotations

from edl6dof.kernels import kernel


@kernel
def usable(healthy, radar, beam):
    """Whether a beam has an echo, and its range or speed is trusted by the flags ``healthy``."""
    return healthy[beam] != 0 and radar.locked[beam] != 0


@kernel
def count_usable(health, radar, n_beams):
    """How many beams have an echo of which range or speed is trusted."""
    count = 0
    for beam in range(n_beams):
        count += usable(health.beam_range, radar, beam) or usable(health.beam_speed, radar, beam)
    return count


@kernel
def locked_beams(radar, n_beams):
    """Bits of the beams that have an echo."""
    bits = 0
    for beam in range(n_beams):
        bits |= radar.locked[beam] << beam
    return bits
