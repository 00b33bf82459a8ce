"""The stage of a film: the scene of the replay in VTK, drawn without a window by a GPU or by the processor.

Every moving part is a mesh in its own axes with a pose; positions are composed in double precision.
"""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from edl6dof.child import python
from edl6dof.replay.failures import NoFilm
from edl6dof.replay.film.shots import View
from edl6dof.replay.history import History
from edl6dof.replay.scene.landscape import Landscape
from edl6dof.replay.scene.mesh import Mesh
from edl6dof.replay.scene.poses import Motion
from edl6dof.spatial import rotations as turns

if TYPE_CHECKING:
    import pyvista

#: Length (m) over which air at the ground hides what is behind it by e, for haze of the far ground.
_CLEAR_AIR_M = 70e3
#: Rows and columns of the sky, radius (m) of its dome, and noise of the sky in steps of colour.
_DOME, _DOME_M = (121, 120), 1.5e6
#: Python code that draws off screen.  Without graphics, VTK ends the process that tries.
_PROBE = "import pyvista; pyvista.Plotter(off_screen=True, window_size=(8, 8)).render_window.Render()"
#: Brightness of a surface in shadow, and of light from the side of the camera.
_AMBIENT, _FILL = 0.32, 0.34


class Track(NamedTuple):
    """Poses over time: times (s), places (m), turns (quaternions), and scales; at rows in order."""

    t: np.ndarray
    place: np.ndarray
    turn: np.ndarray
    scale: np.ndarray

    @classmethod
    def of(cls, t: np.ndarray, place: np.ndarray, turn: np.ndarray, scale: np.ndarray | None = None) -> Track:
        """Return the track of these poses; a single turn is that of all rows."""
        size = np.ones((len(t), 3)) if scale is None else scale
        return cls(t, place, np.broadcast_to(turn, (len(t), 4)), size)

    def at(self, t: float) -> np.ndarray:
        """Return the pose at time ``t`` (s) as a matrix, shape (4, 4)."""
        row = int(np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, max(len(self.t) - 2, 0)))
        after = min(row + 1, len(self.t) - 1)
        step = self.t[after] - self.t[row]
        share = float(np.clip((t - self.t[row]) / step, 0.0, 1.0)) if step > 0.0 else 0.0
        place, size = (
            values[row] + share * (values[after] - values[row]) for values in (self.place, self.scale)
        )
        first, second = self.turn[row], self.turn[after]
        turn = first + share * (np.copysign(1.0, first @ second) * second - first)
        return pose(place, turn / np.linalg.norm(turn), size)


def pose(place: np.ndarray, turn: np.ndarray, scale: np.ndarray | float = 1.0) -> np.ndarray:
    """Return place (m), turn (quaternion) and scale as a matrix, shape (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, :3] = turns.rotate(turn, np.eye(3)).T * scale
    matrix[:3, 3] = place
    return matrix


class Stage:
    """Ground, sky, light and camera; the parts of the vehicle are added to it.

    Raises:
        NoFilm: pyvista is not installed.
    """

    def __init__(self, flight: History, motion: Motion, size: tuple[int, int]) -> None:
        self.pv = library()
        self.pv.vtk_verbosity("off")  # it warns where there is no display
        self.motion, self.size = motion, size
        self._gas: list[tuple[Any, ...]] = []
        self.plotter: pyvista.Plotter = self.pv.Plotter(off_screen=True, window_size=size, lighting="none")
        self.plotter.set_background("black")
        self.plotter.disable_anti_aliasing()
        self.plotter.renderer.SetUseOIT(False)  # layers of gas differ little in colour: no second picture
        self.plotter.remove_all_lights()
        sun = 1e3 * motion.site.light
        self.plotter.add_light(self.pv.Light(position=sun, focal_point=(0, 0, 0), intensity=0.8))
        self.plotter.add_light(self.pv.Light(light_type="headlight", intensity=_FILL))
        self._ground(Landscape(motion.site, motion.last))
        self._sky()

    def add(self, mesh: Mesh, opacity: np.ndarray | None = None, lit: bool = True, **look: Any) -> Any:
        """Add a mesh in its own axes and return the actor; ``opacity``: of each vertex, 0 to 1."""
        actor = self.plotter.add_mesh(
            self._data(mesh, opacity), scalars="rgb", rgb=True, lighting=lit, reset_camera=False, **look
        )
        actor.prop.interpolation = "Phong"
        if lit:
            actor.prop.ambient, actor.prop.diffuse = _AMBIENT, 0.9
            actor.prop.specular, actor.prop.specular_power = 0.12, 18.0
        return actor

    def add_gas(self, mesh: Mesh, opacity: np.ndarray) -> Any:
        """Add gas within a surface: transparent where it is seen edge on, for a ray through it is short."""
        data = self._data(mesh, opacity)
        actor = self.plotter.add_mesh(data, scalars="rgb", rgb=True, lighting=False, reset_camera=False)
        self._gas.append((actor, data, mesh.positions, mesh.normals, mesh.colours, opacity))
        return actor

    def add_lines(self, segments: np.ndarray, colour: tuple[int, int, int], width: float) -> Any:
        """Add straight lines, shape (n, 2, 3), ``width`` pixels wide in a picture 1080 high."""
        data = self.pv.line_segments_from_points(np.reshape(segments, (-1, 3)).astype(np.float32))
        wide = max(1.0, width * self.size[1] / 1080)
        return self.plotter.add_mesh(
            data, color=[c / 255.0 for c in colour], line_width=wide, lighting=False, reset_camera=False
        )

    def draw(self, view: View, height_m: float) -> np.ndarray:
        """Return a picture of the scene, rows from the bottom, shape (height, width, 3), uint8.

        ``height_m``: of the vehicle.
        """
        camera = self.plotter.camera
        camera.position, camera.focal_point, camera.up = view.eye, view.aim, view.up
        camera.view_angle = view.field_deg
        near = float(np.clip(0.12 * np.linalg.norm(view.aim - view.eye), 0.3, 100.0))
        camera.clipping_range = (near, 2.2 * _DOME_M)
        self._shade(view, height_m)
        self._thin_gas(view)
        window = self.plotter.render_window
        assert window is not None
        window.Render()
        pixels = self.pv.convert_array(np.empty(0, np.uint8))
        width, height = self.size
        window.GetPixelData(0, 0, width - 1, height - 1, 0, pixels, 0)
        return np.asarray(self.pv.convert_array(pixels).reshape(height, width, 3))

    def close(self) -> None:
        """Release the graphics."""
        self.plotter.close()

    def _data(self, mesh: Mesh, opacity: np.ndarray | None = None) -> pyvista.PolyData:
        data = self.pv.PolyData.from_regular_faces(mesh.positions.astype(np.float32), _outward(mesh))
        colours = mesh.colours
        if opacity is not None:
            colours = np.column_stack([colours, 255.0 * np.clip(opacity, 0.0, 1.0)]).astype(np.uint8)
        data.point_data["rgb"] = colours
        if np.any(mesh.normals):
            data.point_data.active_normals = mesh.normals.astype(np.float32)
        return data

    def _ground(self, landscape: Landscape) -> None:
        """Add the ground, and near a detailed site its rocks."""
        from edl6dof.replay.film.terrain import terrain

        self._land = []
        for mesh, noise in terrain(landscape, self.motion):
            data = self._data(mesh)
            actor = self.plotter.add_mesh(data, scalars="rgb", rgb=True, lighting=False, reset_camera=False)
            if noise is not None:
                self._texture(actor, data, noise)
            self._land.append((data, mesh.positions, mesh.colours.astype(np.float32)))

    def _sky(self) -> None:
        """Add the dome of the sky, seen from inside, with a halo around the sun."""
        from edl6dof.replay.film.terrain import dome

        mesh, texture = dome(self.motion.site, _DOME)
        self._dome_colours = mesh.colours.astype(np.float32)
        data = self._data(mesh)
        self._dome_data = data
        self._dome = self.plotter.add_mesh(data, scalars="rgb", rgb=True, lighting=False, reset_camera=False)
        self._texture(self._dome, data, texture, fine=False)

    def _texture(self, actor: Any, data: Any, noise: Any, fine: bool = True) -> None:
        """Multiply the colours of an actor by a repeated tile of noise; ``fine``: between its texels, too."""
        data.active_texture_coordinates = noise.coordinates
        actor.texture = self.pv.Texture(noise.tile)
        actor.texture.repeat = True
        actor.texture.interpolate = actor.texture.mipmap = fine
        actor.texture.SetMaximumAnisotropicFiltering(1.0)

    def _thin_gas(self, view: View) -> None:
        """Make gas transparent where the camera sees its surface edge on."""
        for actor, data, places, normals, colours, opacity in self._gas:
            if actor.visibility:
                matrix = np.asarray(actor.user_matrix)
                eye = np.linalg.solve(matrix, np.append(view.eye, 1.0))[:3]
                ray = eye - places
                facing = np.abs((ray * normals).sum(axis=-1)) / np.linalg.norm(ray, axis=-1)
                seen = np.clip(opacity * facing**1.5, 0.0, 1.0)
                data.point_data["rgb"] = np.column_stack([colours, 255.0 * seen]).astype(np.uint8)

    def _shade(self, view: View, height_m: float) -> None:
        """Colour sky and ground for the height of the camera and the distances to it."""
        look = self.motion.site.appearance
        air = float(np.exp(-max(height_m, 0.0) / look.sky_scale_m))
        self._dome.user_matrix = pose(view.eye, upright(view.up), _DOME_M)
        self._dome_data.point_data["rgb"] = (self._dome_colours * air).astype(np.uint8)
        horizon = np.array(look.sky_horizon) * (0.35 + 0.65 * air)
        depth = max(height_m, 1.0) / look.sky_scale_m
        density = (1.0 - np.exp(-depth)) / depth
        for data, places, colours in self._land:
            away = np.linalg.norm(places - view.eye, axis=-1)
            haze = (1.0 - np.exp(-away * density / _CLEAR_AIR_M))[:, None].astype(np.float32)
            data.point_data["rgb"] = (colours + haze * (horizon - colours)).astype(np.uint8)


def _outward(mesh: Mesh) -> np.ndarray:
    """Triangles whose front, by the order of their corners, is where their normals point."""
    a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
    normal = mesh.normals[mesh.triangles].sum(axis=1)
    behind = (np.cross(b - a, c - a) * normal).sum(axis=-1) < 0.0
    return np.where(behind[:, None], mesh.triangles[:, ::-1], mesh.triangles)


def upright(up: np.ndarray) -> np.ndarray:
    """Return the shortest turn (quaternion) of z to ``up``, of any length but zero."""
    up = up / np.linalg.norm(up)
    half = np.array([1.0 + up[2], -up[1], up[0], 0.0])
    return half / np.linalg.norm(half) if half[0] > 1e-9 else np.array([0.0, 1.0, 0.0, 0.0])


def library() -> Any:
    """Return the library pyvista.

    Raises:
        NoFilm: it is not installed.
    """
    try:
        import pyvista
    except ImportError:
        raise NoFilm("a film needs pyvista: pip install 'edl6dof[video]'") from None
    return pyvista


def require_graphics() -> None:
    """Draw in another process.

    Raises:
        NoFilm: pyvista is not installed, or this machine has no graphics that it can draw with.
    """
    library()
    if subprocess.run(python(_PROBE), capture_output=True, check=False).returncode:
        raise NoFilm(
            "a film needs graphics, and this machine has none that VTK can draw with; without a GPU it needs "
            "EGL and Mesa (Debian: apt-get install libegl1 libgl1-mesa-dri)"
        )
