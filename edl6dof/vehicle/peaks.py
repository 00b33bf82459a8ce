"""The largest loads that the vehicle has met."""

from __future__ import annotations

from edl6dof.jit import kernel
from edl6dof.spatial.vector import norm, take3


@kernel
def note_peaks(plant):
    """Bring ``plant.peaks`` up to date with ``plant.out``; what the ground does to the vehicle is no load of
    flight.
    """
    out, peaks = plant.out, plant.peaks
    if out.pads == 0:
        peaks.load = max(peaks.load, norm(take3(out.specific_force_B, 0)))
    peaks.dynamic_pressure = max(peaks.dynamic_pressure, out.dynamic_pressure)
    peaks.heat_flux = max(peaks.heat_flux, out.heat_flux)
    peaks.riser_tension = max(peaks.riser_tension, out.riser_tension)
