"""One look at the ranges, or at the speeds, of all beams: which dissents, which are taken in, and whether the
solution is wrong instead.

``memory.rows``, ``innovation`` and ``noise`` (variance) hold what each reading sees, by what it differs from
the expected one, and how much it scatters; ``present`` has a bit for each beam of which they do.
"""

from __future__ import annotations

from edl6dof.fsw.navigation.filters.kalman.dissent import dissenting
from edl6dof.fsw.navigation.filters.kalman.reading import take_in
from edl6dof.fsw.navigation.filters.kalman.scalar_update import expected_by, predicted_variance
from edl6dof.fsw.navigation.filters.kalman.states import WIDTH
from edl6dof.jit import kernel


@kernel
def find_dissenting(gate, n_beams, present, healthy, memory):
    """The trusted reading that agrees least with the others and the solution, or ``NONE``.

    A reading that is not there stands alone in the covariance, with nothing to explain.
    """
    spread, rest = memory.spread, memory.rest
    for i in range(n_beams):
        for j in range(i + 1):
            spread[i, j] = spread[j, i] = 0.0
        rest[i], spread[i, i] = 0.0, 1.0
        if present >> i & 1 and healthy[i] != 0:
            row = memory.rows[i]
            own = predicted_variance(memory.covariance, memory.considered, row, memory.product)
            rest[i] = memory.innovation[i] - expected_by(row, memory.correction)
            spread[i, i] = own + memory.noise[i]
            for j in range(i):
                if present >> j & 1 and healthy[j] != 0:
                    common = 0.0
                    for k in range(WIDTH):
                        common += memory.product[k] * memory.rows[j, k]
                    spread[i, j] = spread[j, i] = common
    return dissenting(gate, n_beams, spread, rest)


@kernel
def take_in_look(params, n_beams, present, healthy, up, memory, deviations):
    """Take in the readings that are trusted (``healthy``: flags) and agree.

    Writes the innovation of each over its standard deviation into ``deviations``.  Returns bits of the beams
    that were used, and of those refused; how many trusted readings there were, how many of them were refused,
    and the least square of their innovations.
    """
    left_out = find_dissenting(params.gate, n_beams, present, healthy, memory)
    used, refused, tried, against, least = 0, 0, 0, 0, 0.0
    for beam in range(n_beams):
        deviations[beam] = 0.0
        if present >> beam & 1 == 0:
            continue
        trusted, innovation, row = healthy[beam] != 0, memory.innovation[beam], memory.rows[beam]
        believed = trusted and beam != left_out
        deviation, agrees = take_in(
            params,
            noise=memory.noise[beam],
            innovation=innovation,
            up=up,
            trusted=believed,
            row=row,
            memory=memory,
        )
        agrees = agrees and beam != left_out
        if not agrees:
            refused |= 1 << beam
        if trusted:
            deviations[beam] = deviation
            tried += 1
            if agrees:
                used |= 1 << beam
            else:
                against += 1
                least = innovation**2 if against == 1 else min(least, innovation**2)
    return used, refused, tried, against, least
