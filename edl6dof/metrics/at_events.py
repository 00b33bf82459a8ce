"""Figures of a flight at any event of its mission: ``bridle_cut_height_m`` is the height above the ground at
the event ``bridle_cut``, ``bridle_cut_s`` the time of it.

They need no declaration: a scenario that publishes one has it formed.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from math import isfinite

from edl6dof.metrics.figures import DECLARED
from edl6dof.telemetry.columns import Telemetry

#: What is known at an event, each with the ending of the figure's name; ``s`` is the time of it.
AT_EVENTS = (
    "s",
    "mach",
    "dynamic_pressure_pa",
    "altitude_m",
    "height_above_areoid_m",
    "height_m",
    "speed_m_s",
    "total_alpha_deg",
)


def event_and_quantity(name: str, events: Collection[str]) -> tuple[str, str] | None:
    """Event and quantity that the name of a figure is put together from; ``None`` where it is not."""
    for quantity in AT_EVENTS:
        event = name.removesuffix(f"_{quantity}")
        if event != name and event in events:
            return event, quantity
    return None


def event_figures(telemetry: Telemetry, wanted: Iterable[str], done: Mapping[str, float]) -> dict[str, float]:
    """Those of the ``wanted`` figures that are at events of the flight.

    Args:
        telemetry: its rows.
        wanted: names of figures; those that are declared are passed over.
        done: time (s) of each event of the mission by its name, ``nan`` of one that did not come.
    """
    found = {}
    for name in wanted:
        at = None if name in DECLARED else event_and_quantity(name, done)
        if at is None or not isfinite(t := done[at[0]]) or t < telemetry["t_s"][0] - 1e-9:
            continue
        found[name] = t if at[1] == "s" else telemetry.at(t, f"truth.{at[1]}")[0]
    return found
