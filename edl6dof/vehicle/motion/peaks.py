"""The largest loads that the vehicle has met."""

from __future__ import annotations

from edl6dof.kernels import kernel
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
            if load > peaks.entry_load:
                peaks.entry_load, peaks.entry_load_time = load, plant.t
        elif plant.canopy != RELEASED:
            peaks.parachute_load = max(peaks.parachute_load, load)
    if outputs.dynamic_pressure > peaks.dynamic_pressure:
        peaks.dynamic_pressure, peaks.dynamic_pressure_time = outputs.dynamic_pressure, plant.t
    if outputs.heat_flux > peaks.heat_flux:
        peaks.heat_flux, peaks.heat_flux_time = outputs.heat_flux, plant.t
    peaks.riser_tension = max(peaks.riser_tension, outputs.riser_tension)
