"""The page of a rare failure: probability, levels, region of the inputs, and worst cases."""

from __future__ import annotations

from collections.abc import Iterator

from edl6dof.campaign.rare import RareFailure
from edl6dof.campaign.statistics import percent
from edl6dof.config.wording import counted
from edl6dof.metrics.figures import figure_of_merit
from edl6dof.report.document import Block, Fact, Report, Row, Section, Table, Text, printed, significant

#: Inputs are shown from this difference on (nats), and at most so many.
_SHOWN_FROM, _MOST = 0.1, 8
#: Share of kept steps below which chains hardly move.
_STUCK = 0.05
_MEANING = """\
The probability is the mean over the populations, which have common levels and first flights of their own. \
Its interval contains the errors by the number of flights and by the correlation of the chains. It does not \
contain a mode of failure that no population has found: populations whose probabilities or regions differ \
widely show several modes, or too few flights in a level."""


def rare_report(found: RareFailure) -> Report:
    """Return the page of a subset simulation."""
    asked, one = found.request.requirement, found.estimate
    unit = printed(figure_of_merit(asked.figure).unit.label)
    violated = f"{asked.figure} {'>' if asked.sign > 0.0 else '<'} {significant(asked.limit)} {unit}".strip()
    headline = f"{found.request.plan.name}: probability of {violated}: {one.probability:.2g}"
    known = one.low is not None and one.high is not None
    inputs = "Region of the failures, in standard deviations of each input"
    interval = f"{one.low:.2g} .. {one.high:.2g}" if known else "none: no failure was found"
    return Report(
        title=f"{found.request.plan.name}: {asked.label}",
        headline=headline,
        mood="plain" if known else "warn",
        subtitle=f"requirement {asked.label}",
        facts=[
            Fact(f"{percent(asked.confidence)} interval", interval),
            Fact("flights", f"{found.flights:,}"),
            Fact("populations", f"{len(found.populations)} of {found.request.size}"),
        ],
        sections=[
            Section("levels", "Levels", [*_levels(found, unit)]),
            Section("region", inputs, [*_region(found)]),
            Section("worst", "Worst failures", [_worst(found)]),
            Section("meaning", "Meaning and conditions", list(map(Text, _notes(found)))),
        ],
    )


def _levels(found: RareFailure, unit: str) -> Iterator[Block]:
    """Yield the figure at each level, and the probability of every population."""
    asked, rows = found.request.requirement, list[Row]()
    for number, one in enumerate(found.levels, 1):
        figure = significant(asked.limit - asked.sign * one.below, 3)
        rows.append([str(number), figure, f"{one.share:.3f}", percent(round(one.kept, 2))])
    if rows:
        yield Table(["level>", f"{asked.figure}, {unit}>", "share>", "steps kept>"], rows)
    each = ", ".join(f"{one.probability:.2g}" for one in found.populations)
    yield Text(f"Probability by each population: {each}.")


def _region(found: RareFailure) -> Iterator[Block]:
    inputs = [item for item in found.regions.items() if item[1].difference > _SHOWN_FROM]
    rows: list[Row] = [
        [name, *(f"{value:+.2f}" for value in (one.mean, one.lowest, one.highest)), f"{one.spread:.2f}"]
        for name, one in inputs[:_MOST]
    ]
    if rows:
        yield Table(["input", "mean>", "lowest population>", "highest>", "spread>"], rows)
    others = len(found.regions) - len(rows)
    yield Text(f"{counted(others, 'other input')} of failures {'differs' if others == 1 else 'differ'} less.")


def _worst(found: RareFailure) -> Table:
    rows: list[Row] = [
        [str(one["case"]), significant(one["value"]).replace("nan", "not reached"), one["command"]]
        for one in found.worst
    ]
    return Table(["case>", f"{found.request.requirement.figure}>", "the flight again"], rows)


def _notes(found: RareFailure) -> Iterator[str]:
    yield _MEANING
    if short := found.without_figure:
        causes = "; ".join(f"{number}: {cause}" for cause, number in short.most_common(3))
        words = f"{sum(short.values())} of {len(found.failures)} failures ended before they reached the"
        yield f"{words} figure ({causes}). They count as failures, as the worst ones."
    least = min((level.kept for level in found.levels), default=1.0)
    if least < _STUCK:
        yield f"Only {percent(round(least, 3))} of the steps of a level were kept: use more flights (-n)."
