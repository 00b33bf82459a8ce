"""The report of a campaign, put together from its parts."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from edl6dof.campaign.statistics import percent, quantile
from edl6dof.report.campaign import drivers, grid, isolation, landing, margins
from edl6dof.report.campaign.results import Results
from edl6dof.report.document import Block, Fact, Listing, Mood, Report, Section
from edl6dof.report.numbers import in_percent


def campaign_report(folder: Path) -> Report:
    """The report of a campaign, finished or not; a section about what it does not have is left out."""
    results = Results(folder)
    sections = [
        Section("faults", "Faults", list(_faults(results))),
        Section("success", "Success and causes", [margins.causes(results), *margins.convergence(results)]),
        Section("sweep", "Sweep", list(grid.figures(results))),
        Section("isolation", "Fault isolation", list(isolation.blocks(results))),
        Section("limits", "Limits", list(margins.limits(results))),
        Section("figures", "Other figures", list(margins.other_figures(results))),
        Section("footprint", "Footprint and deployment", list(landing.blocks(results))),
        Section("propellant", "Propellant", list(margins.propellant(results))),
        Section("worst", "Worst cases", list(margins.worst(results))),
        Section("drivers", "What drives what", [*drivers.indices(results), *drivers.blocks(results)]),
        Section(
            "configuration",
            "Configuration",
            [Listing("campaign.yaml", results.store.plan_text, "every default written out")],
        ),
    ]
    identity = results.store.info.identity
    about = [str(results.document.get("description") or ""), *isolation.injected(results)]
    words, mood = _headline(results)
    return Report(
        title=results.name,
        subtitle="; ".join(filter(None, about)),
        headline=words,
        mood=mood,
        facts=_facts(results),
        sections=[section for section in sections if section.blocks],
        footer=(
            f"edl6dof {identity.versions['edl6dof']}; source SHA-256 {identity.sources}; interval: Wilson, "
            "95 %"
        ),
    )


def _faults(results: Results) -> Iterator[Block]:
    """What the flights of a fault matrix tell; nothing where there is none."""
    if results.has_faults:
        from edl6dof.report.campaign import faults  # here: no other campaign needs its kinds of fault

        yield from faults.blocks(results)


def _headline(results: Results) -> tuple[str, Mood]:
    if results.has_faults:
        from edl6dof.report.campaign import faults

        return faults.headline(results)
    success = results.success
    share = f": {success}" if results.is_sample else ""
    return f"{success.successes} of {success.trials} flights succeed{share}", _mood(results)


def _mood(results: Results) -> Mood:
    if results.success.value >= 0.99:
        return "good"
    return "warn" if results.success.value >= 0.9 else "bad"


def _facts(results: Results) -> list[Fact]:
    facts = [
        Fact("flights", f"{len(results.cases):,}"),
        Fact("success", in_percent(results.success.value, 2), _mood(results)),
    ]
    if not results.is_sample:
        return facts
    low, high = results.success.interval
    facts.append(Fact("95 % interval", f"{100.0 * low:.2f} .. {in_percent(high, 2)}"))
    if results.has("landing_distance_m"):
        distance = results["landing_distance_m"] / 1e3
        facts += [
            Fact(f"{percent(share)} land within", f"{margins.in_words(results, distance, share)} km")
            for share in margins.shown_shares(results)[-1:]
            if quantile(distance, share)
        ]
    return facts
