"""How the flights stand against their limits: quantiles, propellant, causes of failures, the worst cases."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from edl6dof.campaign.quantiles import SHARES, Quantile, bounded_shares, flights_needed, percent, quantile
from edl6dof.campaign.statistics import Proportion
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.campaign.results import Results
from edl6dof.report.document import Block, Cell, Mood, Row, Table, Text
from edl6dof.report.figure import BLUE, GREEN, Axis, Figure, Mark, Panel, Trace
from edl6dof.report.numbers import aligned, significant

#: Figures without a limit whose quantiles are of interest.
_OTHERS = (
    *("peak_load_g0", "peak_heat_flux_w_cm2", "max_riser_tension_n", "parachute_height_m"),
    *("backshell_height_m", "min_backshell_distance_m", "propellant_used_kg", "touchdown_s"),
)
#: Cases that are named beside each limit.
_NEAREST = 3
#: What stands beside a quantile.
BOUNDS = "Quantiles with their 95 % bounds, by order statistics."


def limits(results: Results) -> Iterator[Block]:
    """Median and outermost quantile of every figure that has a limit, beside it."""
    if not results.limits:
        return
    shares = shown_shares(len(results.cases))[-2:]
    rows: list[Row] = []
    for figure, label, limit, unit in results.limits:
        values = results[figure]
        missed = int(np.sum(values > limit))
        worst = next(filter(None, (quantile(values, share) for share in reversed(shares))), None)
        mood: Mood = "bad" if missed else "good"
        used = Cell(f"{worst.high / limit:.0%}", mood, worst.high / limit) if worst else "-"
        rows.append([label, unit, *_cells(values, shares), significant(limit), used, str(missed)])
    used_is = "Used is the upper bound of the last one over the limit."
    yield Text(f"{BOUNDS} {used_is} {refused(len(results.cases))}")
    yield Table(["figure", "unit", *_heads(shares), "limit>", "used>", "missed>"], rows)


def other_figures(results: Results) -> Iterator[Block]:
    """Quantiles of other figures."""
    shares = shown_shares(len(results.cases))
    rows: list[Row] = [
        [figure.meaning, figure.unit.label, *_cells(results[figure.name], shares)]
        for figure in map(figure_of_merit, _OTHERS)
        if results.has(figure.name) and figure.name not in {name for name, *_ in results.limits}
    ]
    if rows:
        yield Text(f"{BOUNDS} {refused(len(results.cases))}")
        yield Table(["figure", "unit", *_heads(shares)], rows)


def shown_shares(flights: int) -> tuple[float, ...]:
    """The median and the outermost pair of quantiles that a number of flights can bound."""
    bounded = bounded_shares(flights)
    return tuple(dict.fromkeys((bounded[0], 0.5, bounded[-1]))) if bounded else ()


def refused(flights: int) -> str:
    """Which quantiles a number of flights cannot bound, and how many it would take."""
    too_far = [share for share in SHARES if share > 0.5 and flights_needed(share) > flights]
    takes = " and ".join(f"{percent(share)} takes {flights_needed(share):,}" for share in too_far)
    return f"Quantiles further out cannot be told with {flights:,} flights: {takes}." if too_far else ""


def _heads(shares: Sequence[float]) -> list[str]:
    return [f"{percent(share)}>" for share in shares]


def _cells(values: np.ndarray, shares: Sequence[float]) -> list[str]:
    return [bounded(quantile(values, share), share) for share in shares]


def bounded(found: Quantile | None, share: float) -> str:
    """A quantile with its bounds in words, or how many flights it takes."""
    if found is None:
        return f"takes {flights_needed(share):,} flights"
    value, low, high = aligned(found.value, found.low, found.high)
    return f"{value} ({low} .. {high})"


def causes(results: Results) -> Block:
    """Why flights failed."""
    if not results.causes:
        low, _ = results.success.interval
        return Text(f"No flight failed. With 95 % confidence the success probability is above {low:.2%}.")
    rows: list[Row] = []
    for cause, number in results.causes:
        share = Proportion(number, len(results.cases))
        first = results.cases[[text == cause for text in results.table["cause"].to_pylist()]][:3]
        refly = ", ".join(str(case) for case in first)
        rows.append([cause, str(number), Cell(f"{share.value:.2%}", "bad", share.value), refly])
    return Table(["cause", "flights>", "share", "cases"], rows)


def convergence(results: Results) -> Figure:
    """Success probability so far, with its interval."""
    order = np.argsort(results.cases)
    successes = np.cumsum(results.ok[order])
    number = np.arange(1, len(successes) + 1)
    shown = np.unique(np.geomspace(1, len(number), 200).astype(int)) - 1
    found = [Proportion(int(successes[k]), int(number[k])) for k in shown]
    low, high = (np.array([100.0 * share.interval[end] for share in found]) for end in (0, 1))
    value = np.array([100.0 * share.value for share in found])
    x = number[shown].astype(float)
    around = np.append(x, x[::-1]), np.append(low, high[::-1])
    traces = [
        Trace(*around, "95 % interval (Wilson)", "region", BLUE),
        Trace(x, value, "success so far", colour=BLUE, width=2.2),
    ]
    flights = Axis("flights", range=(1.0, max(float(x[-1]), 2.0)), log=True)
    panel = Panel(flights, Axis("success (%)", range=(float(low.min()) - 4.0, 104.0)), traces)
    return Figure(
        "convergence",
        "Success probability",
        [panel],
        "It has converged when the interval is narrow enough for the question.",
    )


def propellant(results: Results) -> Iterator[Block]:
    """Propellant left."""
    loaded = sum(float(tank["mass_kg"]) for tank in results.document["vehicle"]["tanks"])
    if not results.has("propellant_used_kg") or not loaded:
        return
    left = loaded - results["propellant_used_kg"]
    left = left[np.isfinite(left)]
    if not len(left):
        return
    counts, edges = np.histogram(left, bins=min(40, max(8, len(left) // 12)))
    share = shown_shares(len(left))[0] if shown_shares(len(left)) else 0.5
    low = quantile(left, share)
    panel = Panel(
        Axis("propellant left (kg)"),
        Axis("flights"),
        [Trace((edges[1:] + edges[:-1]) / 2.0, counts.astype(float), "flights", "bars", GREEN)],
        marks=[Mark("x", low.value, percent(share))] if low else [],
    )
    told = f", {percent(share)} quantile {bounded(low, share)} kg" if low else ""
    caption = f"Of {loaded:g} kg loaded; least {left.min():.1f} kg{told}. {refused(len(left))}"
    yield Figure("propellant", "Propellant margin", [panel], caption)


def worst(results: Results) -> Iterator[Block]:
    """The cases nearest to each limit, or furthest beyond it, and the command that flies one again."""
    rows: list[Row] = []
    for figure, label, limit, unit in results.limits:
        values = results[figure]
        finite = np.flatnonzero(np.isfinite(values))
        nearest = finite[np.argsort(-values[finite], kind="stable")][:_NEAREST]
        if len(nearest):
            share = float(values[nearest[0]]) / limit
            shown = Cell(significant(values[nearest[0]]), "bad" if share > 1.0 else "plain", share)
            cases = ", ".join(str(results.cases[index]) for index in nearest)
            rows.append([label, unit, shown, significant(limit), cases])
    if rows:
        yield Text(f"The worst of each first; one of them again: edl6dof refly {results.folder} CASE")
        yield Table(["figure", "unit", "worst>", "limit>", "cases"], rows)
