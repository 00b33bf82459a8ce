"""Figures of a flight from telemetry and events, at published events, of peaks and of the miss of the aim
point; and the limits on figures.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from math import isfinite, pi
from typing import Any, TypeVar

import numpy as np

from edl6dof.config.errors import Named, UnknownName
from edl6dof.config.text_table import text_table
from edl6dof.config.units import split_unit
from edl6dof.environment.heating import wall_temperature
from edl6dof.metrics.figures import BALANCES, DECLARED, FIGURES, LIMITS, Flown, Source, figure_of_merit
from edl6dof.spatial.arrays import interpolate
from edl6dof.spatial.elementary import asin, atan2, cos, sin
from edl6dof.spatial.frames import great_circle
from edl6dof.telemetry.columns import Telemetry
from edl6dof.vehicle.plant import HEAT

#: Quantities at any event of a mission, as endings of the names of figures; ``s`` is its time:
#: ``bridle_cut_height_m`` is the height above the ground at the event ``bridle_cut``.
AT_EVENTS = (
    *("s", "mach", "dynamic_pressure_pa", "altitude_m", "height_above_areoid_m", "height_m"),
    *("speed_m_s", "total_alpha_deg"),
)

Number = TypeVar("Number", bound=float | None)


class Figures(Named[Number]):
    """Figures of merit of a flight by name with unit suffix, as items and as attributes, which print as a
    table of name, value, unit and meaning.

    Raises:
        UnknownName: on access to an item that the flight does not have.
        AttributeError: on access to an attribute that it does not have.
    """

    def __init__(self, values: Mapping[str, Number]):
        """``values``: in the order of the table; ``None`` for one that could not be computed."""
        super().__init__("figure", values)

    def __getattr__(self, name: str) -> Number:
        if name in self:
            return self[name]
        raise AttributeError(str(UnknownName("figure", name, self)))

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        rows = [("figure", "value", "unit", "meaning")]
        for name, value in self.items():
            about = figure_of_merit(name)
            rows.append((name, "-" if value is None else f"{value:.6g}", about.unit.label, about.meaning))
        return text_table(rows, right=(1,))


@dataclass(frozen=True)
class Check:
    """One limit: figure by name and in words, value of this flight and allowed value, in ``unit``.

    ``least``: the allowed value is the smallest one; otherwise the largest.
    """

    figure: str
    label: str
    value: float
    limit: float
    unit: str
    least: bool = False

    @property
    def ok(self) -> bool:
        """True if the value is within the limit; NaN is not."""
        return bool(self.value >= self.limit if self.least else self.value <= self.limit)

    @property
    def allowed(self) -> str:
        """Sign of the comparison with the limit."""
        return ">=" if self.least else "<="

    @property
    def of_balance(self) -> bool:
        """True if the limit is that of a balance, which tests the simulator and not the mission."""
        return figure_of_merit(self.figure).source == "balance"

    @property
    def statement(self) -> str:
        """Text on a violated limit for the outcome; that on a balance contains its numbers."""
        if not self.of_balance:
            return self.label
        return f"{self.label}: {self.value:.1e}, limit {self.limit:g} {self.unit}".rstrip()


def checks(limits: Any, figures: dict[str, float]) -> list[Check]:
    """Return every limit that is set and whose figure the flight has, and every violated balance."""
    bounds = [(figure, getattr(limits, figure.limit)) for figure in LIMITS]
    bounds += [(figure, figure.allowed) for figure in BALANCES]
    found = [
        Check(figure.name, figure.meaning, figures[figure.name], bound, figure.unit.label, figure.clearance)
        for figure, bound in bounds
        if figure.name in figures and bound is not None
    ]
    return [check for check in found if not (check.of_balance and check.ok)]


def formed(flown: Flown, *sources: Source) -> dict[str, float]:
    """Compute the figures of these sources from telemetry and events, as far as the flight reached them."""
    wanted = (figure for figure in FIGURES if figure.source in sources and figure.form is not None)
    return {one.name: value for one in wanted if one.form and (value := one.form(flown)) is not None}


def event_and_quantity(name: str, events: Collection[str]) -> tuple[str, str] | None:
    """Event and quantity of a figure whose name consists of them; ``None`` for other figures."""
    for quantity in AT_EVENTS:
        event = name.removesuffix(f"_{quantity}")
        if event != name and event in events:
            return event, quantity
    return None


def event_figures(telemetry: Telemetry, wanted: Iterable[str], done: Mapping[str, float]) -> dict[str, float]:
    """Compute figures that are quantities at events of the mission, such as ``bridle_cut_height_m``.

    Args:
        telemetry: rows of the flight.
        wanted: names of figures; declared ones are ignored.
        done: time (s) of each event of the mission by its name, ``nan`` if it did not happen.
    """
    found = {}
    for name in wanted:
        at = None if name in DECLARED else event_and_quantity(name, done)
        if at is None or not isfinite(t := done[at[0]]) or t < telemetry["t_s"][0] - 1e-9:
            continue
        found[name] = t if at[1] == "s" else telemetry.at(t, f"truth.{at[1]}")[0]
    return found


def peak_figures(plant: np.void, peaks: np.void, when: dict[str, float]) -> dict[str, float]:
    """Largest loads since the initial state, and the heat load, in the units of their names."""
    found = {
        "peak_load_g0": peaks["entry_load"],
        "peak_dynamic_pressure_pa": peaks["dynamic_pressure"],
        "peak_heat_flux_w_cm2": peaks["heat_flux"],
        "peak_radiative_heat_flux_w_cm2": peaks["radiative_heat_flux"],
        "peak_wall_temperature_k": wall_temperature(peaks["heat_flux"]),
        "heat_load_j_cm2": plant["y"][HEAT],
    }
    if "mortar" in when:
        found["max_load_parachute_g0"] = peaks["parachute_load"]
        found["max_riser_tension_n"] = peaks["riser_tension"]
    return {name: float(value) / split_unit(name)[1].to_si for name, value in found.items()}


def relaxation_figures(relaxed: np.void) -> dict[str, float]:
    """Figures of the constraints that powered guidance relaxed (record ``RELAXED``); empty without any."""
    noted = np.flatnonzero(relaxed["t"] > 0.0)
    if not len(noted):
        return {}
    most = int(noted[-1])
    return {"constraints_relaxed": most + 1.0, "landing_error_m": float(relaxed["landing_error"][most])}


def deployment_figures(
    telemetry: Telemetry, mortar_fire_s: float, aim_point: tuple[float, float], radius_m: float
) -> dict[str, float]:
    """Miss of the aim point (latitude and longitude, rad) at mortar fire, m on a sphere of ``radius_m``.

    Downrange is positive beyond the aim point and crossrange positive right of it, both relative to the great
    circle on which the flight began towards it.
    """
    first, near = telemetry.rows(0, 1), telemetry.around(mortar_fire_s)
    start, here = _place(first, float(first["t_s"][0])), _place(near, mortar_fire_s)
    arc, azimuth = great_circle(start, here)
    goal, along = great_circle(start, aim_point)
    turn = azimuth - along
    return {
        "parachute_miss_m": radius_m * great_circle(here, aim_point)[0],
        "parachute_downrange_m": radius_m * (atan2(sin(arc) * cos(turn), cos(arc)) - goal),
        "parachute_crossrange_m": radius_m * asin(sin(arc) * sin(turn)),
    }


def _place(rows: Telemetry, t: float) -> tuple[float, float]:
    """Latitude and longitude, rad, of one row, or interpolated linearly between two at time ``t`` (s)."""
    latitude, longitude = (np.radians(rows[f"truth.{axis}_deg"]) for axis in ("latitude", "longitude"))
    without_jump = np.unwrap(longitude) if np.ptp(longitude) > pi else longitude
    return float(interpolate(t, rows["t_s"], latitude)), float(interpolate(t, rows["t_s"], without_jump))
