"""The models that each of ``vehicle.parachutes`` may name as its ``model``: how the canopy fills, and its
drag over Mach number.

A member has two kernels.  ``inflation(params, chute, since_line_stretch)`` gives the share of the full drag
area at a time (s) after line stretch, in the end 1; ``efficiency(params, chute, mach)`` gives the axial force
over its value at low Mach number.  ``params`` are the member's own, ``chute`` what all parachutes have.
"""

from __future__ import annotations

from edl6dof.registry import Family
from edl6dof.vehicle.parachutes.models import disk_gap_band, reefed

PARACHUTE_MODELS = Family("parachute model", (disk_gap_band.MEMBER, reefed.MEMBER))

ParachuteChoice = PARACHUTE_MODELS.params_model(
    "ParachuteChoice", "model", "disk_gap_band", "How a canopy fills and drags.", bare=True
)

inflation_of_model = PARACHUTE_MODELS.switch("inflation", "params", "chute", "since_line_stretch")
efficiency_of_model = PARACHUTE_MODELS.switch("efficiency", "params", "chute", "mach")
