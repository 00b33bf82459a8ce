"""Lanes of states, and the timeline as text."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import shorten
from typing import Any

import numpy as np

from edl6dof.replay.history import POSE_HZ
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.views.layout import lanes_of, spans_of
from edl6dof.report.catalogue import STATES
from edl6dof.report.figure import BAD, BLUE, GREEN, ORANGE, VERMILION, rgb

CONFIGURATIONS = ("entry vehicle", "under parachute", "heat shield gone", "lander")
OFF, FIRE, RED = (48, 48, 54), rgb(ORANGE), rgb(BAD)
#: Keys of events that are warnings.
TROUBLES = ("fault", "diagnosis", "exclusion", "guard")
#: A thruster counts as firing from this duty on.
FIRING = 0.02
#: Least width of a page's lanes, and room that a letter takes, px.
LANE_PX, LETTER_PX = 800.0, 6.6
#: Letters of an event's name at most: a longer one, such as why a flight ended, would leave no room to tell
#: where.
MOST_LETTERS = 44
#: A label that shows nothing; for an empty one the viewer would show the state's own name.
_BLANK = " "


class Lanes(Recorder):
    """Writes the lanes of each page, ``/rcs``, ``/instruments`` and ``/events``; of the first flight only."""

    def motions(self) -> None:
        """Lanes and timeline."""
        if self.number:
            return
        whole = (float(self.t[0]), float(self.t[-1]))
        for page, span in {"Flight": whole, **spans_of(whole, self.when)}.items():
            self._states(lanes_of(page, [page]), span)
        self._thrusters()
        self._instruments()
        self._events()

    def _states(self, page: str, span: tuple[float, float]) -> None:
        """Phase, configuration and engine, as a page shows them of its own time."""
        motion = self.motion
        first = np.append(0, np.flatnonzero(np.diff(self.phase)) + 1)
        phases = [(float(self.t[i]), self.names[self.phase[i]]) for i in first]
        labels = fitted(phases, self.names, span)
        self._lane(f"{page}/Phase", phases, self.names, labels, self.colours.tolist())
        changes = [(float(self.t[0]), CONFIGURATIONS[0])]
        for name, place in zip(
            CONFIGURATIONS[1:], (motion.canopy, motion.heat_shield, motion.backshell), strict=True
        ):
            row = motion.released(place)
            if row is not None:
                changes.append((float(self.t[row]), name))
        labels, colours = fitted(changes, CONFIGURATIONS, span), map(rgb, (VERMILION, BLUE, GREEN, ORANGE))
        self._lane(f"{page}/Vehicle", changes, CONFIGURATIONS, labels, list(colours))
        if self.vehicle.engines:
            on = np.nan_to_num(self.flight["truth.engine_thrust_n"]) > 1.0
            self._switched(f"{page}/Engine", {"on": on}, {"on": FIRE})

    def _thrusters(self) -> None:
        """One lane each: firing or failed; pulses less than a second apart are one burst."""
        for k, jet in enumerate(self.flight.jets):
            failed = self.flight.failures.get(jet, np.zeros(len(self.t))) > 0
            firing = _bursts(self.flight.duty[:, k] > FIRING) & ~failed
            self._switched(
                f"rcs/{jet}", {"firing": firing, "failed": failed}, {"firing": FIRE, "failed": RED}
            )

    def _instruments(self) -> None:
        """One lane each: in use, saturated or excluded; of a beam, whether its echo was used."""
        for one in self.flight.instruments:
            colours = {state: rgb(STATES[state]) for state in one.states if state in STATES}
            self._switched(
                f"instruments/{one.kind}/{one.name}", {state: one.holds(state) for state in colours}, colours
            )

    def _switched(
        self, name: str, when: dict[str, np.ndarray], colours: dict[str, tuple[int, int, int]]
    ) -> None:
        """A lane that is off except where one of the states holds."""
        states = ["off", *when]
        code = np.zeros(len(self.t), int)
        for number, holds in enumerate(when.values(), 1):
            code[holds] = number
        first = np.append(0, np.flatnonzero(np.diff(code)) + 1)
        shown = [False] + [True] * len(when)
        changes = [(self.t[i], states[code[i]]) for i in first]
        self._lane(name, changes, states, states, [OFF, *colours.values()], shown)

    def _lane(
        self,
        name: str,
        changes: list[tuple[float, str]],
        values: Sequence[str],
        labels: Sequence[str],
        colours: Sequence[Any],
        shown: Any = None,
    ) -> None:
        self.static(
            name,
            self.rr.StateConfiguration(
                values=list(values), labels=list(labels), colors=list(colours), visible=shown
            ),
        )
        t, states = zip(*changes, strict=True)
        self.columns(name, np.array(t), self.rr.StateChange.columns(state=states))

    def _events(self) -> None:
        """The timeline from the event before the last one on, which is in bold; below it, what comes."""
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
    """Labels of states that have room for them in a lane of this time (s); those that have not stay blank."""
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
    """Firing, with the gaps between pulses of one burst closed."""
    rows = np.flatnonzero(firing)
    close = np.flatnonzero((np.diff(rows) > 1) & (np.diff(rows) < POSE_HZ * 1.0))
    joined = firing.copy()
    for i in close:
        joined[rows[i] : rows[i + 1]] = True
    return joined
