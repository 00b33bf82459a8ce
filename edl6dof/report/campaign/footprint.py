"""Landing points and parachute deployments of a campaign, and the ellipses that covariance predicts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from edl6dof.campaign.statistics import contour, ellipse, percent
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.campaign.margins import in_words, shown_shares
from edl6dof.report.document import Block, Row, Table
from edl6dof.report.figure import Axis, Dash, Figure, Mark, Panel, Trace
from edl6dof.report.palette import BAD, BLACK, BLUE, PURPLE, VERMILION

if TYPE_CHECKING:
    from edl6dof.campaign.covariance_estimate import Covariance

#: Most points of each kind that are labelled with the number of their case; width and height of a label with
#: a little room, as shares of the axes.
_NAMED, _WORD = 4, (0.2, 0.16)
#: Number of flights marked because they are lowest at mortar fire.
_LOWEST = 3


def blocks(results: Results) -> Iterator[Block]:
    """Show the footprint with its ellipses, and the box of parachute deployment."""
    if results.has("landing_east_m") and np.isfinite(results["landing_east_m"]).sum() > 2:
        yield footprint(results)
        yield ellipse_table(results)
    if results.has("parachute_mach"):
        yield deployment(results)


def footprint(results: Results) -> Figure:
    """Draw landing points about the site, with the ellipses of one to three standard deviations."""
    east, north = results["landing_east_m"] / 1e3, results["landing_north_m"] / 1e3
    down = np.isfinite(east)
    wide = float(np.ptp(north[down])) or 1.0
    traces = list(_points(results, east, north, (wide, wide)))
    traces += _ellipses(lambda sigmas: ellipse(east[down], north[down], sigmas))
    traces.append(Trace(np.zeros(1), np.zeros(1), "target", "points", VERMILION, symbol="cross", width=3.0))
    across, up = (Axis(f"{way} of the landing site (km)") for way in ("east", "north"))
    caption = "A normal cloud has 39, 86 and 99 % of its points inside the ellipses."
    panel = Panel(across, up, traces, equal=True)
    return Figure("footprint", "Landing footprint", [panel], caption, height=560)


def ellipse_figure(title: str, found: Covariance, sampled: np.ndarray | None) -> Figure:
    """Draw the ellipses of the first two figures of an event, which are its position if it has one.
    ``sampled``: figures of a campaign's flights, shape (flights, figures), drawn as points if given.
    """
    mean, covariance = found.spread.mean[:2], found.pairs.covariance[:2, :2]
    traces = list(_ellipses(lambda sigmas: contour(covariance, sigmas) + mean[:, None]))
    if sampled is not None:
        x, y = sampled[:, :2].T
        traces.insert(0, Trace(x, y, "flights of the campaign", "points", BLUE, width=1.0))
    figures = map(figure_of_merit, found.event.all[:2])
    across, up = (Axis(f"{figure.meaning} ({figure.unit.label or '1'})") for figure in figures)
    panel = Panel(across, up, traces, equal=bool(found.event.position))
    return Figure("covariance", title, [panel], height=480)


def _ellipses(outline: Callable[[int], Sequence[np.ndarray]]) -> Iterator[Trace]:
    dashes: tuple[Dash, ...] = ("solid", "dash", "dot")
    for sigmas, dash in enumerate(dashes, 1):
        x, y = outline(sigmas)
        yield Trace(x, y, f"{sigmas} sigma", colour=BLACK, dash=dash)


def _points(results: Results, x: np.ndarray, y: np.ndarray, spans: tuple[float, float]) -> Iterator[Trace]:
    """Points of successes and of failures; the outermost carry their case number where there is room."""
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
    """Return the first few indices of ``order`` whose labels do not overlap that of an earlier one; ``x`` and
    ``y``: places of all points, as shares of the axes.
    """
    taken: list[int] = []
    for index in order[: 4 * _NAMED]:
        near = [abs(x[index] - x[k]) < _WORD[0] and abs(y[index] - y[k]) < _WORD[1] for k in taken]
        if not any(near) and len(taken) < _NAMED:
            taken.append(int(index))
    return set(taken)


def ellipse_table(results: Results) -> Table:
    """Tabulate size and direction of the footprint."""
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
    ]
    away = "distance from the target"
    for share in (share for share in shown_shares(results) if 0.5 <= share < 1.0):
        rows.append((f"{away}: {percent(share)}", in_words(results, distance, share), "km"))
    rows.append((f"{away}: largest", f"{distance.max():.2f}", "km"))
    return Table(["", "value>", "unit"], rows)


def deployment(results: Results) -> Figure:
    """Draw Mach number, dynamic pressure, height and angle of attack at mortar fire, with the limits."""
    mach = ("parachute_mach", "Mach number (1)", 1.0)
    box = _scatter(results, mach, ("parachute_dynamic_pressure_pa", "dynamic pressure (Pa)", 1.0))
    above = ("parachute_height_m", "height above the ground below (km)", 1e3)
    attitude = _scatter(results, above, ("parachute_total_alpha_deg", "total angle of attack (deg)", 1.0))
    height, alpha = results["parachute_height_m"] / 1e3, results["parachute_total_alpha_deg"]
    low = np.argsort(height)[:_LOWEST]
    lowest = Trace(height[low], alpha[low], f"lowest {_LOWEST}", "points", PURPLE, symbol="cross")
    panels = [box, replace(attitude, traces=[*attitude.traces, lowest])]
    caption = "At mortar fire; dashed: the limits."
    return Figure("deployment", "Parachute deployment", panels, caption, height=340)


def _scatter(results: Results, across: tuple[str, str, float], up: tuple[str, str, float]) -> Panel:
    """Draw flights in the plane of two figures (name, title, size of unit); the axes include the limits."""
    limits = {figure.name: limit for figure, limit in results.limits}
    ways: tuple[Literal["x", "y"], ...] = ("x", "y")
    values, axes, spans, marks = [], [], [], []
    for way, (name, title, unit) in zip(ways, (across, up), strict=True):
        own = results[name] / unit
        limit = [limits[name] / unit] if name in limits else []
        ends = np.append(own[np.isfinite(own)], limit)
        room = (0.1 * float(np.ptp(ends)) or 1.0) if len(ends) else 0.0
        span = (float(ends.min()) - room, float(ends.max()) + room) if len(ends) else None
        values.append(own)
        axes.append(Axis(title, span))
        spans.append(span[1] - span[0] if span else 1.0)
        marks += [Mark(way, at, colour=BAD, dash="dash") for at in limit]
    points = _points(results, values[0], values[1], (spans[0], spans[1]))
    return Panel(axes[0], axes[1], list(points), marks=marks)
