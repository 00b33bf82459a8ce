"""How the flights stand against their limits: quantiles, propellant, causes of failures, the worst cases."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from edl6dof.campaign.quantiles import SHARES, Quantile, bounded_shares, flights_needed, percent, quantile
from edl6dof.campaign.statistics import Proportion
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.campaign.results import Results
from edl6dof.report.document import Block, Cell, Mood, Row, Table, Text
from edl6dof.report.figure import BLUE, GREEN, GREY, Axis, Figure, Mark, Panel, Trace
from edl6dof.report.numbers import aligned, significant

#: Figures without a limit whose quantiles are of interest.
_OTHERS = (
    *("peak_load_g0", "peak_heat_flux_w_cm2", "max_riser_tension_n", "parachute_height_m"),
    *("backshell_height_m", "min_backshell_distance_m", "propellant_used_kg", "touchdown_s"),
)
#: What stands in brackets.
BOUNDS = "In brackets the 95 % bounds of each quantile, by order statistics."


def limit_quantiles(results: Results) -> Table:
    """Quantiles of every figure that has a limit, beside it."""
    shares = shown_shares(len(results.cases))
    rows: list[Row] = []
    for figure, label, limit, unit in results.limits:
        values = results[figure]
        missed = int(np.sum(values > limit))
        worst = next(filter(None, (quantile(values, share) for share in reversed(shares))), None)
        mood: Mood = "bad" if missed else "good"
        used = Cell(f"{worst.high / limit:.0%}", mood, worst.high / limit) if worst else "-"
        rows.append([label, unit, *_cells(values, shares), significant(limit), used, str(missed)])
    caption = (
        f"{BOUNDS} Used is the upper bound of the last quantile over the limit. {refused(len(results.cases))}"
    )
    return Table(["figure", "unit", *_heads(shares), "limit>", "used", "missed>"], rows, caption)


def other_quantiles(results: Results) -> Table:
    """Quantiles of other figures."""
    shares = shown_shares(len(results.cases))
    rows: list[Row] = [
        [figure.meaning, figure.unit.label, *_cells(results[figure.name], shares)]
        for figure in map(figure_of_merit, _OTHERS)
        if results.has(figure.name) and figure.name not in {name for name, *_ in results.limits}
    ]
    caption = f"{BOUNDS} {refused(len(results.cases))}"
    return Table(["figure", "unit", *_heads(shares)], rows, caption)


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
    traces = [
        Trace(x, low, "95 % interval (Wilson)", colour=GREY, dash="dash"),
        Trace(x, high, "95 % interval (Wilson)", colour=GREY, dash="dash", legend=False),
        Trace(x, value, "success so far", colour=BLUE, width=2.2),
    ]
    panel = Panel(Axis("flights", log=True), Axis("success (%)"), traces)
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
        Axis("flights", range=(0.0, 1.1 * float(counts.max()))),
        [Trace((edges[1:] + edges[:-1]) / 2.0, counts.astype(float), "flights", "bars", GREEN)],
        marks=[Mark("x", low.value, percent(share))] if low else [],
    )
    told = f", {percent(share)} quantile {bounded(low, share)} kg" if low else ""
    caption = f"Of {loaded:g} kg loaded; least {left.min():.1f} kg{told}. {refused(len(left))}"
    yield Figure("propellant", "Propellant margin", [panel], caption)


def worst(results: Results, count: int = 3) -> Table:
    """The cases nearest to each limit, or furthest beyond it, with the command that flies them again."""
    rows: list[Row] = []
    for figure, label, limit, unit in results.limits:
        values = results[figure]
        finite = np.flatnonzero(np.isfinite(values))
        for index in finite[np.argsort(-values[finite])][:count]:
            share = values[index] / limit
            case = int(results.cases[index])
            shown = Cell(significant(values[index]), "bad" if share > 1.0 else "plain", float(share))
            rows.append([label, unit, shown, significant(limit), f"edl6dof refly {results.folder} {case}"])
    return Table(["figure", "unit", "value", "limit>", "fly it again"], rows)
