"""Where the flights came down and where their parachutes opened."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from edl6dof.campaign.quantiles import percent, quantile
from edl6dof.campaign.statistics import ellipse
from edl6dof.report.campaign.margins import BOUNDS, bounded, refused, shown_shares
from edl6dof.report.campaign.results import Results
from edl6dof.report.document import Block, Row, Table
from edl6dof.report.figure import BAD, BLACK, BLUE, PURPLE, VERMILION, Axis, Dash, Figure, Mark, Panel, Trace

#: Points of each kind that carry the number of their case.
_NAMED = 4

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
    traces = list(_points(results, east, north))
    for sigmas, dash in _DASHES.items():
        x, y = ellipse(east[down], north[down], sigmas)
        traces.append(Trace(x, y, f"{sigmas} sigma", colour=BLACK, dash=dash))
    traces.append(Trace(np.zeros(1), np.zeros(1), "target", "points", VERMILION, symbol="cross", width=3.0))
    panel = Panel(
        Axis("east of the landing site (km)"), Axis("north of the landing site (km)"), traces, equal=True
    )
    caption = "A normal cloud has 39, 86 and 99 % of its points inside the ellipses."
    return Figure("footprint", "Landing footprint", [panel], caption, height=560)


def _points(results: Results, x: np.ndarray, y: np.ndarray) -> Iterator[Trace]:
    """Successes and failures; failures and the outermost successes carry the number of their case."""
    both = np.isfinite(x) & np.isfinite(y)
    middle = [np.median(values[both]) if both.any() else 0.0 for values in (x, y)]
    scale = [max(float(np.std(values[both])), 1e-12) if both.any() else 1.0 for values in (x, y)]
    out = np.hypot((x - middle[0]) / scale[0], (y - middle[1]) / scale[1])
    for chosen, name, colour in ((results.ok, "success", BLUE), (~results.ok, "no success", BAD)):
        shown = np.flatnonzero(chosen & both)
        if len(shown):
            named = set(shown[np.argsort(-out[shown])][:_NAMED])
            labels = [f"case {results.cases[index]}" if index in named else "" for index in shown]
            yield Trace(x[shown], y[shown], name, "points", colour, labels=labels)


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
            (f"distance from the target: {percent(share)}", bounded(quantile(distance, share), share), "km")
            for share in shown_shares(len(distance))
            if share >= 0.5
        ),
        ("distance from the target: largest", f"{distance.max():.2f}", "km"),
    ]
    caption = f"{BOUNDS} {refused(len(distance))}"
    return Table(["", "value>", "unit"], rows, caption)


def deployment(results: Results) -> Figure:
    """Mach number, dynamic pressure, height and angle of attack at mortar fire, with the limits."""
    limits = {figure: limit for figure, _, limit, _ in results.limits}
    mach, pressure = results["parachute_mach"], results["parachute_dynamic_pressure_pa"]
    marks = [Mark("x", limits["parachute_mach"], "limit", BAD)] if "parachute_mach" in limits else []
    marks += (
        [Mark("y", limits["parachute_dynamic_pressure_pa"], "limit", BAD)]
        if "parachute_dynamic_pressure_pa" in limits
        else []
    )
    box = Panel(
        Axis("Mach number"),
        Axis("dynamic pressure (Pa)"),
        list(_points(results, mach, pressure)),
        marks=marks,
    )
    height, alpha = results["parachute_height_m"] / 1e3, results["parachute_total_alpha_deg"]
    low = np.isfinite(height) & (height <= np.nanquantile(height, 0.01))
    lowest = Trace(height[low], alpha[low], "lowest 1 %", "points", PURPLE, symbol="cross")
    marks = (
        [Mark("y", limits["parachute_total_alpha_deg"], "limit", BAD)]
        if "parachute_total_alpha_deg" in limits
        else []
    )
    attitude = Panel(
        Axis("height above the ground (km)"),
        Axis("total angle of attack (deg)"),
        [*_points(results, height, alpha), lowest],
        marks=marks,
    )
    return Figure(
        "deployment", "Parachute deployment", [box, attitude], "At mortar fire.", columns=2, height=380
    )
