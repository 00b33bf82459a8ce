"""An entry guidance law of your own: constant drag to the aim point.

The drag that uses up the kinetic energy over the range to go is D* = (V^2 - V_f^2) / (2 s); more lift up when
the measured drag is above it, less when below.  Source: the constant-drag segment of the Shuttle entry
(Harpold & Graves 1979).
"""

from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import acos
from edl6dof.spatial.vector import clamp


class EnergyLawParams(Params):
    """Constant drag to the aim point."""

    level_cosine: float = param(0.2, "cosine of the bank angle on the profile", ge=-1.0, le=1.0)
    gain: float = param(2.0, "change of that cosine per relative drag error", ge=0.0, le=20.0)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Wanted bank angle (rad)."""
    p, final = params, onboard.guidance.entry.final_speed
    out.reference_drag = (nav.speed**2 - final**2) / (2.0 * max(out.range_to_go, 1e3))
    error = nav.drag / max(out.reference_drag, 0.1) - 1.0
    return acos(clamp(p.level_cosine + p.gain * error, -1.0, 1.0))


FAMILY = "entry_law"
MEMBER = Member("energy_law", EnergyLawParams, {"guide": guide}, "constant drag, Harpold & Graves 1979")
