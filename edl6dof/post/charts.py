"""The plots, phase lanes, timeline and readout of the replay."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.post.history import spans, thin
from edl6dof.post.layout import GROUPS, PLOTS, SERIES, Plot
from edl6dof.post.recorder import SCALAR_HZ, Recorder

if TYPE_CHECKING:
    import rerun as rr

READOUT_HZ = 2.0
#: Telemetry column: label, format, unit.
READOUT = {
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


#: Telemetry columns that the charts show.
COLUMNS = tuple(name for plots in PLOTS.values() for plot in plots for name in plot.series) + tuple(READOUT)


class Charts(Recorder):
    """Writes ``/plots``, ``/states``, ``/events`` and ``/readout``."""

    def statics(self) -> None:
        """Names and colours of the series."""
        self._series_styles()

    def series(self) -> None:
        """Everything over time."""
        self._plots()
        self._states()
        self._readout()

    def _series_styles(self) -> None:
        for plots in PLOTS.values():
            for plot in plots:
                self.static(f"plots/{plot.entity}", self._lines(list(plot.series.values())))
        for group in GROUPS:
            names = [jet.name for jet in self.vehicle.rcs.thrusters if jet.group == group]
            if names:
                self.static(f"plots/thruster_duty/{group}", self._lines(names))

    def _lines(self, names: list[str]) -> rr.SeriesLines:
        colours = [SERIES[i % len(SERIES)] for i in range(len(names))]
        return self.rr.SeriesLines(names=names, colors=colours, widths=[1.5] * len(names))

    def _plots(self) -> None:
        rows = thin(self.t, SCALAR_HZ)
        for plots in PLOTS.values():
            for plot in plots:
                self._plot(plot, rows)
        for group in GROUPS:
            names = [jet.name for jet in self.vehicle.rcs.thrusters if jet.group == group]
            if names:
                duty = self.flight.mean_duty(thin(self.t, SCALAR_HZ), names)
                self._scalars(f"plots/thruster_duty/{group}", self.t[rows], duty)

    def _plot(self, plot: Plot, rows: np.ndarray) -> None:
        t = self.t[rows]
        keep = (t >= self.when.get(plot.since, -np.inf)) & (t <= self.when.get(plot.until, np.inf))
        if keep.any():
            values = np.stack([self.flight[name][rows[keep]] for name in plot.series], axis=-1)
            self._scalars(f"plots/{plot.entity}", t[keep], values * plot.scale)

    def _scalars(self, entity: str, t: np.ndarray, values: np.ndarray) -> None:
        columns = self.rr.Scalars.columns(scalars=values.ravel())
        self.columns(entity, t, columns.partition(np.full(len(t), values.shape[1])))

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
        on = np.nan_to_num(self.flight["truth.engine_thrust_n"]) > 1.0
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
            self.columns("events", np.array([e["t_s"] for e in events]), rr.TextLog.columns(text=text, level=level))

    def _lane(self, name: str, changes: list[tuple[float, str]], values: list[str], labels: list[str], colours: list[Any]) -> None:
        self.static(f"states/{name}", self.rr.StateConfiguration(values=values, labels=labels, colors=colours))
        t, states = zip(*changes, strict=True)
        self.columns(f"states/{name}", np.array(t), self.rr.StateChange.columns(state=states))

    def _readout(self) -> None:
        """What a flight controller would read off, twice a second."""
        rows = thin(self.t, READOUT_HZ)
        column = {name: self.flight[name][rows] for name in READOUT}
        text = []
        for k, row in enumerate(rows):
            lines = [f"| {label} | **{column[name][k]:{form}}** {unit} |" for name, (label, form, unit) in READOUT.items()]
            title = self.names[self.phase[row]].replace("_", " ")
            text.append(f"## T+{self.t[row]:.1f} s\n**{title}**\n\n" + "\n".join([lines[0], "|:--|--:|", *lines[1:]]))
        media = ["text/markdown"] * len(text)
        self.columns("readout", self.t[rows], self.rr.TextDocument.columns(text=text, media_type=media))
