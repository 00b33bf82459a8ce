"""The speeds of a look at the radar: of the antenna along each beam, u . (v_rel + w x l).

Source: as :mod:`.ranges`.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.filters.kalman.beams import locked_beams
from edl6dof.fsw.navigation.filters.kalman.gate import refused_again
from edl6dof.fsw.navigation.filters.kalman.look import take_in_look
from edl6dof.fsw.navigation.filters.kalman.reading import clear
from edl6dof.fsw.navigation.filters.kalman.states import ATTITUDE_ERROR, POSITION, SPEED_SCALE, VELOCITY
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
            speed_row(u, spin, velocity, speed, beam, row=memory.rows[beam])


@kernel
def look_at_speeds(params, onboard, health, radar, q, up, velocity, swing, solution, memory):
    """Take in the speeds along the beams; bits of those that were used, and of those that were refused."""
    n_beams = onboard.instruments.n_beams
    expect_speeds(onboard, radar, q, velocity, swing, memory=memory)
    used, refused, tried, against, least = take_in_look(
        params,
        n_beams,
        present=locked_beams(radar, n_beams),
        healthy=health.beam_speed,
        up=up,
        memory=memory,
        deviations=solution.speed_innovation,
    )
    if tried > 1:  # a beam alone may be wrong itself
        memory.speeds_refused = refused_again(memory.speeds_refused, against, tried)
    if memory.speeds_refused >= params.patience:
        for i in range(VELOCITY, VELOCITY + 3):
            memory.covariance[i, i] += least
        memory.speeds_refused = 0
    return used, refused
