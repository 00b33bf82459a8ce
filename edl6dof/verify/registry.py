"""All check cases, in the order they are shown; a new one is a file here and a line below."""

from __future__ import annotations

from edl6dof.verify.cases import (
    allen_eggers,
    capsule_trim,
    damping,
    equilibrium_glide,
    frames,
    gravity_field,
    impulses,
    jettison,
    kepler,
    nesc,
    pendulum,
    point_mass,
    rk4_order,
    rocket_equation,
    rotations,
    symmetric_top,
    terminal_velocity,
    tumbling,
    us76_table,
)
from edl6dof.verify.outcome import Oracle

CASES: dict[str, Oracle] = {
    module.__name__.rpartition(".")[2]: module.run
    for module in (
        rotations,
        frames,
        us76_table,
        gravity_field,
        rk4_order,
        kepler,
        tumbling,
        symmetric_top,
        allen_eggers,
        equilibrium_glide,
        point_mass,
        capsule_trim,
        damping,
        impulses,
        rocket_equation,
        jettison,
        terminal_velocity,
        pendulum,
        nesc,
    )
}
