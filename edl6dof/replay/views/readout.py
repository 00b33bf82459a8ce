"""The readout: numbers of the current stage of the flight and present faults, as text; and the legend."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import Recorder
from edl6dof.telemetry.columns import EXCLUDED

#: Least rate of the rows, Hz.
READOUT_HZ = 10.0
#: Rows that are written at once: a text is long.
AT_ONCE = 1000

ENTRY, CHUTE, POWERED, GROUND = "entry", "under parachute", "on its own", "on the ground"
STAGES = (ENTRY, CHUTE, POWERED, GROUND)
AIR, FLYING = (ENTRY, CHUTE), (ENTRY, CHUTE, POWERED)


class Field(NamedTuple):
    """A line of the readout: label, format, unit, and the stages in which it is shown."""

    label: str
    form: str
    unit: str
    stages: tuple[str, ...] = STAGES


#: By telemetry column, or by the name of what is worked out here.
READOUT = {
    "truth.altitude_m": Field("above ellipsoid", ",.0f", "m", AIR),
    "truth.height_m": Field("above ground", ",.1f", "m"),
    "range to site": Field("range to site", ",.2f", "km"),
    "truth.speed_m_s": Field("speed", ",.1f", "m/s"),
    "truth.v_down_m_s": Field("descent rate", ",.1f", "m/s", FLYING),
    "truth.flight_path_angle_deg": Field("path angle", ".1f", "deg", AIR),
    "truth.mach": Field("Mach", ".2f", "", AIR),
    "truth.dynamic_pressure_pa": Field("dyn. pressure", ",.0f", "Pa", AIR),
    "truth.load_g0": Field("load", ".2f", "g", FLYING),
    "truth.heat_flux_w_cm2": Field("heat flux", ".1f", "W/cm²", (ENTRY,)),
    "truth.bank_deg": Field("bank", ".1f", "deg", (ENTRY,)),
    "truth.total_alpha_deg": Field("total alpha", ".1f", "deg", AIR),
    "truth.riser_tension_n": Field("riser tension", ",.0f", "N", (CHUTE,)),
    "truth.tilt_deg": Field("tilt", ".1f", "deg", (POWERED, GROUND)),
    "truth.engine_thrust_n": Field("thrust", ",.0f", "N", (POWERED,)),
    "throttle": Field("throttle", ".0f", "%", (POWERED,)),
    "truth.propellant_kg": Field("propellant", ".1f", "kg"),
}
#: Of these a vehicle that never has any says nothing.
_WHERE_ANY = ("truth.heat_flux_w_cm2", "truth.engine_thrust_n", "throttle", "truth.propellant_kg")
COLUMNS = tuple(name for name in READOUT if "." in name)


class Readout(Recorder):
    """Writes ``/readout``, of the first flight only."""

    def motions(self) -> None:
        """Write the lines at each time."""
        if self.number:
            return
        rows, stages = thin(self.t, READOUT_HZ), self._stages()
        for some in np.array_split(rows, -(-len(rows) // AT_ONCE)):
            self._written(some, stages[some])

    def _written(self, rows: np.ndarray, stages: np.ndarray) -> None:
        """The texts of some rows, in so many stages."""
        lines = {name: self._line(field, values[rows]) for name, field, values in self._fields()}
        tables = []
        for k, stage in enumerate(stages.tolist()):
            head, *body = (lines[name][k] for name in lines if STAGES[stage] in READOUT[name].stages)
            tables.append("\n".join([head, "|:--|--:|", *body]))
        whose = f"{self.label}, " if self.label else ""
        titles = [f"{whose}{self.names[phase].replace('_', ' ')}" for phase in self.phase[rows]]
        times, troubles = self.t[rows].tolist(), self._troubles(rows)
        text = [
            f"## T+{t:.1f} s\n**{title}**\n\n{table}\n\n{trouble}"
            for t, title, table, trouble in zip(times, titles, tables, troubles, strict=True)
        ]
        media = ["text/markdown"] * len(text)
        self.columns("readout", self.t[rows], self.rr.TextDocument.columns(text=text, media_type=media))

    def _stages(self) -> np.ndarray:
        """Number of the stage at each row."""
        hanging = np.isfinite(self.motion.canopy[:, 0])
        let_go = self.motion.released(self.motion.backshell)
        own = np.arange(len(self.t)) >= (len(self.t) if let_go is None else let_go)
        thrust = np.nan_to_num(self.flight["truth.engine_thrust_n"]) > 1.0
        stage = np.where(hanging, 1, np.where(own | thrust, 2, 0))
        landed = self.flight["truth.footpads"] > 0.0
        return np.where(landed, 3, stage)

    def _fields(self) -> list[tuple[str, Field, np.ndarray]]:
        """Lines that the vehicle has, and their values at all rows."""
        centre, radius = self.motion.centre, self.motion.site.radius
        level = np.hypot(centre[:, 0], centre[:, 1])
        full = sum(engine.full_thrust_n for engine in self.vehicle.engines)
        worked_out = {
            "range to site": 1e-3 * radius * np.arctan2(level, radius + centre[:, 2]),
            "throttle": 100.0 * self.flight["truth.engine_thrust_n"] / max(full, 1e-9),
        }
        held = {**self.flight.columns, **worked_out}
        return [
            (name, field, held[name])
            for name, field in READOUT.items()
            if name in held and (name not in _WHERE_ANY or np.nanmax(held[name], initial=0.0) > 0.0)
        ]

    def _line(self, field: Field, values: np.ndarray) -> list[str]:
        return [f"| {field.label} | **{value:z{field.form}}** {field.unit} |" for value in values.tolist()]

    def _troubles(self, rows: np.ndarray) -> list[str]:
        """Failed, diagnosed and excluded components, at some rows."""
        flight = self.flight
        holds = {
            "failed": {jet: state[rows] > 0 for jet, state in flight.failures.items()},
            "diagnosed": {jet: self.t[rows] >= found.t_s for jet, found in flight.diagnosed.items()},
            "excluded": {one.name: one.holds(EXCLUDED)[rows] for one in flight.instruments},
        }
        found: list[list[str]] = [[] for _ in rows]
        for word, by_name in holds.items():
            for k in np.flatnonzero(np.any([*by_name.values(), np.zeros(len(rows), bool)], axis=0)):
                names = ", ".join(name for name, there in by_name.items() if there[k])
                found[k].append(f"**{word}:** {names}")
        return ["  \n".join(lines) for lines in found]


class Legend(Recorder):
    """Writes ``/legend``, the meaning of the colours of the scene; of the first flight only."""

    def statics(self) -> None:
        """Write a table of things and colours."""
        if self.number:
            return
        rows = "\n".join(f"| {what} | {colours} |" for what, colours in self._rows())
        text = f"| what | colours |\n|:--|:--|\n{rows}"
        self.static("legend", self.rr.TextDocument(text, media_type="text/markdown"))

    def _rows(self) -> list[tuple[str, str]]:
        """Things and the meaning of their colours."""
        flight, kinds = self.flight, {one.kind for one in self.flight.instruments}
        path = "each flight's own" if self.label else "of the phase, as in its lane"
        known = [
            (True, "path and trail", path),
            (True, "axes x, y, z", "red, green, blue; B of the body, V of the velocity"),
            (True, "arrows", "velocity cyan, lift green, thrust amber, disturbance pink"),
            (True, "target, planned ellipse", "cyan"),
            ("beam" in kinds, "radar beams", "echo used green, not used amber, excluded red"),
            (flight.landing_map is not None, "hazard map", "safe green, too steep amber, too rough red"),
            (bool(flight.failures), "thruster", "failed red"),
            (bool(self.vehicle.engines), "lane of the engine", "burning orange"),
        ]
        return [(what, colours) for there, what, colours in known if there]
