"""Sensors that see the ground: rays of the lidar, map of hazards with its spots, and beams of the radar."""

from __future__ import annotations

import numpy as np

from edl6dof.interface.capacities import SCAN_COLUMNS, SCAN_ROWS
from edl6dof.interface.sensed import cell_direction
from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SCALAR_HZ, Recorder, and_next
from edl6dof.replay.scene.landscape import sunlight
from edl6dof.replay.scene.mesh import RGB, Mesh, bright, open_grid_triangles
from edl6dof.report.catalogue import CELLS, STATES
from edl6dof.report.flight.common import circle
from edl6dof.report.palette import rgb
from edl6dof.spatial import rotations as turns
from edl6dof.telemetry.columns import EXCLUDED, NOT_USED, USED, range_of
from edl6dof.telemetry.landing_map import CELL_CLASSES, LandingMap

#: Columns of the navigation error, by which a map in navigated coordinates is moved to its true place.
NAVIGATED = ("nav.error_east_m", "nav.error_north_m")
#: Colour of each class of cell, of the chosen spot, of spots passed over, and of a ray of the lidar.
PAINT = {name: rgb(colour) for name, (_, colour) in CELLS.items()}
CHOSEN: RGB = (245, 250, 255)
PASSED_OVER: RGB = (230, 150, 225)
RAY: RGB = (120, 235, 140)
#: Colour of a ray of the radar by its state.
RAYS = {state: rgb(STATES[state]) for state in (USED, NOT_USED, EXCLUDED)}
#: Height (m) above the ground at which the map is drawn, and number of cells from one vertex to the next.
_ABOVE, _EVERY = 0.04, 2
#: Number of rays of a row that are drawn.
_RAYS = 17


class Hazards(Recorder):
    """Recorder of ``/site/hazards``, for a flight that chose a spot from a scan."""

    def motions(self) -> None:
        """Write rays, map and spots."""
        found = self.flight.landing_map
        if found is None:
            return
        since, chosen = self.when["scan"], self.when["spot"]
        rows = np.flatnonzero((self.t >= since) & (self.t <= chosen))
        if not len(rows):
            return
        self._rays(rows, since, chosen)
        # places on the map contain the navigation error at the start of the scan
        off = np.array([np.interp(since, self.t, self.flight[name]) for name in NAVIGATED])
        self.at(chosen, "site/hazards/map", self.mesh(self._painted(found, off)))
        if len(found.rejected_m):
            places = self._on_ground(found.rejected_m - off, 0.3)
            passed = self.rr.Points3D(places, colors=PASSED_OVER, radii=-3.5)
            self.at(chosen, "site/hazards/passed_over", passed)
        self._chosen(found, off, chosen)
        self._legend(found, off, chosen)

    def _chosen(self, found: LandingMap, off: np.ndarray, t: float) -> None:
        """Write the footprint around the chosen spot, as a ring."""
        radius = self.flight.scenario.flight_software.hazard.footprint_radius_m
        around = np.column_stack(circle((found.spot_m - off).tolist(), radius, 49))
        ring = self.rr.LineStrips3D([self._on_ground(around, 0.15)], colors=CHOSEN, radii=-2.5)
        self.at(t, "site/hazards/chosen", ring)
        (middle,) = self._on_ground((found.spot_m - off)[None], 0.3)
        words = f"{'chosen' if found.found else 'least bad'} spot"
        self.at(t, "site/hazards/spot", self.point(middle, words, CHOSEN, 3.0))

    def _legend(self, found: LandingMap, off: np.ndarray, t: float) -> None:
        """Write a mark and words for each colour, west of the map from north to south."""
        entries = [(words, PAINT[name]) for name, (words, _) in CELLS.items()]
        entries += [("passed over", PASSED_OVER)] * bool(len(found.rejected_m))
        side = float(found.cell_m) * len(found.cell_class)
        north = side * (0.9 - 0.15 * np.arange(len(entries)))
        places = found.corner_m - off + np.column_stack([np.full(len(entries), -0.22 * side), north])
        words, colours = zip(*entries, strict=True)
        marks, points = self._on_ground(places, 4.0), self.rr.Points3D
        self.at(t, "site/hazards/legend", points(marks, colors=colours, radii=-8.0))
        names = points(marks, labels=words, colors=CHOSEN, radii=-0.01, show_labels=True)
        self.at(t, "site/hazards/legend/words", names)

    def _painted(self, found: LandingMap, off: np.ndarray) -> Mesh:
        """The ground in the colours of the classes, without cells that were not seen."""
        cell_class = found.cell_class[::_EVERY, ::_EVERY]
        seen = np.isfinite(found.elevation_m[::_EVERY, ::_EVERY])
        side = (np.arange(0, len(found.cell_class), _EVERY) + 0.5) * float(found.cell_m)
        east, north = np.meshgrid(side + found.corner_m[0] - off[0], side + found.corner_m[1] - off[1])
        up = self.motion.site.ground(east, north)[1]
        rise_north, rise_east = np.gradient(up, float(found.cell_m) * _EVERY)
        paint = np.array([PAINT[name] for name in CELL_CLASSES], float)[cell_class]
        colours = paint * sunlight(self.motion.site.light, rise_east, rise_north)[..., None]
        triangles = open_grid_triangles(*cell_class.shape)
        whole = seen.ravel()[triangles].all(axis=1)
        places = np.stack([east, north, up + _ABOVE], axis=-1).reshape(-1, 3)
        return bright(places, triangles[whole], colours.reshape(-1, 3))

    def _rays(self, rows: np.ndarray, since: float, until: float) -> None:
        """Write the rays of the current row of the scan, as far as the ground."""
        lidar = self.flight.scenario.sensors.lidar
        tangent = np.tan(0.5 * np.radians(lidar.field_of_view_deg))
        shot = (self.t[rows] - since) / max(until - since, 1e-9) * (SCAN_ROWS - 1)
        columns = np.linspace(0, SCAN_COLUMNS - 1, _RAYS).astype(int)
        strips = []
        for row, line in zip(rows, shot.astype(int), strict=True):
            turn = self.motion.rotation[row]
            start = self.motion.nose[row] + turns.rotate(turn, np.array(lidar.position_m))
            ways = np.array([cell_direction(tangent, SCAN_COLUMNS, line, j) for j in columns])
            rays = turns.rotate(turn, ways)
            ends = start + rays * ((self.motion.height[row] / -rays[:, 2])[:, None])
            # the ground at the end of each ray, not straight below the vehicle
            ends += rays * ((ends[:, 2] - self.motion.site.ground(*ends[:, :2].T)[1]) / -rays[:, 2])[:, None]
            strips.append(np.stack([np.broadcast_to(start, ends.shape), ends], axis=1))
        entity, data = "site/hazards/rays", {"strips": np.concatenate(strips)}
        each = np.full(len(rows), _RAYS)
        self.series(entity, self.t[rows], self.rr.LineStrips3D, {"colors": RAY, "radii": -0.6}, data, each)
        self.gone(self.t[rows[-1]] + 0.02, entity)

    def _on_ground(self, places: np.ndarray, above: float) -> np.ndarray:
        """Places east and north (m), shape (n, 2), with the height of the ground and a little more."""
        up = self.motion.site.ground(*places.T)[1]
        return np.column_stack([places, up + above])


class Beams(Recorder):
    """Writes the beams of the radar as lines in B to the entity ``vehicle/beams`` of the replay."""

    def motions(self) -> None:
        """Write the rays, as long as the measured range."""
        beams = [one for one in self.flight.instruments if one.kind == "beam"]
        rows = thin(self.t, SCALAR_HZ)
        if not beams or not len(rows):
            return
        reach = np.stack([self.flight[range_of(beam.name)][rows] for beam in beams], axis=-1)
        shown = reach > 0.0
        echo: np.ndarray = np.logical_or.reduce(shown, axis=1)
        keep = and_next(echo)
        if not echo.any():
            return
        radar = self.flight.scenario.sensors.radar
        start = np.array(radar.position_m)
        ends = start + (reach[..., None] * [beam.axis for beam in radar.beams])[shown]
        strips = np.stack([np.broadcast_to(start, ends.shape), ends], axis=1)
        tints = np.zeros((*shown.shape, 3), np.uint8)
        for state, colour in RAYS.items():
            tints[np.stack([beam.holds(state)[rows] for beam in beams], axis=-1)] = colour
        data, each = {"strips": strips, "colors": tints[shown]}, shown[keep].sum(axis=1)
        entity = f"{self.root}/vehicle/beams"
        self.series(entity, self.t[rows[keep]], self.rr.LineStrips3D, {"radii": -1.2}, data, each)
