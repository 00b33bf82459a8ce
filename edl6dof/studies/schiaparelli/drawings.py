"""Three figures: the chain of the one flight, the cliff, and the heights of release."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.report.figure import Figure, Panel
from edl6dof.sim.flight import Flight
from edl6dof.studies import plots
from edl6dof.studies.schiaparelli.conditions import GUARDS


def drawings(flight: Flight, rows: Sequence[Row]) -> tuple[Figure, ...]:
    """The chain, the cliff and the releases."""
    return (
        plots.figure("chain", (_rates(flight), _heights(flight))),
        plots.figure("cliff", (_cliff(flight, rows),)),
        plots.figure("release", (_releases(rows),)),
    )


def _rates(flight: Flight) -> Panel:
    """Pitch and yaw rate after the mortar, and the end of the range."""
    t, fired = flight.telemetry["t_s"] - flight.metrics["parachute_s"], (0.0, 5.0)
    end = flight.scenario.sensors.inertial_unit.gyros.range_deg_s
    shown = (t > fired[0]) & (t < fired[1])
    traces = [
        plots.curve(t[shown], flight.telemetry[f"truth.rate_{axis}_deg_s"][shown], name)
        for axis, name in (("q", "pitch"), ("r", "yaw"))
    ]
    for side in (1.0, -1.0):
        traces.append(
            plots.reference(np.array(fired), side * end * np.ones(2), "range" if side > 0.0 else "")
        )
    return plots.panel(
        "Body rates under the opening canopy", "time after the mortar (s)", "rate (deg/s)", traces
    )


def _heights(flight: Flight) -> Panel:
    """True height, and the one on board."""
    t, true = flight.telemetry["t_s"], flight.telemetry["truth.height_m"] / 1e3
    told = true + flight.telemetry["nav.error_height_m"] / 1e3
    shown = t > flight.metrics["parachute_s"]
    traces = (plots.curve(t[shown], true[shown], "true"), plots.curve(t[shown], told[shown], "on board"))
    return plots.panel("Height above ground", "time after entry (s)", "height (km)", traces)


def _cliff(flight: Flight, rows: Sequence[Row]) -> Panel:
    """Every flight of the sweep by its swing and the persistence of the flag."""
    end = flight.scenario.sensors.inertial_unit.gyros.range_deg_s
    own = [row for row in rows if row["sweep"] == "persistence"]
    traces = []
    for name, good in (("within limits", True), ("lost", False)):
        some = [row for row in own if bool(row["success"]) is good]
        swing = np.array([row["swing_deg_s"] / end for row in some])
        traces.append(plots.dots(swing, np.array([row["persistence_s"] for row in some]), name))
    traces.append(plots.reference(np.ones(2), np.array([0.0, 1.6]), "end of the range"))
    return plots.panel("Landed and lost", "fastest swing over the gyros' range", "flag stays on (s)", traces)


def _releases(rows: Sequence[Row]) -> Panel:
    """Height of backshell release by swing, for each of the first guards."""
    traces = []
    for guard in GUARDS[:5]:
        own = [row for row in rows if row["sweep"] == "guard" and row["guard"] == guard.name]
        own = [row for row in own if row.get("backshell_height_m") is not None]
        swing = np.array([row["swing_deg_s"] for row in own])
        traces.append(
            plots.dots(swing, np.array([row["backshell_height_m"] for row in own]) / 1e3, guard.name)
        )
    return plots.panel(
        "Release, one guard at a time", "fastest swing (deg/s)", "height of release (km)", traces
    )
