"""The largest loads that the vehicle has met."""

from __future__ import annotations

from edl6dof.jit import kernel
from edl6dof.spatial.vector import norm, take3


@kernel
def update_peaks(outputs, peaks):
    """Bring ``peaks`` up to date with ``outputs``; what the ground does to the vehicle is no load of
    flight.
    """
    if outputs.pads == 0:
        peaks.load = max(peaks.load, norm(take3(outputs.specific_force_B, 0)))
    peaks.dynamic_pressure = max(peaks.dynamic_pressure, outputs.dynamic_pressure)
    peaks.heat_flux = max(peaks.heat_flux, outputs.heat_flux)
    peaks.riser_tension = max(peaks.riser_tension, outputs.riser_tension)
