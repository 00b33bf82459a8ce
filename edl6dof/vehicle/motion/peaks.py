"""The largest loads that the vehicle has met."""

from __future__ import annotations

from edl6dof.jit import kernel
from edl6dof.spatial.vector import norm, take3
from edl6dof.vehicle.parachutes.parachute import PACKED, RELEASED


@kernel
def update_peaks(plant, outputs, peaks):
    """Bring ``peaks`` up to date with ``outputs``: the load of the entry up to the first deployment of a
    parachute, that under a parachute by itself.  What the ground does to the vehicle is no load of flight.
    """
    if outputs.pads == 0:
        load = norm(take3(outputs.specific_force_B, 0))
        if plant.canopy == PACKED:
            peaks.entry_load = max(peaks.entry_load, load)
        elif plant.canopy != RELEASED:
            peaks.parachute_load = max(peaks.parachute_load, load)
    peaks.dynamic_pressure = max(peaks.dynamic_pressure, outputs.dynamic_pressure)
    peaks.heat_flux = max(peaks.heat_flux, outputs.heat_flux)
    peaks.riser_tension = max(peaks.riser_tension, outputs.riser_tension)
