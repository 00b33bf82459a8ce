"""Lanes of states, the timeline as text, and the readout."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from edl6dof.replay.history import POSE_HZ, thin
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene.beams import RAYS
from edl6dof.replay.views.panels import SERIES
from edl6dof.telemetry.instruments import EXCLUDED, IN_USE, SATURATED

READOUT_HZ = 2.0
#: Telemetry column: label, format, unit.
READOUT = {
    "truth.altitude_m": ("above ellipsoid", ",.0f", "m"),
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
CONFIGURATIONS = ("entry vehicle", "under parachute", "heat shield gone", "lander")
GREY, FIRE, RED = (48, 48, 54), (250, 150, 60), (235, 50, 50)
#: Colours of what is made of an inertial instrument.
HEALTH = {IN_USE: (70, 130, 90), SATURATED: FIRE, EXCLUDED: RED}
#: Keys of events that are warnings.
TROUBLES = ("fault", "diagnosis", "exclusion", "guard")
#: A thruster counts as firing from this duty on.
FIRING = 0.02


class Lanes(Recorder):
    """Writes ``/phase``, ``/configuration``, ``/engine``, ``/rcs``, ``/instruments``, ``/events`` and
    ``/readout``; of the first flight only.
    """

    def motions(self) -> None:
        """Lanes, timeline, readout."""
        if self.number:
            return
        self._states()
        self._thrusters()
        self._instruments()
        self._events()
        self._readout()

    def _states(self) -> None:
        motion = self.motion
        first = np.append(0, np.flatnonzero(np.diff(self.phase)) + 1)
        labels = [name.replace("_", " ") for name in self.names]
        self._lane(
            "phase",
            [(self.t[i], self.names[self.phase[i]]) for i in first],
            self.names,
            labels,
            self.colours.tolist(),
        )
        changes = [(self.t[0], CONFIGURATIONS[0])]
        for name, place in zip(
            CONFIGURATIONS[1:], (motion.canopy, motion.heat_shield, motion.backshell), strict=True
        ):
            row = motion.released(place)
            if row is not None:
                changes.append((self.t[row], name))
        self._lane(
            "configuration",
            changes,
            CONFIGURATIONS,
            CONFIGURATIONS,
            [SERIES[1], SERIES[0], SERIES[2], SERIES[4]],
        )
        on = np.nan_to_num(self.flight["truth.engine_thrust_n"]) > 1.0
        self._switched("engine", {"on": on}, {"on": FIRE})

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
            colours = RAYS if one.kind == "beam" else HEALTH
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
        self._lane(
            name,
            [(self.t[i], states[code[i]]) for i in first],
            states,
            states,
            [GREY, *colours.values()],
            shown,
        )

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
        events = [event for event in self.flight.events if np.isfinite(event["t_s"])]
        if events:
            text = [
                f"{event['name']}: {event['detail']}" if event["detail"] else event["name"]
                for event in events
            ]
            level = ["WARN" if event["key"] in TROUBLES else "INFO" for event in events]
            level[-1] = "INFO" if self.flight.success else "ERROR"
            self.columns(
                "events",
                np.array([e["t_s"] for e in events]),
                self.rr.TextLog.columns(text=text, level=level),
            )

    def _readout(self) -> None:
        """What a flight controller would read off, twice a second; and what has failed."""
        rows = thin(self.t, READOUT_HZ)
        lines = [
            [f"| {label} | **{value:{form}}** {unit} |" for value in self.flight[name][rows].tolist()]
            for name, (label, form, unit) in READOUT.items()
            if name in self.flight.columns
        ]
        titles = [self.names[phase].replace("_", " ") for phase in self.phase[rows]]
        text = [
            f"## T+{t:.1f} s\n**{title}**\n\n" + "\n".join([first, "|:--|--:|", *more, "", troubles])
            for t, title, (first, *more), troubles in zip(
                self.t[rows].tolist(), titles, zip(*lines, strict=True), self._troubles(rows), strict=True
            )
        ]
        media = ["text/markdown"] * len(text)
        self.columns("readout", self.t[rows], self.rr.TextDocument.columns(text=text, media_type=media))

    def _troubles(self, rows: np.ndarray) -> list[str]:
        """What has failed, was diagnosed or is excluded, at some rows."""
        flight = self.flight
        holds = {
            "failed": {jet: state[rows] > 0 for jet, state in flight.failures.items()},
            "diagnosed": {jet: self.t[rows] >= found.t_s for jet, found in flight.diagnosed.items()},
            "excluded": {one.name: one.holds(EXCLUDED)[rows] for one in flight.instruments},
        }
        told: list[list[str]] = [[] for _ in rows]
        for word, by_name in holds.items():
            for k in np.flatnonzero(np.any([*by_name.values(), np.zeros(len(rows), bool)], axis=0)):
                names = ", ".join(name for name, there in by_name.items() if there[k])
                told[k].append(f"**{word}:** {names}")
        return ["  \n".join(lines) for lines in told]


def _bursts(firing: np.ndarray) -> np.ndarray:
    """Firing, with the gaps between pulses of one burst closed."""
    rows = np.flatnonzero(firing)
    close = np.flatnonzero((np.diff(rows) > 1) & (np.diff(rows) < POSE_HZ * 1.0))
    joined = firing.copy()
    for i in close:
        joined[rows[i] : rows[i + 1]] = True
    return joined
