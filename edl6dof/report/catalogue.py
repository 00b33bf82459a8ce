"""Catalogue of plots over time: each is declared once, for reports, comparisons, papers and replays.

Units are those of the channels.  A report stacks plots above each other (:data:`STACKS`);
:mod:`edl6dof.replay.pages` lists the plots of each page of a replay.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from math import inf
from typing import NamedTuple, Protocol

import numpy as np

from edl6dof.config.errors import nearest, refusal
from edl6dof.report.document import printed
from edl6dof.report.figure import Axis, Dash, Figure, Panel, Trace
from edl6dof.report.palette import BAD, BLUE, GREEN, GREY, ORANGE, PURPLE, ROUGH, SAFE, SERIES, STEEP, UNSEEN
from edl6dof.telemetry.columns import EXCLUDED, IN_USE, NOT_USED, SATURATED, USED, describe

#: Number of claimed standard deviations at which bounds are drawn.
BOUND = 3.0
#: Names of curves that are drawn dashed: commanded or estimated values, over the true ones.
_DASHED = ("commanded", "reference", "believed", "navigated, no wind", "above the areoid")
#: Colours of the states of an instrument; a radar beam without an echo has none.
STATES = {IN_USE: GREEN, USED: BLUE, SATURATED: ORANGE, NOT_USED: PURPLE, EXCLUDED: BAD}
#: Words and colours of the classes of cells of a hazard map.
CELLS: dict[str, tuple[str, str]] = {
    "safe": ("safe to stand on", SAFE),
    "edge": ("not all of it seen", UNSEEN),
    "slope": ("too steep", STEEP),
    "rock": ("too rough", ROUGH),
}


class Plot(NamedTuple):
    """One plot over time.

    Attributes:
        key: name of the plot, and of its entity in a recording.
        title: quantity, without the unit.
        curves: names in the legend by channel; all channels have one unit.
        kilo: True to draw in thousands of the channels' unit.
        since, until: milestones between which the plot is valid; empty: start and end of the flight.
        bounds: True to draw claimed standard deviations around an error that is alone in its plot.
        clip: True if the axis may cut off a single peak.
    """

    key: str
    title: str
    curves: Mapping[str, str]
    kilo: bool = False
    since: str = ""
    until: str = ""
    bounds: bool = False
    clip: bool = False

    @property
    def label(self) -> str:
        """Title with the unit in brackets."""
        unit = "k" * self.kilo + printed(describe(next(iter(self.curves)))[0] or "1")
        return f"{self.title} ({'Earth g' if unit == 'g' else unit})"

    @property
    def sigma(self) -> str:
        """Channel of the claimed standard deviation of an error; empty where no bounds are drawn."""
        alone = self.bounds and len(self.curves) == 1
        return next(iter(self.curves)).replace("nav.error", "nav.sigma") if alone else ""

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels that are drawn, the claimed standard deviation last."""
        return (*self.curves, *[self.sigma] * bool(self.sigma))

    @property
    def lines(self) -> list[tuple[str, str, Dash]]:
        """Name, colour and dash of each array that :meth:`values` returns."""
        found: list[tuple[str, str, Dash]] = [
            ("error" if self.sigma else name, colour, "dash" if name in _DASHED else "solid")
            for name, colour in zip(self.curves.values(), SERIES, strict=False)
        ]
        claimed = f"{BOUND:.0f} σ claimed"
        return [*found, (claimed, GREY, "dash"), (claimed, GREY, "dash")] if self.sigma else found

    def values(self, columns: Mapping[str, np.ndarray], rows: np.ndarray | slice) -> list[np.ndarray]:
        """Return the curves at some rows in the unit of the plot, then the upper and the lower bound."""
        factor = 1e-3 if self.kilo else 1.0
        found = [factor * columns[channel][rows] for channel in self.curves]
        bounds = [sign * BOUND * factor for sign in (1.0, -1.0)] if self.sigma else []
        return found + [bound * columns[self.sigma][rows] for bound in bounds]

    def apart(self, since: str = "") -> tuple[Plot, ...]:
        """Return one plot for each curve; ``since``: event at which these begin, by default as this plot."""
        own = self._replace(since=since or self.since)
        return tuple(
            own._replace(key=f"{own.key}_{name}", title=f"{own.title}, {name}", curves={channel: name})
            for channel, name in own.curves.items()
        )

    def shown(self, columns: Mapping[str, np.ndarray]) -> Plot | None:
        """Return the plot with those of its channels that ``columns`` has; of commands and estimates only
        those with a signal, of equal true quantities only the first.

        ``None`` if no channel has a signal.
        """
        there = {channel: name for channel, name in self.curves.items() if channel in columns}
        heard = {channel for channel in there if has_signal(columns[channel])}
        kept = dict[str, str]()
        for channel, name in there.items():
            true = channel.startswith("truth.")
            known = (columns[one] for one in kept if one in heard and one.startswith("truth."))
            if channel in heard and not true or true and not any(equal(columns[channel], k) for k in known):
                kept[channel] = name
        return self._replace(curves=kept) if heard else None


def has_signal(values: np.ndarray) -> bool:
    """Return True if any value is neither zero nor NaN."""
    return bool(np.any(np.nan_to_num(values) != 0.0))


def equal(first: np.ndarray, second: np.ndarray) -> bool:
    """Return True if two curves differ by less than a plot can show."""
    size = np.abs(first[np.isfinite(first)]).max(initial=0.0)
    return bool(np.allclose(first, second, rtol=0.0, atol=1e-6 * size, equal_nan=True))


def _axes(channel: str, names: str, letters: str = "") -> dict[str, str]:
    """Map the channel of each axis, whose letter replaces ``{}``, to the name of the axis."""
    pairs = zip((letters or names).split(), names.split(), strict=True)
    return {channel.format(letter): name for letter, name in pairs}


def _each_axis(key: str, title: str, curves: Mapping[str, str], clip: bool = False) -> tuple[Plot, ...]:
    """One plot for each body axis x, y, z, which replaces ``{}`` in the key and in the channels."""
    return tuple(
        Plot(key.format(axis), f"{title}, {name}", {c.format(axis): curve for c, curve in curves.items()},
             until="touchdown", clip=clip)
        for axis, name in zip("xyz", ("roll", "pitch", "yaw"), strict=True)
    )  # fmt: skip


# fmt: off
ALTITUDE = Plot("altitude", "height", {
    "truth.altitude_m": "above the ellipsoid", "truth.height_above_areoid_m": "above the areoid",
    "truth.height_m": "above the ground"}, kilo=True)
SPEED = Plot("speed", "speed over ground", {"truth.speed_m_s": "speed"}, kilo=True)
MACH = Plot("mach", "Mach number", {"truth.mach": "Mach"}, until="backshell")
PRESSURE = Plot("dynamic_pressure", "dynamic pressure", {"truth.dynamic_pressure_pa": "dynamic pressure"},
                kilo=True, until="backshell")
LOAD = Plot("load_g0", "load", {"truth.load_g0": "sensed acceleration"})
HEAT = Plot("heat_flux_w_cm2", "heat flux", {"truth.heat_flux_w_cm2": "stagnation point"}, until="mortar")
RATES = Plot("body_rate_deg_s", "body rate", _axes("truth.rate_{}_deg_s", "roll pitch yaw", "p q r"))
BANK = Plot("bank_deg", "bank", {"truth.bank_deg": "flown", "guide.bank_deg": "commanded"}, until="mortar")
ALPHA, BETA = (
    Plot(f"{angle}_deg", title, {f"truth.{angle}_deg": "true", f"nav.{angle}_deg": "navigated, no wind"},
         until="backshell")
    for angle, title in (("alpha", "angle of attack"), ("beta", "sideslip")))
TOTAL_ALPHA = Plot("total_alpha_deg", "total angle of attack", {"truth.total_alpha_deg": "total"},
                   until="backshell")
DRAG = Plot("drag_m_s2", "drag", {"nav.drag_m_s2": "measured", "guide.reference_drag_m_s2": "reference"},
            until="mortar")
RANGE = Plot("range_to_go_km", "range to go", {"guide.range_to_go_km": "range to go"}, until="mortar")
CROSSRANGE = Plot("crossrange_km", "crossrange", {"guide.crossrange_km": "right +"}, until="mortar")
DRAG_DISTURBANCE, PATH_DISTURBANCE = (
    Plot(name, f"estimated {title} disturbance", {f"guide.{name}": "estimated"}, until="mortar")
    for name, title in (("drag_disturbance_m_s4", "drag"), ("path_disturbance_deg_s", "path")))
TENSION = Plot("riser_tension", "riser tension", {"truth.riser_tension_n": "tension"}, kilo=True,
               since="mortar", until="backshell")
DESCENT = Plot("descent_m_s", "descent speed", {"truth.v_down_m_s": "down"}, since="mortar")
HEIGHT = Plot("height_m", "height above the ground", {"truth.height_m": "height"}, since="backshell")
VELOCITY = Plot("velocity_m_s", "velocity", _axes("truth.v_{}_m_s", "down north east"), since="backshell")
THRUST = Plot("engine_thrust", "engine thrust", {
    "truth.engine_thrust_n": "delivered", "guide.thrust_n": "commanded"}, kilo=True, since="backshell")
TILT = Plot("tilt_deg", "tilt from the vertical", {"truth.tilt_deg": "thrust axis"}, since="backshell")
OFFSET = Plot("site_offset_m", "distance from the site", {
    "truth.site_east_m": "east", "truth.site_north_m": "north"}, since="backshell")
TO_GO = Plot("time_to_go_s", "time to go", {"guide.time_to_go_s": "powered guidance"}, since="backshell")
PROPELLANT = Plot("propellant_kg", "propellant left", {"truth.propellant_kg": "left"})
MASS = Plot("mass_kg", "mass", {"truth.mass_kg": "true", "nav.mass_kg": "believed"})
ERROR = Plot("attitude_error_deg", "attitude error", _axes("control.error_{}_deg", "roll pitch yaw"))
DEMAND = _each_axis("torque_{}_nm", "control torque", {
    "control.torque_{}_nm": "demanded", "control.unallocated_{}_nm": "unallocated"})
TORQUES = _each_axis("disturbance_torque_{}_nm", "disturbance torque", {
    "truth.disturbance_{}_nm": "true", "estimate.torque_{}_nm": "estimated"}, clip=True)
FORCE = Plot("disturbance_force_n", "disturbance force", {
    "truth.aero_force_y_n": "y, aerodynamic", "truth.aero_force_z_n": "z, aerodynamic",
    "estimate.force_y_n": "y, estimated", "estimate.force_z_n": "z, estimated"}, until="mortar")
DIAGNOSIS = Plot("diagnosis", "thruster diagnosis", {
    "diagnosis.confidence": "confidence", "diagnosis.isolated": "isolated"})
POSITION_ERROR, VELOCITY_ERROR, ATTITUDE_ERROR = (
    Plot(f"nav_{name}", f"{name} error", _axes(f"nav.error{end}", "north east down"), bounds=True)
    for name, end in (("position", "_{}_m"), ("velocity", "_v_{}_m_s"), ("attitude", "_attitude_{}_deg")))
HEIGHT_ERROR = Plot("nav_height_m", "height error", {"nav.error_height_m": "error"}, since="backshell",
                    bounds=True)
INNOVATION = Plot("nav_innovation", "largest innovation", {
    "nav.range_innovation": "range", "nav.speed_innovation": "speed"}, since="heat_shield")
# fmt: on
#: All plots by key.
CATALOGUE: dict[str, Plot] = {
    plot.key: plot
    for value in tuple(vars().values())
    for plot in ([value] if isinstance(value, Plot) else value if isinstance(value, tuple) else [])
    if isinstance(plot, Plot)
}


def plot_of(channel: str) -> Plot:
    """Return a plot of one channel, in the unit of the plot that shows it."""
    there = next((plot for plot in CATALOGUE.values() if channel in plot.curves), None)
    title = there.title if there and len(there.curves) == 1 else describe(channel)[1]
    return Plot(channel, title, {channel: ""}, kilo=there is not None and there.kilo)


class Stack(NamedTuple):
    """Plots above each other in a report.

    Attributes:
        caption: text in which ``{name}`` is replaced by the figure of merit of that name.
        height: height of each plot, px.
        needs: channels of which one must have a signal, or an event that must have happened.
        since, until: events between which the plots are drawn, instead of their own.
        around: first and last time (s) that are drawn, relative to the event ``since``, if given.
        within: channel and two values, if given: only rows with the channel between them are drawn.
    """

    key: str
    title: str
    plots: Sequence[Plot]
    caption: str = ""
    height: int = 160
    needs: tuple[str, ...] = ()
    since: str = ""
    until: str = ""
    around: tuple[float, float] | None = None
    within: tuple[str, float, float] | None = None


# fmt: off
_TURNING = tuple(f"truth.rate_{axis}_deg_s" for axis in "pqr")
_GUIDED = ("guide.range_to_go_km",)
_NEAR_GROUND = HEIGHT_ERROR, *VELOCITY_ERROR.apart()[::-1]
_TRUE_AXES = "Estimated less true, in the axes of the true place."
_GROUND = "Estimated less true: height above the ground below, and velocity relative to it."

OVERVIEW = Stack("overview", "The whole flight", (ALTITUDE, SPEED, PRESSURE, LOAD, HEAT),
    "Heights have three zeros: the ellipsoid, the areoid (from which maps count), and the ground below; "
    "equal heights are drawn once.", 150,
    until="end")
NEAR_GROUND = Stack("near_ground", "The last 4 km", (ALTITUDE,),
    "From 4 km above the ground, where the three heights differ visibly.", 240, ("mortar",),
    until="end", within=("truth.height_m", -inf, 4000.0))
NAV_POSITION, NAV_ATTITUDE, NAV_VELOCITY = (
    Stack(plot.key, f"Error of {title}", plot.apart(), _TRUE_AXES, 150, until="touchdown")
    for title, plot in (("position", POSITION_ERROR), ("attitude", ATTITUDE_ERROR),
                        ("velocity before the radar's first echo", VELOCITY_ERROR)))
NAV_LANDING = Stack("nav_landing", "Height and velocity under power", _NEAR_GROUND, _GROUND, 130,
    since="ignition", until="touchdown")
NAV_TOUCHDOWN = Stack("nav_touchdown", "Height and velocity in the last 40 s", _NEAR_GROUND, _GROUND, 130,
    ("touchdown",), since="touchdown", around=(-40.0, 0.0))
NAV_INNOVATION = Stack("nav_innovation", "Radar: innovations", INNOVATION.apart(),
    "Largest normalised innovation of a beam; a reading beyond the gate is not used.", 130, until="touchdown")
TORQUE = Stack("torque", "Control torque", DEMAND, "In body axes.")
PROPELLANT_AND_MASS = Stack("propellant", "Propellant and mass", (PROPELLANT, MASS),
    "{propellant_used_kg:.1f} kg used.", 180, ("truth.propellant_kg",))
DISTURBANCE = Stack("disturbance_torque", "Disturbance torque", TORQUES,
    "Moment of {acting}, in body axes. A peak far above all other values, as of touchdown, is cut off.")
#: Stacks by section, for the sections of a report that consist of stacks alone.
STACKS: dict[str, tuple[Stack, ...]] = {
    "guidance": (
        Stack("bank", "Bank angle", (BANK, RATES.apart()[0]), "{bank_reversals:.0f} bank reversals.", 230,
            _GUIDED, until="mortar"),
        Stack("targeting", "Drag against the reference, and the way to go",
            (DRAG, RANGE, CROSSRANGE, DRAG_DISTURBANCE, PATH_DISTURBANCE),
            "Range and crossrange to the aim point of the entry; crossrange is positive when heading right "
            "of it.", 190, _GUIDED),
    ),
    "attitude": (
        Stack("air_angles", "Angles to the air", (ALPHA, BETA, TOTAL_ALPHA),
            "Shown while dynamic pressure is above 1 Pa.", 160, _TURNING,
            within=("truth.dynamic_pressure_pa", 1.0, inf)),
        Stack("rates", "Body rates", RATES.apart(), "Inertial rates in body axes.", 150, _TURNING,
            until="touchdown"),
        Stack("attitude_error", "Attitude error used by the controller", ERROR.apart(),
            "Goal minus actual, as each phase's controller defines it; during the lift phase the roll "
            "channel is the bank error.", 150, _TURNING),
    ),
    "chute": (
        Stack("inflation", "Parachute inflation", (TENSION, LOAD, MACH),
            "Mortar fire, line stretch and inflation.", 160, ("mortar",), since="mortar", until="backshell",
            around=(-0.5, 8.0)),
        Stack("parachute", "Under the parachute", (DESCENT, TOTAL_ALPHA, TILT), "", 160, ("mortar",),
            since="mortar", until="backshell"),
    ),
    "landing": (
        Stack("powered", "Powered descent", (HEIGHT, VELOCITY, THRUST, TILT), "", 160, ("ignition",),
            until="touchdown"),
    ),
}
# fmt: on
#: Those that need no more than a flight, by key, in the order of its report.
ALL_STACKS: dict[str, Stack] = {
    stack.key: stack
    for stack in (
        *(OVERVIEW, NEAR_GROUND, *STACKS["guidance"], NAV_POSITION, NAV_ATTITUDE, NAV_LANDING),
        *(NAV_TOUCHDOWN, NAV_INNOVATION, *STACKS["attitude"], TORQUE, PROPELLANT_AND_MASS, DISTURBANCE),
        *(*STACKS["chute"], *STACKS["landing"]),
    )
}


class Columns(Protocol):
    """Columns by name, each shape (rows,), in the unit of its name's suffix."""

    def __iter__(self) -> Iterator[str]: ...
    def __getitem__(self, name: str, /) -> np.ndarray: ...
    def unit(self, name: str) -> str:
        """Return the printed unit of a column."""

    def meaning(self, name: str) -> str:
        """Return the meaning of a column."""


def chosen(columns: Columns, patterns: Sequence[str], place: object) -> list[str]:
    """Return the names of the columns that match, in the order of the patterns; a pattern may also be the key
    of a plot, and then matches the channels of the plot.  ``place``: owner of the columns, for messages.

    Raises:
        ConfigError: a pattern matches nothing.
    """
    found: dict[str, None] = {}
    for pattern in patterns:
        plotted = CATALOGUE[pattern].channels if pattern in CATALOGUE else ()
        names = [name for name in columns if name in plotted or fnmatchcase(name, pattern)]
        if not names:
            begun = [name for name in columns if name.startswith(pattern)]
            near = f"{pattern}*" if len(begun) > 1 else nearest(pattern, begun or list(columns))
            hint = f"; did you mean {near!r}?" if near else ""
            raise refusal(place, f"no channel {pattern!r}{hint} (edl6dof plot RUN lists all)")
        found.update(dict.fromkeys(names))
    return list(found)


def channel_plot(
    columns: Columns, channels: Sequence[str], x: str, rows: np.ndarray, apart: bool = False
) -> Figure:
    """Draw channels over ``x`` at ``rows`` (bool): a panel for each unit, or for each if ``apart``."""
    panelled: dict[str, list[str]] = {}
    for name in channels:
        panelled.setdefault(name if apart else columns.unit(name), []).append(name)
    across = Axis(f"{columns.meaning(x)} ({columns.unit(x) or '1'})")
    panels = []
    for names in panelled.values():
        unit, many = columns.unit(names[0]) or "1", apart and len(channels) > 1
        meaning = columns.meaning(names[0]) if len(names) == 1 and not many else "" if many else "value"
        traces = [Trace(columns[x][rows], columns[name][rows], name) for name in names]
        heading = f"{names[0]}: {columns.meaning(names[0])}" if many else ""
        panels.append(Panel(across, Axis(f"{meaning} ({unit})" if meaning else unit), traces, title=heading))
    title = ", ".join(channels) if len(channels) < 4 else f"{len(channels)} channels"
    return Figure("plot", title, panels, share_x=True, height=320 if len(panels) < 3 else 200)
