"""Radar beams: a ray from the antenna as far as the beam has its echo, in the colour of what navigation makes
of it.
"""

from __future__ import annotations

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SCALAR_HZ, Recorder
from edl6dof.report.figure import rgb
from edl6dof.report.panels import STATES
from edl6dof.telemetry.columns import range_of
from edl6dof.telemetry.instruments import EXCLUDED, NOT_USED, USED

#: Colour of a ray.
RAYS = {state: rgb(STATES[state]) for state in (USED, NOT_USED, EXCLUDED)}


class Beams(Recorder):
    """Writes ``vehicle/beams``, in B; nothing for a vehicle without a radar."""

    def motions(self) -> None:
        """The rays, as long as the range that was read."""
        beams = [one for one in self.flight.instruments if one.kind == "beam"]
        rows = thin(self.t, SCALAR_HZ)
        if not beams or not len(rows):
            return
        reach = np.stack([self.flight[range_of(beam.name)][rows] for beam in beams], axis=-1)
        shown = reach > 0.0
        echo: np.ndarray = np.logical_or.reduce(shown, axis=1)
        keep = echo | np.append(False, echo[:-1])  # a row without a ray ends them
        if not echo.any():
            return
        radar = self.flight.scenario.sensors.radar
        start = np.array(radar.position_m)
        ends = start + (reach[..., None] * [beam.axis for beam in radar.beams])[shown]
        strips = np.stack([np.broadcast_to(start, ends.shape), ends], axis=1)
        tints = np.zeros((*shown.shape, 3), np.uint8)
        for state, colour in RAYS.items():
            tints[np.stack([beam.holds(state)[rows] for beam in beams], axis=-1)] = colour
        rays = self.rr.LineStrips3D.columns(strips=strips, colors=tints[shown])
        entity = f"{self.root}/vehicle/beams"
        self.static(entity, self.rr.LineStrips3D.from_fields(radii=self.rr.Radius.ui_points(1.2)))
        self.columns(entity, self.t[rows[keep]], rays.partition(shown[keep].sum(axis=1)))
