"""The report of a campaign, assembled from its sections; and a sweep as maps over its grid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from edl6dof.campaign.statistics import percent, quantile
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.campaign import drivers, footprint, margins
from edl6dof.report.campaign.campaign_results import Results
from edl6dof.report.document import Block, Fact, Listing, Mood, Report, Section, in_percent, printed
from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace

#: Figures mapped over the grid in addition to success.
_FIGURES = (
    *("landing_distance_m", "parachute_mach", "parachute_height_m"),
    *("touchdown_vertical_m_s", "propellant_used_kg", "peak_load_g0"),
)


def campaign_report(folder: Path) -> Report:
    """Return the report of a campaign, finished or not, without sections that would be empty."""
    results = Results(folder)
    about = [str(results.document.get("description") or ""), *margins.injected(results)]
    matrix: list[Block] = []
    share = f": {results.success}" if results.is_sample else ""
    words = f"{results.success.successes} of {results.success.trials} flights succeed{share}"
    mood = _mood(results)
    if results.has_faults:
        from edl6dof.report.campaign import faults  # needed for a matrix only: it loads the simulator

        matrix, (words, mood) = list(faults.blocks(results)), faults.headline(results)
    plan = Listing("campaign.yaml", results.store.plan_text, "every default written out")
    sections = [
        Section("faults", "Faults", matrix),
        Section("success", "Success and causes", [margins.causes(results), *margins.convergence(results)]),
        Section("sweep", "Sweep", list(sweep_maps(results))),
        Section("isolation", "Fault isolation", list(margins.isolation(results))),
        Section("limits", "Limits", list(margins.limits(results))),
        Section("figures", "Other figures", list(margins.other_figures(results))),
        Section("footprint", "Footprint and deployment", list(footprint.blocks(results))),
        Section("propellant", "Propellant", list(margins.propellant(results))),
        Section("worst", "Worst cases", list(margins.worst(results))),
        Section("drivers", "What drives what", [*drivers.indices(results), *drivers.blocks(results)]),
        Section("configuration", "Configuration", [plan]),
    ]
    versions, sources = results.store.info.identity.versions, results.store.info.identity.sources
    return Report(
        title=results.name,
        subtitle="; ".join(filter(None, about)),
        headline=words,
        mood=mood,
        facts=_facts(results),
        sections=[section for section in sections if section.blocks],
        footer=f"edl6dof {versions['edl6dof']}; source SHA-256 {sources}; interval: Wilson, 95 %",
    )


def _mood(results: Results) -> Mood:
    if results.success.value >= 0.99:
        return "good"
    return "warn" if results.success.value >= 0.9 else "bad"


def _facts(results: Results) -> list[Fact]:
    share, mood = in_percent(results.success.value, 2), _mood(results)
    facts = [Fact("flights", f"{len(results.cases):,}"), Fact("success", share, mood)]
    if not results.is_sample:
        return facts
    low, high = results.success.interval
    facts.append(Fact("95 % interval", f"{100.0 * low:.2f} .. {in_percent(high, 2)}"))
    if results.has("landing_distance_m"):
        distance = results["landing_distance_m"] / 1e3
        for most in margins.shown_shares(results)[-1:]:
            if quantile(distance, most):
                within = margins.in_words(results, distance, most)
                facts.append(Fact(f"{percent(most)} land within", f"{within} km"))
    return facts


def sweep_maps(results: Results) -> Iterator[Figure]:
    """Draw maps over the first two axes of a sweep (means over the rest), or curves over its only axis."""
    sweep = results.document.get("sweep") or {"axes": []}
    places = [("truth." if axis.get("of") == "truth" else "belief.") + axis["path"] for axis in sweep["axes"]]
    axes = [place for place in places if results.has(place)]
    columns = {"success (%)": 100.0 * results.ok}
    for figure in (figure_of_merit(name) for name in _FIGURES if results.has(name)):
        unit = f" ({printed(figure.unit.label)})" if figure.unit.label else ""
        columns[figure.meaning + unit] = results[figure.name]
    if not axes:
        return
    panels = _maps(results, axes, columns) if len(axes) > 1 else _curves(results, axes[0], columns)
    caption = "Mean over the flights at each point."
    yield Figure("sweep", "Sweep", list(panels), caption, columns=1 if len(axes) > 1 else 2, height=260)


def _maps(results: Results, axes: Sequence[str], columns: Mapping[str, np.ndarray]) -> Iterator[Panel]:
    x, y = (results[name] for name in axes[:2])
    across, up = np.unique(x), np.unique(y)
    for label, values in columns.items():
        mean = np.array([[_mean(values[(x == a) & (y == b)]) for a in across] for b in up])
        finite = mean[np.isfinite(mean)]
        success = label.startswith("success")
        if success or len(finite) and np.ptp(finite) > 0.0:  # else the same at every point
            low, high = (0.0, 100.0) if success else (float(finite.min()), float(finite.max()))
            heat = Heat(across, up, mean, label, low, high)
            yield Panel(Axis(_short(axes[0])), Axis(_short(axes[1])), heat=heat)


def _curves(results: Results, axis: str, columns: Mapping[str, np.ndarray]) -> Iterator[Panel]:
    x = results[axis]
    points = np.unique(x)
    for label, values in columns.items():
        means = np.array([_mean(values[x == point]) for point in points])
        yield Panel(Axis(_short(axis)), Axis(label), [Trace(points, means, label, legend=False)])


def _mean(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else float("nan")


def _short(path: str) -> str:
    return path.split(".", 1)[1]
