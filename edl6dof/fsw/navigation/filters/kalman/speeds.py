"""The speeds of a look at the radar: of the antenna along each beam, u . (v_rel + w x l).

Source: as :mod:`.ranges`.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.filters.kalman.beams import usable
from edl6dof.fsw.navigation.filters.kalman.dissent import dissenting
from edl6dof.fsw.navigation.filters.kalman.gate import refused_again
from edl6dof.fsw.navigation.filters.kalman.reading import clear, take_in
from edl6dof.fsw.navigation.filters.kalman.scalar_update import expected_by, predicted_variance
from edl6dof.fsw.navigation.filters.kalman.states import (
    ATTITUDE_ERROR,
    POSITION,
    SPEED_SCALE,
    VELOCITY,
    WIDTH,
)
from edl6dof.jit import kernel
from edl6dof.spatial.quaternion import from_frame
from edl6dof.spatial.vector import add, cross, dot, put3, take3


@kernel
def speed_row(u, spin, velocity, speed, beam, row):
    """Write what the speed of a ``beam`` along ``u`` sees of the errors; ``velocity`` is that of the
    centre of mass relative to a planet that turns at ``spin``.
    """
    clear(row)
    put3(row, POSITION, (-spin * u[1], spin * u[0], 0.0))
    put3(row, VELOCITY, u)
    put3(row, ATTITUDE_ERROR, cross(u, velocity))
    row[SPEED_SCALE + beam] = speed


@kernel
def expect_speeds(onboard, radar, q, velocity, swing, memory):
    """Fill ``rows``, ``innovation`` and ``noise`` (variance) of ``memory`` for every beam with an echo."""
    instruments, spin = onboard.instruments, onboard.planet.rotation_rate
    for beam in range(instruments.n_beams):
        if radar.locked[beam] != 0:
            u = from_frame(q, take3(instruments.beam_axis[beam], 0))
            speed = dot(u, add(velocity, swing))
            memory.innovation[beam] = radar.speed[beam] - speed
            own = instruments.speed_sigma + instruments.speed_sigma_relative * abs(speed)
            memory.noise[beam] = own**2
            speed_row(u, spin, velocity, speed, beam, memory.rows[beam])


@kernel
def find_dissenting(params, n_beams, health, radar, memory):
    """The usable beam whose speed agrees least with the others and the solution, or ``NONE``.

    A beam that is not usable stands alone in the covariance, with nothing to explain.
    """
    spread, rest = memory.spread, memory.rest
    for i in range(n_beams):
        counts = usable(health, radar, i)
        for j in range(i + 1):
            spread[i, j] = spread[j, i] = 0.0
        rest[i], spread[i, i] = 0.0, 1.0
        if counts:
            row = memory.rows[i]
            own = predicted_variance(memory.covariance, memory.considered, row, memory.product)
            rest[i] = memory.innovation[i] - expected_by(row, memory.correction)
            spread[i, i] = own + memory.noise[i]
            for j in range(i):
                if usable(health, radar, j):
                    common = 0.0
                    for k in range(WIDTH):
                        common += memory.product[k] * memory.rows[j, k]
                    spread[i, j] = spread[j, i] = common
    return dissenting(params.gate, n_beams, spread, rest)


@kernel
def look_at_speeds(params, onboard, health, radar, q, up, velocity, swing, solution, memory):
    """Take in the speeds along the beams; bits of those that were used, and of those that were refused."""
    n_beams = onboard.instruments.n_beams
    expect_speeds(onboard, radar, q, velocity, swing, memory)
    left_out = find_dissenting(params, n_beams, health, radar, memory)
    used, refused, tried, against, least = 0, 0, 0, 0, 0.0
    for beam in range(n_beams):
        solution.speed_innovation[beam] = 0.0
        if radar.locked[beam] == 0:
            continue
        trusted, innovation, row = health.beam[beam] != 0, memory.innovation[beam], memory.rows[beam]
        believed = trusted and beam != left_out
        deviation, agrees = take_in(params, memory.noise[beam], innovation, up, believed, row, memory)
        agrees = agrees and beam != left_out
        if not agrees:
            refused |= 1 << beam
        if trusted:
            solution.speed_innovation[beam] = deviation
            tried += 1
            if agrees:
                used |= 1 << beam
            else:
                against += 1
                least = innovation**2 if against == 1 else min(least, innovation**2)
    if tried > 1:  # a beam alone may be wrong itself
        memory.speeds_refused = refused_again(memory.speeds_refused, against, tried)
    if memory.speeds_refused >= params.patience:
        for i in range(VELOCITY, VELOCITY + 3):
            memory.covariance[i, i] += least
        memory.speeds_refused = 0
    return used, refused
