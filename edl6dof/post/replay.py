"""The 3D replay of a flight, as a rerun recording with its own arrangement of views.

Root ``/site``: east, north, up (m) at the landing site, so that single precision is fine where the vehicle lands.
``/site/vehicle`` is the body frame.  ``/site/camera`` follows the vehicle without turning with it and grows under the
parachute: seen from it, capsule and canopy both fill the view.  ``/plots`` holds the time series, ``/states`` the phase
lanes, ``/events`` the timeline.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.post import scene
from edl6dof.post.layout import GROUPS, PHASES, PLOTS, SERIES, TIMELINE, Plot, blueprint
from edl6dof.post.motion import Motion, pointing, spans, thin

if TYPE_CHECKING:
    import rerun as rr

    from edl6dof.sim.flight import Flight

POSE_HZ = 25.0
SCALAR_HZ = 10.0
READOUT_HZ = 2.0


def write_replay(flight: Flight, path: Path) -> None:
    """Write the replay of ``flight`` to ``path`` (.rrd)."""
    import rerun as rr

    with rr.RecordingStream("edl6dof", recording_id=f"edl6dof-{flight.name}", send_properties=True) as recording:
        _Writer(flight, recording, path).write()


class _Writer:
    """One recording being written."""

    def __init__(self, flight: Flight, recording: rr.RecordingStream, path: Path) -> None:
        import rerun as rr

        self.rr, self.rec = rr, recording
        self.flight, self.vehicle = flight, flight.scenario.vehicle
        self.tm, self.motion = flight.telemetry, Motion(flight)
        self.t = self.motion.t
        self.when = {event["key"]: float(event["t_s"]) for event in reversed(flight.events) if "key" in event}
        phase = np.nan_to_num(self.tm["guide.phase"][self.motion.valid]).astype(int)
        self.names = flight.phase_names or ["free flight"]
        self.phase = np.clip(phase, 0, len(self.names) - 1)
        self.colours = np.array([PHASES[i % len(PHASES)] for i in range(len(self.names))], np.uint8)
        recording.save(str(path), default_blueprint=self._blueprint())

    def write(self) -> None:
        """Everything, what stands still first."""
        self.rec.send_recording_name(f"{self.flight.name}: {self.flight.outcome}")
        self._series_styles()
        if len(self.t) == 0:
            return
        self._ground()
        self._path()
        self._vehicle_parts()
        self.rec.flush()
        self._vehicle_motion()
        self._plumes()
        self._parachute()
        mass, motion = self.vehicle.mass, self.motion
        self._discarded("heat_shield", motion.heat_shield, mass.heat_shield.centre_m, scene.heat_shield(self.vehicle))
        self._discarded("backshell", motion.backshell, mass.backshell.centre_m, scene.backshell(self.vehicle))
        self._trail()
        self._plots()
        self._states()
        self._readout()
        self.rec.flush()

    # What follows writes one subject each.

    def _blueprint(self) -> Any:
        groups = {jet.group for jet in self.vehicle.rcs.thrusters}
        t, when = self.tm["t_s"], self.when
        whole = (float(t[0]), float(t[-1]))
        span = {"": whole, "Guidance": (whole[0], when.get("mortar", whole[1]))}
        span["Powered descent"] = (when.get("backshell", when.get("mortar", whole[0])) - 5.0, whole[1])
        places = self.motion.centre if len(self.t) else np.zeros((1, 3))
        deploy = self.motion.released(self.motion.canopy) if len(self.t) else None
        return blueprint(
            [g for g in GROUPS if g in groups], span, places[-1], places[0], None if deploy is None else places[deploy]
        )

    def _static(self, entity: str, *what: Any) -> None:
        self.rec.log(entity, *what, static=True)

    def _columns(self, entity: str, t: np.ndarray, columns: Any) -> None:
        self.rec.send_columns(entity, [self.rr.TimeColumn(TIMELINE, duration=t)], columns)

    def _at(self, t: float, entity: str, *what: Any) -> None:
        self.rec.set_time(TIMELINE, duration=float(t))
        self.rec.log(entity, *what)
        self.rec.reset_time()

    def _mesh(self, mesh: scene.Mesh, **more: Any) -> rr.Mesh3D:
        return self.rr.Mesh3D(
            vertex_positions=mesh.positions,
            triangle_indices=mesh.triangles,
            vertex_normals=mesh.normals,
            vertex_colors=mesh.colours,
            **more,
        )

    def _ground(self) -> None:
        rr, motion = self.rr, self.motion
        self._static("site", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        reach = float(np.clip(1.15 * np.linalg.norm(motion.centre - motion.last, axis=-1).max(), 5e3, 1.2e6))
        self._static("site/ground", self._mesh(scene.ground(motion.last, motion.ground_up, reach)))
        turn = np.linspace(0.0, 2.0 * np.pi, 97)
        circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        limit = self.flight.scenario.limits.landing_distance_m

        def ring(radius: float, centre: np.ndarray) -> np.ndarray:
            flat = centre[:2] + radius * circle
            return np.column_stack([flat, motion.ground_up(flat[:, 0], flat[:, 1]) + 0.02 + 1e-4 * radius])

        radii = [r for r in (5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3) if r < reach]
        here = motion.last
        self._static(
            "site/ground/rings",
            rr.LineStrips3D([ring(r, here) for r in radii], colors=[96, 54, 34], radii=rr.Radius.ui_points(0.6)),
        )
        target = np.zeros(3)
        self._static(
            "site/markers/target",
            rr.LineStrips3D(
                [ring(r, target) for r in (0.01 * limit, 0.1 * limit, limit)],
                colors=[90, 220, 230],
                radii=rr.Radius.ui_points(1.2),
            ),
        )
        self._label("target", [0.0, 0.0, float(motion.ground_up(np.zeros(1), np.zeros(1))[0])], (90, 220, 230))
        if self.tm["truth.footpads"][-1] > 0.0:
            self._label("touchdown", [*here[:2], float(here[2] - motion.height[-1])], (120, 235, 140))

    def _label(self, name: str, place: list[float], colour: scene.RGB) -> None:
        radius = self.rr.Radius.ui_points(4.0)
        point = self.rr.Points3D([place], labels=[name], colors=colour, radii=radius, show_labels=True)
        self._static(f"site/labels/{name}", point)

    def _path(self) -> None:
        rows = thin(self.t, 5.0)
        phase = self.phase[rows]
        cuts = np.flatnonzero(np.diff(phase)) + 1
        strips = [part if k == 0 else np.append(rows[c - 1 : c], part) for k, (c, part) in enumerate(self._split(rows, cuts))]
        colours = [self.colours[self.phase[strip[-1]]] for strip in strips]
        self._static(
            "site/path",
            self.rr.LineStrips3D(
                [self.motion.centre[strip] for strip in strips], colors=colours, radii=self.rr.Radius.ui_points(2.0)
            ),
        )

    @staticmethod
    def _split(rows: np.ndarray, cuts: np.ndarray) -> list[tuple[int, np.ndarray]]:
        starts = [0, *cuts.tolist()]
        return list(zip(starts, np.split(rows, cuts), strict=True))

    def _vehicle_parts(self) -> None:
        vehicle, motion = self.vehicle, self.motion
        start = self.t[0]
        self._static("site/vehicle/lander", self._mesh(scene.lander(vehicle)))
        self._at(start, "site/vehicle/heat_shield", self._mesh(scene.heat_shield(vehicle)))
        self._at(start, "site/vehicle/backshell", self._mesh(scene.backshell(vehicle)))
        for part, place in (("heat_shield", motion.heat_shield), ("backshell", motion.backshell)):
            gone = motion.released(place)
            if gone is not None:
                self._at(self.t[gone], f"site/vehicle/{part}", self.rr.Clear(recursive=False))
        legs = scene.legs(vehicle)
        if legs is not None and "landing_legs" in self.when:
            self._at(self.when["landing_legs"], "site/vehicle/legs", self._mesh(legs))
        wing = vehicle.trim_wing
        if wing.area_m2 > 0.0 and "trim_wing" in self.when:
            corner = np.array([wing.position_x_m - 0.55, -0.45, 0.60 * wing.position_z_m])
            flap = scene.box(corner + [0.15, 0.45, 0.35 * wing.position_z_m], (0.05, 0.7, 0.55), scene.ORANGE)
            self._at(self.when["trim_wing"], "site/vehicle/trim_wing", self._mesh(flap))
            gone = motion.released(motion.backshell)
            if gone is not None:
                self._at(self.t[gone], "site/vehicle/trim_wing", self.rr.Clear(recursive=False))
        rows = thin(self.t, 2.0)
        heat = self.tm["truth.heat_flux_w_cm2"][motion.valid][rows]
        glow = np.nan_to_num(heat / max(np.nanmax(heat), 1e-9))[:, None] ** 0.6
        tint = np.array([104, 84, 70]) + (np.array([255, 150, 70]) - [104, 84, 70]) * glow
        until = motion.released(motion.heat_shield)
        keep = rows < (until if until is not None else len(self.t))
        self._columns(
            "site/vehicle/heat_shield",
            self.t[rows[keep]],
            self.rr.Mesh3D.columns(albedo_factor=np.column_stack([tint, np.full(len(tint), 255)])[keep].astype(np.uint8)),
        )

    def _vehicle_motion(self) -> None:
        rr, motion = self.rr, self.motion
        rows = thin(self.t, POSE_HZ)
        t = self.t[rows]
        turn = motion.rotation[rows].as_quat()
        self._columns("site/vehicle", t, rr.Transform3D.columns(translation=motion.nose[rows], quaternion=turn))
        look, facing, scale = (part[rows] for part in motion.camera())
        frame = rr.Transform3D.columns(translation=look, quaternion=facing, scale=np.repeat(scale[:, None], 3, axis=1))
        self._columns("site/camera", t, frame)
        self._velocity(rows)
        rows = thin(self.t, SCALAR_HZ)
        self._static("site/markers/vehicle", rr.Points3D.from_fields(colors=[255, 255, 255], radii=-5.0))
        self._columns("site/markers/vehicle", self.t[rows], rr.Points3D.columns(positions=motion.centre[rows]))
        low = rows[motion.height[rows] < 20e3]
        if len(low):
            below = motion.centre[low] - [0.0, 0.0, 1.0] * motion.height[low, None]
            self._static("site/drop_line", rr.LineStrips3D.from_fields(colors=[190, 170, 150], radii=-0.7))
            line = np.stack([motion.centre[low], below], axis=1)
            self._columns("site/drop_line", self.t[low], rr.LineStrips3D.columns(strips=line))
        self._shadow(rows)

    def _velocity(self, rows: np.ndarray) -> None:
        """Arrow along the flight path, ahead of the nose, until the parachute."""
        rr, motion = self.rr, self.motion
        rows = rows[self.t[rows] < self.when.get("mortar", np.inf)]
        if len(rows) < 3:
            return
        way = np.gradient(motion.centre[rows], self.t[rows], axis=0)
        way /= np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-9)
        size = self.vehicle.aero.capsule.diameter_m
        self._static("site/velocity", rr.Arrows3D.from_fields(colors=[110, 230, 240], radii=0.012 * size))
        self._columns(
            "site/velocity",
            self.t[rows],
            rr.Arrows3D.columns(origins=motion.centre[rows] + 0.45 * size * way, vectors=0.55 * size * way),
        )
        self._at(self.when.get("mortar", self.t[rows[-1]]), "site/velocity", rr.Clear(recursive=False))

    def _shadow(self, rows: np.ndarray) -> None:
        """Dark disc under the vehicle, for the eye to judge the height by."""
        motion = self.motion
        rows = rows[motion.height[rows] < 300.0]
        if len(rows) == 0:
            return
        disc = scene.revolve([(0.0, 1.3), (0.0, 1e-4)], (84, 46, 28), 32, (np.zeros(3), np.array([0.0, 0.0, 1.0])))
        self._at(self.t[rows[0]], "site/shadow", self._mesh(disc))
        place = motion.centre[rows] - [0.0, 0.0, 1.0] * motion.height[rows, None] + [0.0, 0.0, 0.03]
        self._columns("site/shadow", self.t[rows], self.rr.Transform3D.columns(translation=place))

    def _plumes(self) -> None:
        rr = self.rr
        jets = self.vehicle.rcs.thrusters
        rows = thin(self.t, POSE_HZ)
        t = self.t[rows]
        if jets:
            duty = self._mean_duty(rows, [jet.name for jet in jets])
            back = pointing(-np.array([jet.direction for jet in jets]))
            places = np.array([jet.position_m for jet in jets])
            size = np.array([1.5 * max(jet.thrust_n / 250.0, 0.05) ** 0.4 for jet in jets])
            firing = duty > 0.02
            length = size * (0.35 + 0.65 * duty)
            length, shown, rows_shown = _hide(length, firing)
            which = np.nonzero(shown)[1]
            length = length[shown]
            scales = np.column_stack([length, 0.37 * length, 0.37 * length])
            poses = rr.InstancePoses3D.columns(translations=places[which], quaternions=back[which], scales=scales)
            self._flames("thruster_plumes", t[rows_shown], poses.partition(shown.sum(axis=1)))
        engine = self.vehicle.engine
        thrust = self.tm["truth.engine_thrust_n"][self.motion.valid][rows]
        if engine.full_thrust_n > 0.0 and np.nanmax(thrust) > 0.0:
            level = np.nan_to_num(thrust) / engine.full_thrust_n
            flicker = 1.0 + 0.06 * np.sin(2.0 * np.pi * 7.3 * t)
            length, shown, rows_shown = _hide(((0.8 + 3.2 * level) * flicker)[:, None], (level > 0.01)[:, None])
            girth = np.minimum(0.55 + 0.35 * level[rows_shown], length[:, 0])
            scales = np.column_stack([length[:, 0], girth, girth])
            nozzle = np.broadcast_to(engine.nozzle_m, scales.shape)
            poses = rr.InstancePoses3D.columns(translations=nozzle, scales=scales)
            self._flames("engine_plume", t[rows_shown], poses.partition(shown.sum(axis=1)))

    def _flames(self, name: str, t: np.ndarray, poses: Any) -> None:
        for layer in ("core", "mantle"):
            tint = [255, 255, 255, 255 if layer == "core" else 120]
            self._static(f"site/vehicle/{name}/{layer}", self._mesh(scene.plume(layer == "core"), albedo_factor=tint))
            self._columns(f"site/vehicle/{name}/{layer}", t, poses)

    def _mean_duty(self, rows: np.ndarray, names: list[str]) -> np.ndarray:
        """Mean duty of each thruster from each of ``rows`` to the next, shape (rows, thrusters)."""
        duty = np.stack([np.nan_to_num(self.tm[f"rcs.{name}"][self.motion.valid]) for name in names], axis=-1)
        return np.add.reduceat(duty, rows, axis=0) / np.diff(np.append(rows, len(duty)))[:, None]

    def _parachute(self) -> None:
        rr = self.rr
        rows, place, turn, scale = self.motion.parachute()
        if len(rows) == 0:
            return
        keep = np.intersect1d(rows, thin(self.t, POSE_HZ), return_indices=True)[1]
        rows, place, turn, scale = rows[keep], place[keep], turn[keep], scale[keep]
        if len(rows) == 0:
            return
        mesh, lines = scene.canopy(self.vehicle)
        start = self.t[rows[0]]
        self._at(start, "site/parachute/canopy", self._mesh(mesh))
        self._at(start, "site/parachute/lines", rr.LineStrips3D(lines, colors=[222, 214, 204], radii=rr.Radius.ui_points(0.7)))
        self._columns("site/parachute", self.t[rows], rr.Transform3D.columns(translation=place, quaternion=turn, scale=scale))
        lid_x, lid_r = scene.backshell_profile(self.vehicle)[-1]
        ends = [[lid_x, lid_r * np.cos(a), lid_r * np.sin(a)] for a in (0.0, 2.1, 4.2)]
        bridle = rr.LineStrips3D(
            [[end, self.vehicle.parachute.confluence_m] for end in ends], colors=[222, 214, 204], radii=rr.Radius.ui_points(1.0)
        )
        self._at(start, "site/vehicle/bridle", bridle)
        gone = self.motion.released(self.motion.backshell)
        if gone is not None:
            self._at(self.t[gone], "site/vehicle/bridle", rr.Clear(recursive=False))
            self._at(self.t[gone], "site/backshell/bridle", bridle)

    def _discarded(self, name: str, place: np.ndarray, own_centre: Any, mesh: scene.Mesh) -> None:
        """A part on its own: its mesh, and a labelled point that is seen from afar."""
        rr, first = self.rr, self.motion.released(place)
        if first is None:
            return
        origin, turn = self.motion.discarded(place, own_centre)
        rows = thin(self.t, POSE_HZ)
        rows = np.append(first, rows[rows > first])
        rows = rows[np.isfinite(origin[rows, 0])]
        tint = {"albedo_factor": [104, 84, 70, 255]} if name == "heat_shield" else {}
        self._at(self.t[first], f"site/{name}/shape", self._mesh(mesh, **tint))
        attitude = np.tile(turn.as_quat(), (len(rows), 1))
        self._columns(f"site/{name}", self.t[rows], rr.Transform3D.columns(translation=origin[rows], quaternion=attitude))
        rows = rows[::5]
        label = rr.Points3D.from_fields(labels=[name.replace("_", " ")], colors=[235, 190, 120], radii=-3.5, show_labels=True)
        self._at(self.t[first], f"site/labels/{name}", label)
        self._columns(f"site/labels/{name}", self.t[rows], rr.Points3D.columns(positions=place[rows]))

    def _trail(self) -> None:
        """Short segments; the views show those of the last minute."""
        rows = thin(self.t, 5.0)
        if len(rows) < 2:
            return
        segments = np.stack([self.motion.centre[rows[:-1]], self.motion.centre[rows[1:]]], axis=1)
        colours = np.append(self.colours[self.phase[rows[1:]]], np.full((len(rows) - 1, 1), 255, np.uint8), axis=1)
        self._static("site/trail", self.rr.LineStrips3D.from_fields(radii=-1.5))
        self._columns("site/trail", self.t[rows[1:]], self.rr.LineStrips3D.columns(strips=segments, colors=colours))

    def _series_styles(self) -> None:
        for plots in PLOTS.values():
            for plot in plots:
                self._static(f"plots/{plot.entity}", self._lines(list(plot.series.values())))
        for group in GROUPS:
            names = [jet.name for jet in self.vehicle.rcs.thrusters if jet.group == group]
            if names:
                self._static(f"plots/thruster_duty/{group}", self._lines(names))

    def _lines(self, names: list[str]) -> rr.SeriesLines:
        colours = [SERIES[i % len(SERIES)] for i in range(len(names))]
        return self.rr.SeriesLines(names=names, colors=colours, widths=[1.5] * len(names))

    def _plots(self) -> None:
        rows = self.motion.valid[thin(self.t, SCALAR_HZ)]
        for plots in PLOTS.values():
            for plot in plots:
                self._plot(plot, rows)
        for group in GROUPS:
            names = [jet.name for jet in self.vehicle.rcs.thrusters if jet.group == group]
            if names:
                duty = self._mean_duty(thin(self.t, SCALAR_HZ), names)
                self._scalars(f"plots/thruster_duty/{group}", self.tm["t_s"][rows], duty)

    def _plot(self, plot: Plot, rows: np.ndarray) -> None:
        t = self.tm["t_s"][rows]
        keep = (t >= self.when.get(plot.since, -np.inf)) & (t <= self.when.get(plot.until, np.inf))
        if keep.any():
            values = np.stack([self.tm[name][rows[keep]] for name in plot.series], axis=-1)
            self._scalars(f"plots/{plot.entity}", t[keep], values * plot.scale)

    def _scalars(self, entity: str, t: np.ndarray, values: np.ndarray) -> None:
        columns = self.rr.Scalars.columns(scalars=values.ravel())
        self._columns(entity, t, columns.partition(np.full(len(t), values.shape[1])))

    def _states(self) -> None:
        """Lanes: mission phase, what flies, engine; and the timeline as text."""
        rr, motion = self.rr, self.motion
        first = np.append(0, np.flatnonzero(np.diff(self.phase)) + 1)
        labels = [name.replace("_", " ") for name in self.names]
        self._lane("phase", [(self.t[i], self.names[self.phase[i]]) for i in first], self.names, labels, self.colours.tolist())
        shape = ["entry vehicle", "under parachute", "heat shield gone", "lander"]
        changes = [(self.t[0], shape[0])]
        for name, place in zip(shape[1:], (motion.canopy, motion.heat_shield, motion.backshell), strict=True):
            row = motion.released(place)
            if row is not None:
                changes.append((self.t[row], name))
        self._lane("configuration", changes, shape, shape, [SERIES[1], SERIES[0], SERIES[2], SERIES[4]])
        on = np.nan_to_num(self.tm["truth.engine_thrust_n"][motion.valid]) > 1.0
        runs = [(self.t[i], "engine off" if i == 0 else "engine on") for i in [0]]
        for begin, end in spans(on):
            runs += [(self.t[begin], "engine on"), (self.t[min(end, len(self.t) - 1)], "engine off")]
        states = ["engine off", "engine on"]
        self._lane("engine", runs, states, states, [(70, 70, 76), (250, 150, 60)])
        events = [event for event in self.flight.events if np.isfinite(event["t_s"])]
        if events:
            text = [f"{event['name']}: {event['detail']}" if event["detail"] else event["name"] for event in events]
            level = ["INFO"] * len(text)
            level[-1] = "INFO" if self.flight.outcome.startswith("landed within") else "ERROR"
            self._columns("events", np.array([e["t_s"] for e in events]), rr.TextLog.columns(text=text, level=level))

    def _lane(
        self, name: str, changes: list[tuple[float, str]], values: list[str], labels: list[str], colours: list[Any]
    ) -> None:
        self._static(f"states/{name}", self.rr.StateConfiguration(values=values, labels=labels, colors=colours))
        t, states = zip(*changes, strict=True)
        self._columns(f"states/{name}", np.array(t), self.rr.StateChange.columns(state=states))

    def _readout(self) -> None:
        """What a flight controller would read off, twice a second."""
        rows = thin(self.t, READOUT_HZ)
        column = {name: self.tm[name][self.motion.valid][rows] for name in _READOUT}
        text = []
        for k, row in enumerate(rows):
            lines = [f"| {label} | **{column[name][k]:{form}}** {unit} |" for name, (label, form, unit) in _READOUT.items()]
            title = self.names[self.phase[row]].replace("_", " ")
            text.append(f"## T+{self.t[row]:.1f} s\n**{title}**\n\n" + "\n".join([lines[0], "|:--|--:|", *lines[1:]]))
        media = ["text/markdown"] * len(text)
        self._columns("readout", self.t[rows], self.rr.TextDocument.columns(text=text, media_type=media))


def _hide(length: np.ndarray, firing: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows in which something fires, or has just stopped.

    The latter show one flame too small to see: the viewer takes an empty row for one instance in the default pose.

    Args:
        length: of the flames, shape (rows, nozzles).
        firing: which of them burn.

    Returns:
        lengths and shown flames of the rows kept, and the kept rows.
    """
    active = firing.any(axis=1)
    keep = np.flatnonzero(active | np.append([True], active[:-1]))
    length, shown = length[keep].copy(), firing[keep].copy()
    silent = ~active[keep]
    length[silent], shown[silent, 0] = 1e-4, True
    return length, shown, keep


_READOUT = {
    "truth.altitude_m": ("altitude", ",.0f", "m"),
    "truth.height_m": ("above ground", ",.1f", "m"),
    "truth.speed_m_s": ("speed", ",.1f", "m/s"),
    "truth.v_down_m_s": ("descent rate", ",.1f", "m/s"),
    "truth.flight_path_angle_deg": ("path angle", ".1f", "deg"),
    "truth.mach": ("Mach", ".2f", ""),
    "truth.dynamic_pressure_pa": ("dyn. pressure", ",.0f", "Pa"),
    "truth.load_g0": ("load", ".2f", "g"),
    "truth.heat_flux_w_cm2": ("heat flux", ".1f", "W/cm²"),
    "truth.bank_deg": ("bank", ".1f", "deg"),
    "truth.total_alpha_deg": ("total alpha", ".1f", "deg"),
    "truth.tilt_deg": ("tilt", ".1f", "deg"),
    "truth.engine_thrust_n": ("thrust", ",.0f", "N"),
    "truth.propellant_kg": ("propellant", ".1f", "kg"),
}
