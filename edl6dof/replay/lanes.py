"""Lanes (states over time); and, as text, timeline, readout of the present stage, and legend of colours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import shorten
from typing import Any, NamedTuple

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.pages import ENGINE, PHASE, VEHICLE, Labels, lane_of
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene.mesh import RGB
from edl6dof.report.catalogue import STATES
from edl6dof.report.palette import BAD, BLUE, GREEN, ORANGE, VERMILION, rgb
from edl6dof.telemetry.columns import EXCLUDED

CONFIGURATIONS = ("entry vehicle", "parachute open", "heat shield gone", "lander")
OFF, FIRE, RED = (48, 48, 54), rgb(ORANGE), rgb(BAD)
#: Keys of events that are warnings.
TROUBLES = ("fault", "diagnosis", "exclusion", "guard")
#: Width of a page's lanes in a window 1920 px wide, and room that a letter takes, px.
LANE_PX, LETTER_PX = 1100.0, 6.6
#: Most letters of an event's name, so that the column of its place has room.
MOST_LETTERS = 44
#: A label that shows nothing; for an empty one the viewer would show the state's own name.
_BLANK = " "
#: Labels of states that do not show their names.
_SHORT = {"firing": _BLANK, "used": _BLANK}


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


#: Fields by telemetry column, or by the name of a quantity that is computed here.
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
#: Fields that are left out if they are zero throughout the flight.
_WHERE_ANY = ("truth.heat_flux_w_cm2", "truth.engine_thrust_n", "throttle", "truth.propellant_kg")
COLUMNS = tuple(name for name in READOUT if "." in name)


class Lane(NamedTuple):
    """Times (s) and states of a lane, the states that it can have, and their colours."""

    changes: Sequence[tuple[float, str]]
    values: Sequence[str]
    colours: Sequence[Any]


class Lanes(Recorder):
    """Writes the lanes and ``/events``.

    The viewer names a lane by the path of its entity; therefore each lane is a root entity with a plain name.
    """

    def labels(self, spans: Mapping[str, tuple[float, float]]) -> Labels:
        """Return, by page and lane, the labels of the states, blank without room in the page's time (s)."""
        return {
            page: {name: fitted(lane.changes, lane.values, span) for name, lane in self._states().items()}
            for page, span in spans.items()
        }

    def motions(self) -> None:
        """Write lanes and timeline."""
        for name, lane in self._states().items():
            self._lane(name, lane)
        if self.vehicle.engines:
            on = np.nan_to_num(self.flight["truth.engine_thrust_n"]) > 1.0
            self._switched(ENGINE, self.t, {"on": (on, FIRE)})
        self._thrusters()
        self._instruments()
        self._events()

    def _states(self) -> dict[str, Lane]:
        """Lanes of phase and configuration by name."""
        first = np.append(0, np.flatnonzero(np.diff(self.phase)) + 1)
        phases = [(float(self.t[i]), self.names[self.phase[i]]) for i in first]
        changes = [(float(self.t[0]), CONFIGURATIONS[0])]
        fell = (self.motion.canopy, self.motion.heat_shield, self.motion.backshell)
        for name, place in zip(CONFIGURATIONS[1:], fell, strict=True):
            row = self.motion.released(place)
            if row is not None:
                changes.append((float(self.t[row]), name))
        colours = [rgb(colour) for colour in (VERMILION, BLUE, GREEN, ORANGE)]
        return {
            PHASE: Lane(phases, self.names, self.colours.tolist()),
            VEHICLE: Lane(changes, CONFIGURATIONS, colours),
        }

    def _thrusters(self) -> None:
        """Write a lane for each thruster, with every pulse; firing or failed."""
        t = self.flight.series["t_s"]
        thinned = np.searchsorted(self.t, t).clip(max=len(self.t) - 1)
        for jet, firing in self.flight.firing.items():
            failed = self.flight.failures.get(jet, np.zeros(len(self.t)))[thinned] > 0
            states = {"firing": (firing & ~failed, FIRE), "failed": (failed, RED)}
            self._switched(lane_of("thruster", jet), t, states)

    def _instruments(self) -> None:
        """Write a lane for each instrument: in use, saturated or excluded; or, of a beam, its echo used."""
        for one in self.flight.instruments:
            shown = (state for state in one.states if state in STATES)
            states = {state: (one.holds(state), rgb(STATES[state])) for state in shown}
            self._switched(lane_of(one.kind, one.name), self.t, states)

    def _switched(self, name: str, t: np.ndarray, when: Mapping[str, tuple[np.ndarray, RGB]]) -> None:
        """Write a lane of the states in ``when``, each with its rows (bool) at times ``t`` (s) and colour."""
        states, colours, code = ["off", *when], [OFF], np.zeros(len(t), int)
        for number, (holds, colour) in enumerate(when.values(), 1):
            code[holds] = number
            colours.append(colour)
        first = np.append(0, np.flatnonzero(np.diff(code)) + 1)
        changes = [(float(t[i]), states[code[i]]) for i in first]
        look = {"visible": [False] + [True] * len(when), "labels": [_SHORT.get(one, one) for one in states]}
        self._lane(name, Lane(changes, states, colours), **look)

    def _lane(self, name: str, lane: Lane, **look: Any) -> None:
        values, colours = list(lane.values), list(lane.colours)
        self.static(name, self.rr.StateConfiguration(values=values, colors=colours, **look))
        t, states = zip(*lane.changes, strict=True)
        self.columns(name, np.array(t), self.rr.StateChange.columns(state=states))

    def _events(self) -> None:
        """Write the timeline: the last event in bold, the one before it above, and those to come below."""
        events = [event for event in self.flight.events if np.isfinite(event["t_s"])]
        if not events:
            return
        lines = [[f"T+{event['t_s']:.2f} s", _said(event), event["detail"]] for event in events]
        if not self.flight.success:
            lines[-1][1] = f"failure: {lines[-1][1]}"
        times = np.array([event["t_s"] for event in events])
        changes = np.unique(np.append(self.t[0], times))
        media = ["text/markdown"] * len(changes)
        text = [_table(lines, int(np.searchsorted(times, t, side="right")) - 1) for t in changes]
        self.columns("events", changes, self.rr.TextDocument.columns(text=text, media_type=media))


def fitted(
    changes: Sequence[tuple[float, str]], values: Sequence[str], span: tuple[float, float]
) -> list[str]:
    """Return the label of each of ``values`` in a lane over the time ``span`` (s): without room for the name
    its first word, else its initials, else blank.
    """
    first, last = span
    room = dict.fromkeys(values, 0.0)
    ends = [t for t, _ in changes[1:]] + [max(last, changes[-1][0])]
    for (begin, value), end in zip(changes, ends, strict=True):
        share = (min(end, last) - max(begin, first)) / max(last - first, 1e-9)
        room[value] = max(room[value], share * LANE_PX)
    return [
        next((label for label in forms(value) if LETTER_PX * (len(label) + 1) <= room[value]), _BLANK)
        for value in values
    ]


def forms(value: str) -> list[str]:
    """Return a state's name, the first word of it, and its initials."""
    words = value.split("_") if "_" in value else value.split()
    return [" ".join(words), words[0], "".join(word[0] for word in words).upper()]


def _said(event: Any) -> str:
    name = shorten(str(event["name"]).replace("_", " "), MOST_LETTERS, placeholder=" ...")
    return f"warning: {name}" if event["key"] in TROUBLES else name


def _table(lines: Sequence[Sequence[str]], now: int) -> str:
    """Table (Markdown) of the events from the one before number ``now``, which is bold."""
    rows = [[f"**{cell}**" if k == now and cell else cell for cell in line] for k, line in enumerate(lines)]
    body = [f"| {' | '.join(row)} |" for row in rows[max(now - 1, 0) :]]
    return "\n".join(["| time | event | where |", "|--:|:--|:--|", *body])


class Readout(Recorder):
    """Recorder of ``/readout``, and of ``/legend``, which explains the colours of the scene."""

    def statics(self) -> None:
        """Write a table of things and colours."""
        rows = "\n".join(f"| {what} | {colours} |" for what, colours in self._colours())
        text = f"| what | colours |\n|:--|:--|\n{rows}"
        self.static("legend", self.rr.TextDocument(text, media_type="text/markdown"))

    def motions(self) -> None:
        """Write the lines at each time."""
        rows, stages = thin(self.t, READOUT_HZ), self._stages()
        for some in np.array_split(rows, -(-len(rows) // AT_ONCE)):
            self._written(some, stages[some])

    def _written(self, rows: np.ndarray, stages: np.ndarray) -> None:
        """Write the texts of some rows; ``stages``: number of the stage at each row."""
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
        own |= np.nan_to_num(self.flight["truth.engine_thrust_n"]) > 1.0
        return np.select([self.flight["truth.footpads"] > 0.0, hanging, own], [3, 1, 2], 0)

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
            "diagnosed": {jet: self.t[rows] >= since for jet, (since, _) in flight.diagnosed.items()},
            "excluded": {one.name: one.holds(EXCLUDED)[rows] for one in flight.instruments},
        }
        found: list[list[str]] = [[] for _ in rows]
        for word, by_name in holds.items():
            for k in np.flatnonzero(np.any([*by_name.values(), np.zeros(len(rows), bool)], axis=0)):
                names = ", ".join(name for name, there in by_name.items() if there[k])
                found[k].append(f"**{word}:** {names}")
        return ["  \n".join(lines) for lines in found]

    def _colours(self) -> list[tuple[str, str]]:
        """Things and their colours."""
        flight, kinds = self.flight, {one.kind for one in self.flight.instruments}
        procedural = "" if self.motion.site.relief.detailed else "; craters and ripples are decoration"
        path = "each flight's own" if self.label else "of the phase, as in its lane"
        known = [
            (True, "path and trail", path),
            (True, "axes x, y, z", "red, green, blue; B of the body, V of the velocity"),
            (True, "arrows", "velocity cyan, lift green, thrust amber, disturbance pink"),
            (True, "target, planned ellipse", "cyan"),
            (True, "ground", f"relief of the simulation{procedural}"),
            (
                "beam" in kinds,
                "radar beams, on page Navigation",
                "echo used blue, not used purple, excluded red",
            ),
            (bool(flight.failures), "thruster", "failed red"),
            (bool(self.vehicle.engines), "lane of the engine", "burning orange"),
            (bool(flight.jets), "lane of a thruster", "firing orange, failed red"),
        ]
        short = [forms(self.names[k]) for k in np.unique(self.phase)]
        known += [(True, f"phase {letters}", words) for words, _, letters in short]
        return [(what, colours) for there, what, colours in known if there]
