"""Lanes of states, and the timeline as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import shorten
from typing import Any, NamedTuple

import numpy as np

from edl6dof.replay.history import POSE_HZ
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.views.pages import ENGINE, PHASE, VEHICLE, Labels, lane_of
from edl6dof.report.catalogue import STATES
from edl6dof.report.palette import BAD, BLUE, GREEN, ORANGE, VERMILION, rgb

CONFIGURATIONS = ("entry vehicle", "under parachute", "heat shield gone", "lander")
OFF, FIRE, RED = (48, 48, 54), rgb(ORANGE), rgb(BAD)
#: Keys of events that are warnings.
TROUBLES = ("fault", "diagnosis", "exclusion", "guard")
#: A thruster counts as firing from this duty on.
FIRING = 0.02
#: Least width of a page's lanes, and room that a letter takes, px.
LANE_PX, LETTER_PX = 800.0, 6.6
#: Letters of an event's name at most, so that its place has room.
MOST_LETTERS = 44
#: A label that shows nothing; for an empty one the viewer would show the state's own name.
_BLANK = " "


class Lane(NamedTuple):
    """Times (s) and states of a lane, the states that it can have, and their colours."""

    changes: Sequence[tuple[float, str]]
    values: Sequence[str]
    colours: Sequence[Any]


class Lanes(Recorder):
    """Writes the lanes and ``/events``; of the first flight only.

    The viewer names a lane by the path of its entity, so that each lies at the top under a plain name.
    """

    def labels(self, spans: Mapping[str, tuple[float, float]]) -> Labels:
        """Return the labels of the states of each lane that have room in the time (s) of each page."""
        return {
            page: {name: fitted(lane.changes, lane.values, span) for name, lane in self._states().items()}
            for page, span in spans.items()
        }

    def motions(self) -> None:
        """Write lanes and timeline."""
        if self.number:
            return
        for name, lane in self._states().items():
            self._lane(name, *lane)
        if self.vehicle.engines:
            on = np.nan_to_num(self.flight["truth.engine_thrust_n"]) > 1.0
            self._switched(ENGINE, {"on": on}, {"on": FIRE})
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
        """One lane each: firing or failed; pulses less than a second apart are one burst."""
        for k, jet in enumerate(self.flight.jets):
            failed = self.flight.failures.get(jet, np.zeros(len(self.t))) > 0
            firing = _bursts(self.flight.duty[:, k] > FIRING) & ~failed
            states = {"firing": firing, "failed": failed}
            self._switched(lane_of("thruster", jet), states, {"firing": FIRE, "failed": RED})

    def _instruments(self) -> None:
        """One lane each: in use, saturated or excluded; of a beam, whether its echo was used."""
        for one in self.flight.instruments:
            colours = {state: rgb(STATES[state]) for state in one.states if state in STATES}
            states = {state: one.holds(state) for state in colours}
            self._switched(lane_of(one.kind, one.name), states, colours)

    def _switched(
        self, name: str, when: dict[str, np.ndarray], colours: dict[str, tuple[int, int, int]]
    ) -> None:
        """Write a lane that is off except where one of the states holds."""
        states = ["off", *when]
        code = np.zeros(len(self.t), int)
        for number, holds in enumerate(when.values(), 1):
            code[holds] = number
        first = np.append(0, np.flatnonzero(np.diff(code)) + 1)
        shown = [False] + [True] * len(when)
        changes = [(float(self.t[i]), states[code[i]]) for i in first]
        self._lane(name, changes, states, [OFF, *colours.values()], shown)

    def _lane(
        self,
        name: str,
        changes: Sequence[tuple[float, str]],
        values: Sequence[str],
        colours: Sequence[Any],
        shown: Any = None,
    ) -> None:
        self.static(
            name, self.rr.StateConfiguration(values=list(values), colors=list(colours), visible=shown)
        )
        t, states = zip(*changes, strict=True)
        self.columns(name, np.array(t), self.rr.StateChange.columns(state=states))

    def _events(self) -> None:
        """Write the timeline from before the last event, which is bold; below it, those to come."""
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
    """Return the labels of states that have room in a lane of this time (s); others are blank."""
    first, last = span
    room = dict.fromkeys(values, 0.0)
    ends = [t for t, _ in changes[1:]] + [max(last, changes[-1][0])]
    for (begin, value), end in zip(changes, ends, strict=True):
        share = (min(end, last) - max(begin, first)) / max(last - first, 1e-9)
        room[value] = max(room[value], share * LANE_PX)
    labels = [value.replace("_", " ") for value in values]
    return [
        label if LETTER_PX * (len(label) + 1) <= room[value] else _BLANK
        for label, value in zip(labels, values, strict=True)
    ]


def _said(event: Any) -> str:
    name = shorten(str(event["name"]).replace("_", " "), MOST_LETTERS, placeholder=" ...")
    return f"warning: {name}" if event["key"] in TROUBLES else name


def _table(lines: Sequence[Sequence[str]], now: int) -> str:
    """The events from before number ``now`` on, as a table."""
    begin = max(now - 1, 0)
    rows = [[f"**{cell}**" if k == now and cell else cell for cell in line] for k, line in enumerate(lines)]
    return "\n".join(
        ["| time | event | where |", "|--:|:--|:--|", *("| " + " | ".join(r) + " |" for r in rows[begin:])]
    )


def _bursts(firing: np.ndarray) -> np.ndarray:
    """Close the gaps between pulses of one burst."""
    rows = np.flatnonzero(firing)
    close = np.flatnonzero((np.diff(rows) > 1) & (np.diff(rows) < POSE_HZ * 1.0))
    joined = firing.copy()
    for i in close:
        joined[rows[i] : rows[i + 1]] = True
    return joined
