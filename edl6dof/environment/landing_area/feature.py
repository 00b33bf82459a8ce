"""Which form a member of a population has, and how it joins what is there already."""

from __future__ import annotations

from edl6dof.environment.landing_area.craters import crater_height
from edl6dof.environment.landing_area.rocks import rock_height
from edl6dof.kernels import kernel


@kernel
def with_member(population, height, diameter, character, square):
    """Height (m) at the ``square`` (m2) of the distance from a member's middle, where what came before gives
    ``height``: a crater adds to it, of rocks the highest stands.
    """
    if population.stands:
        return max(height, rock_height(diameter, square))
    return height + crater_height(diameter, character, square)
