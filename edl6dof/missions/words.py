"""Words of the table of missions: the same on the terminal, on the page and in files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import floor, isfinite, isinf, log10
from typing import get_args

from edl6dof.config.base import STATUS_MARKS
from edl6dof.config.wording import counted
from edl6dof.metrics.published import Evidence
from edl6dof.missions.comparison import GOAL, WITHIN, Compared, Predicted, inside
from edl6dof.report.numbers import significant

HEADS = ("figure", "predicted>", "flown>", "planned>", "", "sigma>", "")
_LETTERS = {status: letter for letter, status in STATUS_MARKS.items()}
#: What stands in the last column: not predicted; no prediction, as the scenario was calibrated on it.
OUTSIDE, FITTED = "outside", "fitted"


def cells(one: Predicted) -> tuple[str, ...]:
    """A row of the table under :data:`HEADS`."""
    return (
        one.figure.meaning + (f" ({one.figure.unit.label})" if one.figure.unit.label else ""),
        predicted(one),
        "" if one.published.planned else published(one),
        published(one) if one.published.planned else "",
        f"[{_LETTERS[one.status]}]" if one.status in _LETTERS else "",
        sigmas(one),
        remark(one),
    )


def predicted(one: Predicted) -> str:
    """Mean and spread, with as many decimals as the spread has two digits."""
    if not one.flights:
        return "not reached"
    if not one.deviation > 0.0:
        return f"{significant(one.mean)} +- 0"
    places = max(1 - floor(log10(one.deviation)), 0)
    return f"{one.mean:.{places}f} +- {one.deviation:.{places}f}"


def published(one: Predicted) -> str:
    """The published value with what it is known to."""
    known = "" if one.published.sigma is None else f" +- {one.published.sigma:g}"
    return f"{one.published.bound} {one.published.number:.10g}{known}".strip()


def sigmas(one: Predicted) -> str:
    """The difference in standard deviations; of a requirement and of a plan nothing."""
    if one.published.required or one.published.planned or not one.flights:
        return ""
    return ("-inf" if one.sigmas < 0.0 else "+inf") if isinf(one.sigmas) else f"{one.sigmas:+.1f}"


def remark(one: Predicted) -> str:
    """Return whether the flown value is predicted, why it does not count, or how many flights keep a
    requirement.
    """
    if one.published.required:
        return f"{100.0 * one.below:.3g} % keep" if isfinite(one.below) else "not reached"
    if one.counted:
        words = [] if one.inside else [OUTSIDE]
    else:
        words = [one.published.evidence]
    return ", ".join(words + ([FITTED] if one.fitted else []))


def heading(mission: Compared) -> tuple[str, ...]:
    """The row of a mission above those of its figures: how many flights, and how much of it is predicted."""
    share = inside(mission.predicted)
    return (
        mission.name,
        counted(mission.flights, "flight"),
        *("", "", "", ""),
        f"{share.successes} of {share.trials}",
    )


def failures(mission: Compared) -> list[str]:
    """Why flights did not end within limits, and how many."""
    return [
        f"{mission.name}: {counted(number, 'flight')}: {cause}" for cause, number in mission.causes.items()
    ]


def causes(mission: Compared) -> list[str]:
    """Every flown value that counts and is not predicted, with its cause."""
    return [
        f"{mission.name}, {one.figure.meaning}: {one.published.because or 'no cause is known'}"
        for one in mission.counted
        if not one.inside
    ]


def outcome(missions: Sequence[Compared]) -> str:
    """All missions in a line."""
    every = [one for mission in missions for one in mission.predicted]
    share, own = inside(every), inside([one for one in every if not one.fitted])
    if not share.trials:
        return "no flown value counts" + _not_counted(every)
    words = f"{share.successes} of {counted(share.trials, 'flown value')} within {WITHIN:g} sigma, "
    words += f"{100.0 * share.value:.0f} %; goal {100.0 * GOAL:.0f} %"
    if own.trials < share.trials:
        words += f" (of those not calibrated on {own.successes} of {own.trials}, {100.0 * own.value:.0f} %)"
    return words + _not_counted(every)


def _not_counted(predicted: Sequence[Predicted]) -> str:
    """How many values are shown and not counted, by what they are; nothing where there are none."""
    found = Counter(one.published.evidence for one in predicted if not one.published.required)
    told = ", ".join(f"{found[kind]} {kind}" for kind in get_args(Evidence)[1:] if found[kind])
    return f"; not counted: {told}" if told else ""
