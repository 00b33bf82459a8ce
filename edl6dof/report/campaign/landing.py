"""Where the flights came down and where their parachutes opened."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

import numpy as np

from edl6dof.campaign.statistics import ellipse, percent
from edl6dof.report.campaign.margins import in_words, shown_shares
from edl6dof.report.campaign.results import Results
from edl6dof.report.document import Block, Row, Table
from edl6dof.report.figure import BAD, BLACK, BLUE, PURPLE, VERMILION, Axis, Dash, Figure, Mark, Panel, Trace

#: Points of each kind that carry the number of their case.
_NAMED = 4
#: Width and height of it with a little room, as shares of the axes.
_WORD = (0.2, 0.16)

#: Flights marked for the least height at mortar fire.
_LOWEST = 3

_DASHES: dict[int, Dash] = {1: "solid", 2: "dash", 3: "dot"}


def blocks(results: Results) -> Iterator[Block]:
    """Footprint with its ellipses, and the box of parachute deployment."""
    if results.has("landing_east_m") and np.isfinite(results["landing_east_m"]).sum() > 2:
        yield footprint(results)
        yield ellipse_table(results)
    if results.has("parachute_mach"):
        yield deployment(results)


def footprint(results: Results) -> Figure:
    """Landing points about the site, with the ellipses of one to three standard deviations."""
    east, north = results["landing_east_m"] / 1e3, results["landing_north_m"] / 1e3
    down = np.isfinite(east)
    wide = float(np.ptp(north[down])) or 1.0
    traces = list(_points(results, east, north, (wide, wide)))
    for sigmas, dash in _DASHES.items():
        x, y = ellipse(east[down], north[down], sigmas)
        traces.append(Trace(x, y, f"{sigmas} sigma", colour=BLACK, dash=dash))
    traces.append(Trace(np.zeros(1), np.zeros(1), "target", "points", VERMILION, symbol="cross", width=3.0))
    panel = Panel(
        Axis("east of the landing site (km)"), Axis("north of the landing site (km)"), traces, equal=True
    )
    caption = "A normal cloud has 39, 86 and 99 % of its points inside the ellipses."
    return Figure("footprint", "Landing footprint", [panel], caption, height=560)


def _points(results: Results, x: np.ndarray, y: np.ndarray, spans: tuple[float, float]) -> Iterator[Trace]:
    """Successes and failures; failures and the outermost successes carry the number of their case, as far as
    axes of these spans leave room for it.
    """
    both = np.isfinite(x) & np.isfinite(y)
    middle = [np.median(values[both]) if both.any() else 0.0 for values in (x, y)]
    scale = [max(float(np.std(values[both])), 1e-12) if both.any() else 1.0 for values in (x, y)]
    out = np.hypot((x - middle[0]) / scale[0], (y - middle[1]) / scale[1])
    for chosen, name, colour in ((results.ok, "success", BLUE), (~results.ok, "no success", BAD)):
        shown = np.flatnonzero(chosen & both)
        if len(shown):
            named = _apart(shown[np.argsort(-out[shown])], x / spans[0], y / spans[1])
            labels = [f"case {results.cases[index]}" if index in named else "" for index in shown]
            yield Trace(x[shown], y[shown], name, "points", colour, labels=labels)


def _apart(order: np.ndarray, x: np.ndarray, y: np.ndarray) -> set[int]:
    """The first of an order, without those so near to one before that their words would cover each other;
    ``x`` and ``y`` in shares of their axes.
    """
    taken: list[int] = []
    for index in order[: 4 * _NAMED]:
        beside = [abs(x[index] - x[k]) < _WORD[0] and abs(y[index] - y[k]) < _WORD[1] for k in taken]
        if not any(beside) and len(taken) < _NAMED:
            taken.append(int(index))
    return set(taken)


def ellipse_table(results: Results) -> Table:
    """Size and direction of the footprint."""
    east, north = results["landing_east_m"], results["landing_north_m"]
    down = np.isfinite(east)
    values, vectors = np.linalg.eigh(np.cov(np.stack([east[down], north[down]])))
    minor, major = np.sqrt(np.maximum(values, 0.0)) / 1e3
    heading = np.degrees(np.arctan2(vectors[0, 1], vectors[1, 1])) % 180.0
    distance = np.hypot(east[down], north[down]) / 1e3
    rows: list[Row] = [
        ("centre east, north", f"{east[down].mean() / 1e3:+.2f}, {north[down].mean() / 1e3:+.2f}", "km"),
        ("half axes of the 3 sigma ellipse", f"{3 * major:.2f} x {3 * minor:.2f}", "km"),
        ("direction of the long axis", f"{heading:.0f}", "deg from north through east"),
        *(
            (f"distance from the target: {percent(share)}", in_words(results, distance, share), "km")
            for share in shown_shares(results)
            if 0.5 <= share < 1.0
        ),
        ("distance from the target: largest", f"{distance.max():.2f}", "km"),
    ]
    return Table(["", "value>", "unit"], rows)


def deployment(results: Results) -> Figure:
    """Mach number, dynamic pressure, height and angle of attack at mortar fire, with the limits."""
    limit = {figure: limit for figure, _, limit, _ in results.limits}
    mach, pressure = results["parachute_mach"], results["parachute_dynamic_pressure_pa"]
    across = _axis("Mach number (1)", mach, limit.get("parachute_mach"))
    up = _axis("dynamic pressure (Pa)", pressure, limit.get("parachute_dynamic_pressure_pa"))
    marks = [
        *_limit("x", limit.get("parachute_mach")),
        *_limit("y", limit.get("parachute_dynamic_pressure_pa")),
    ]
    box = Panel(across, up, list(_points(results, mach, pressure, (_span(across), _span(up)))), marks=marks)
    height, alpha = results["parachute_height_m"] / 1e3, results["parachute_total_alpha_deg"]
    low = np.argsort(height)[:_LOWEST]
    lowest = Trace(height[low], alpha[low], f"lowest {_LOWEST}", "points", PURPLE, symbol="cross")
    across = _axis("height above the ground below (km)", height, None)
    up = _axis("total angle of attack (deg)", alpha, limit.get("parachute_total_alpha_deg"))
    points = [*_points(results, height, alpha, (_span(across), _span(up))), lowest]
    attitude = Panel(across, up, points, marks=list(_limit("y", limit.get("parachute_total_alpha_deg"))))
    caption = "At mortar fire; dashed: the limits."
    return Figure("deployment", "Parachute deployment", [box, attitude], caption, height=340)


def _span(axis: Axis) -> float:
    return axis.range[1] - axis.range[0] if axis.range else 1.0


def _axis(title: str, values: np.ndarray, limit: float | None) -> Axis:
    """An axis that reaches from the flights to their limit, however far that is."""
    ends = np.append(values[np.isfinite(values)], [] if limit is None else [limit])
    if not len(ends):
        return Axis(title)
    room = 0.1 * float(np.ptp(ends)) or 1.0
    return Axis(title, range=(float(ends.min()) - room, float(ends.max()) + room))


def _limit(axis: Literal["x", "y"], at: float | None) -> Iterator[Mark]:
    if at is not None:
        yield Mark(axis, at, colour=BAD, dash="dash")
