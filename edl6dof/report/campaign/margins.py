"""Margins of a campaign: quantiles and limits, propellant, faults, causes of failure, and the worst cases."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.campaign.statistics import SHARES, Proportion, bounded_shares, flights_needed, percent, quantile
from edl6dof.metrics.figures import FigureOfMerit, figure_of_merit
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.document import Block, Cell, Row, Table, Text, aligned, in_percent, printed, significant
from edl6dof.report.figure import Axis, Figure, Mark, Panel, Trace
from edl6dof.report.palette import BLUE, GREEN

#: Figures without a limit whose quantiles are of interest.
_OTHERS = (
    *("peak_load_g0", "peak_heat_flux_w_cm2", "max_riser_tension_n", "parachute_height_m"),
    *("backshell_height_m", "min_backshell_distance_m", "propellant_used_kg", "touchdown_s"),
)
#: Number of cases listed for each limit.
_NEAREST = 3
#: Figures that count events that must not happen, each with the words for a flight without such an event.
_COUNTS = {
    "missed_isolations": "every failed thruster isolated",
    "false_alarms": "no healthy thruster isolated, and none for a wrong kind of fault",
    "instrument_false_alarms": "no healthy instrument excluded",
}
_TIMES = ("time_to_detect_s", "time_to_exclude_s")


def limits(results: Results) -> Iterator[Block]:
    """Tabulate the median and the outermost quantile of every figure that has a limit."""
    if not results.limits:
        return
    shares = shown_shares(results)[-2:]
    rows: list[Row] = []
    for figure, limit in results.limits:
        values = results[figure.name]
        missed = int(np.sum(figure.violates(values, limit)))
        worst = _bound(results, figure, values, shares)
        share = None if worst is None else figure.used(worst, limit)
        used = "-" if share is None else Cell(in_percent(share), "bad" if missed else "good", share)
        cells = [in_words(results, values, figure.toward_limit(share)) for share in shares]
        label, unit = figure.meaning, printed(figure.unit.label)
        rows.append([label, unit, *cells, allowed(figure, limit), used, str(missed)])
    end = "outer bound of the last quantile" if results.is_sample else "worst value"
    yield Text(f"{note(results)} Used is the {end} over the limit.")
    heads = [f"{head(share)}>" for share in shares]
    yield Table(["figure", "unit", *heads, "limit>", "used>", "missed>"], rows)


def allowed(figure: FigureOfMerit, limit: float) -> str:
    """Return a limit as text."""
    return f"at least {significant(limit)}" if figure.clearance else significant(limit)


def _bound(
    results: Results, figure: FigureOfMerit, values: np.ndarray, shares: Sequence[float]
) -> float | None:
    """Bound toward the limit of the outermost quantile that has one; without a sample the worst value."""
    if not results.is_sample:
        worst = np.nanmin if figure.clearance else np.nanmax
        return float(worst(values)) if np.isfinite(values).any() else None
    found = (quantile(values, figure.toward_limit(share)) for share in reversed(shares))
    return next((one.low if figure.clearance else one.high for one in found if one is not None), None)


def other_figures(results: Results) -> Iterator[Block]:
    """Tabulate quantiles of figures without a limit."""
    limited = {figure.name for figure, _ in results.limits}
    table = _quantiles(results, "figure", (name for name in _OTHERS if name not in limited))
    if table.rows:
        yield from (Text(note(results)), table)


def _quantiles(results: Results, heading: str, names: Iterable[str]) -> Table:
    """Tabulate quantiles of those of the named figures that the campaign has."""
    shares = shown_shares(results)
    rows: list[Row] = [
        [figure.meaning, printed(figure.unit.label), *(in_words(results, results[name], s) for s in shares)]
        for name in names
        if results.has(name) and (figure := figure_of_merit(name))
    ]
    return Table([heading, "unit", *(f"{head(share)}>" for share in shares)], rows)


def injected(results: Results) -> list[str]:
    """Return the faults of every flight in words: ``D7 stuck off at lift + 2 s``."""
    return [_in_words(fault) for fault in _of_every_flight(results)]


def isolation(results: Results) -> Iterator[Block]:
    """Tabulate in how many flights the faults were isolated, and how fast; nothing without faults."""
    if not _of_every_flight(results):
        return
    shares: list[Row] = []
    for name, meaning in _COUNTS.items():
        if results.has(name):
            counts = results[name]
            known = counts[np.isfinite(counts)]
            share = Proportion(int(np.sum(known == 0)), len(known))
            shares.append([meaning, f"{share.successes} of {share.trials}", str(share)])
    times = _quantiles(results, "", _TIMES)
    if shares:
        yield Table(["", "flights>", "share, 95 % interval>"], shares)
    if times.rows:
        yield times


def _of_every_flight(results: Results) -> Sequence[Mapping[str, Any]]:
    """Faults that the scenario gives to every flight; empty for a fault matrix, where they differ by cell."""
    return () if results.has_faults else results.document.get("faults") or ()


def _in_words(fault: Mapping[str, Any]) -> str:
    named = [value for key, value in fault.items() if isinstance(value, str) and key != "kind"]
    what, begins = " ".join([*named, fault["kind"].replace("_", " ")]), fault["at"]
    if begins.get("phase") is None:
        return f"{what} at {begins['time_s']:g} s"
    after = f" + {begins['plus_s']:g} s" if begins.get("plus_s") else ""
    return f"{what} at {begins['phase'].replace('_', ' ')}{after}"


def shown_shares(results: Results) -> tuple[float, ...]:
    """Return the shares of the columns: median and outermost quantiles that the sample can bound; without a
    sample least value (0), median and largest value (1).
    """
    if not results.is_sample:
        return 0.0, 0.5, 1.0
    bounded = bounded_shares(len(results.cases))
    return tuple(dict.fromkeys((bounded[0], 0.5, bounded[-1]))) if bounded else ()


def head(share: float) -> str:
    """Return the heading of a quantile."""
    return {0.0: "least", 1.0: "largest"}.get(share, percent(share))


def in_words(results: Results, values: np.ndarray, share: float) -> str:
    """Return a quantile as text, with its bounds if the flights are a sample, or the flights it needs."""
    if not results.is_sample:
        finite = values[np.isfinite(values)]
        return significant(float(np.quantile(finite, share))) if len(finite) else "-"
    found = quantile(values, share)
    if found is None:
        return f"needs {flights_needed(share):,} flights"
    value, low, high = aligned(found.value, found.low, found.high)
    return f"{value} ({low} .. {high})"


def note(results: Results) -> str:
    """Explain the bounds of the quantiles, and which ones need more flights."""
    if not results.is_sample:
        return "As flown: a grid of flights is no random sample, and its quantiles have no bounds."
    flights = len(results.cases)
    too_far = [share for share in SHARES if share >= 0.5 and flights_needed(share) > flights]
    words = "Quantiles with their 95 % bounds, by order statistics."
    if any(figure.clearance for figure, _ in results.limits):
        words += " Where a limit is a least value, its share of the flights exceeds the quantile."
    if too_far:
        needs = ", ".join(f"{percent(share)} needs {flights_needed(share):,}" for share in too_far)
        words += f" Quantiles further out need more than {flights:,} flights: {needs}."
    return words


def causes(results: Results) -> Block:
    """Tabulate the causes of failures."""
    if not results.causes:
        if not results.is_sample:
            return Text("No flight failed.")
        low = in_percent(results.success.interval[0], 2)
        return Text(f"No flight failed. With 95 % confidence the success probability is above {low}.")
    rows: list[Row] = []
    texts = np.array(results.table["cause"].to_pylist(), object)
    for cause, number in results.causes:
        share = number / len(results.cases)
        refly = ", ".join(map(str, results.cases[texts == cause][:3]))
        rows.append([cause, str(number), Cell(in_percent(share, 2), "bad", share), refly])
    return Table(["cause", "flights>", "share", "cases"], rows)


def convergence(results: Results) -> Iterator[Figure]:
    """Draw the success probability after each flight, with its interval."""
    if not results.is_sample:
        return
    order = np.argsort(results.cases)
    successes = np.cumsum(results.ok[order])
    number = np.arange(1, len(successes) + 1)
    shown = np.unique(np.geomspace(1, len(number), 200).astype(int)) - 1
    found = [Proportion(int(successes[k]), int(number[k])) for k in shown]
    low, high = 100.0 * np.array([share.interval for share in found]).T
    x, value = number[shown].astype(float), 100.0 * np.array([share.value for share in found])
    around = np.append(x, x[::-1]), np.append(low, high[::-1])
    interval = Trace(*around, "95 % interval (Wilson)", "region", BLUE)
    traces = [interval, Trace(x, value, "success so far", colour=BLUE, width=2.2)]
    flights = Axis("flights", range=(1.0, max(float(x[-1]), 2.0)), log=True)
    panel = Panel(flights, Axis("success (%)", range=(float(low.min()) - 4.0, 104.0)), traces)
    caption = "It has converged when the interval is narrow enough for the question."
    yield Figure("convergence", "Success probability", [panel], caption)


def propellant(results: Results) -> Iterator[Block]:
    """Draw a histogram of the propellant left."""
    loaded = sum(float(tank["mass_kg"]) for tank in results.document["vehicle"]["tanks"])
    if not results.has("propellant_used_kg") or not loaded:
        return
    left = loaded - results["propellant_used_kg"]
    left = left[np.isfinite(left)]
    if not len(left) or np.ptp(left) == 0.0:
        return
    counts, edges = np.histogram(left, bins=min(40, max(8, len(left) // 12)))
    bars = Trace((edges[1:] + edges[:-1]) / 2.0, counts.astype(float), "flights", "bars", GREEN)
    caption, marks = f"Of {loaded:g} kg loaded; least {left.min():.1f} kg", list[Mark]()
    for share in shown_shares(results)[:1]:
        marks.append(Mark("x", float(np.quantile(left, share)), head(share)))
        caption += f", {head(share)} quantile {in_words(results, left, share)} kg" if share > 0.0 else ""
    panel = Panel(Axis("propellant left (kg)"), Axis("flights"), [bars], marks=marks)
    caption += "."
    yield Figure("propellant", "Propellant margin", [panel], caption)


def worst(results: Results) -> Iterator[Block]:
    """Tabulate the cases nearest to each limit or beyond it, and the command that flies one again."""
    rows: list[Row] = []
    for figure, limit in results.limits:
        values, nearest = results[figure.name], results.nearest(figure, _NEAREST)
        if len(nearest):
            share = figure.used(float(values[nearest[0]]), limit)
            label, unit = figure.meaning, figure.unit.label
            shown = Cell(significant(values[nearest[0]]), "bad" if share > 1.0 else "plain", share)
            cases = ", ".join(str(results.cases[index]) for index in nearest)
            rows.append([label, printed(unit), shown, allowed(figure, limit), cases])
    if rows:
        yield Text(f"The worst of each first; one of them again: edl6dof refly {results.folder} CASE")
        yield Table(["figure", "unit", "worst>", "limit>", "cases"], rows)
