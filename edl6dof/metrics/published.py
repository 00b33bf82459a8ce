"""Published figures of the real flight, compared with those of this flight.

A flown value is compared on both sides, in standard deviations if its uncertainty is known.  A requirement on
the mission is a bound, which is kept or broken.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from math import copysign, inf
from typing import Literal, NamedTuple, Self

from pydantic import model_validator

from edl6dof.config.base import Params, param
from edl6dof.config.errors import Inconsistent
from edl6dof.config.wording import did_you_mean
from edl6dof.metrics.evaluation import AT_EVENTS, event_and_quantity
from edl6dof.metrics.figures import DECLARED, FigureOfMerit, figure_of_merit
from edl6dof.spatial.elementary import hypot

_KINDS = ("value", "magnitude", "at_most", "at_least")
_ONE = "one of value, magnitude, at_most and at_least"
#: Kind of evidence of a published number.  Only the first two count: measured in the flight, and computed
#: afterwards from measurements and models.
Evidence = Literal["flown", "reconstructed", "bound", "planned", "commanded", "duplicate"]
COUNTED = ("flown", "reconstructed")


class PublishedFigure(Params):
    """One published figure: one of ``value`` (or a plain number), ``magnitude``, ``at_most``, ``at_least``,
    in the unit of the figure's name.
    """

    value: float | None = param(None, "value of the real flight", record=False)
    magnitude: float | None = param(
        None,
        "magnitude of the flown value, if its sign was not printed or is that of another frame",
        record=False,
        ge=0.0,
    )
    at_most: float | None = param(None, "requirement: the figure is no larger", record=False)
    at_least: float | None = param(None, "requirement: the figure is no smaller", record=False)
    sigma: float | None = param(
        None,
        "standard deviation of the flown value, from its printed digits or from reading a plot",
        record=False,
        gt=0.0,
    )
    evidence: Evidence = param(
        "flown",
        "flown: it counts; reconstructed: computed after the flight from measurements and models, such as a "
        "Mach number, it counts; bound: printed as a bound of the flown value; planned: printed before the "
        "flight; commanded: a setting of this scenario chooses it; duplicate: a setting fixes its difference "
        "to another published figure",
        record=False,
    )
    because: str | None = param(
        None,
        "cause of a difference between this model and the value; edl6dof validate prints it",
        record=False,
    )

    @model_validator(mode="after")
    def _says_one_thing(self) -> Self:
        given = [name for name in _KINDS if getattr(self, name) is not None]
        problems = {}
        if not given:
            problems["value"] = f"required key is missing: give {_ONE}"
        elif len(given) > 1:
            problems[given[-1]] = f"must not stand beside {given[0]}: give {_ONE}"
        if self.sigma is not None and self.required:
            problems["sigma"] = "a requirement has none: leave it out"
        if self.evidence != "flown" and self.required:
            problems["evidence"] = "a requirement is never counted: leave it out"
        if problems:
            raise Inconsistent(problems)
        return self

    @property
    def required(self) -> bool:
        """True if it is a requirement and not a flown value."""
        return self.at_most is not None or self.at_least is not None

    @property
    def planned(self) -> bool:
        """True if it was printed before the flight and not measured in it."""
        return self.evidence == "planned"

    @property
    def explainable(self) -> bool:
        """True if a calibration may explain it: a flown value with a standard deviation."""
        return self.sigma is not None and not self.planned

    @property
    def number(self) -> float:
        """The published number of any kind."""
        return next(x for x in (self.value, self.magnitude, self.at_most, self.at_least) if x is not None)

    @property
    def bound(self) -> Literal["", "<=", ">="]:
        """Relation of a figure to a requirement; empty for a flown value."""
        if not self.required:
            return ""
        return "<=" if self.at_most is not None else ">="

    @property
    def mark(self) -> str:
        """Mark before the number: ``<=``, ``>=``, ``+-`` or nothing."""
        return f"{self.bound} " if self.required else "+-" if self.magnitude is not None else ""

    def of(self, own: float) -> float:
        """Figure of this flight to compare with the published one: its magnitude, if that was published."""
        return abs(own) if self.magnitude is not None else own

    def sigmas(self, own: float, deviation: float = 0.0) -> float | None:
        """Difference of a figure to the flown value over their combined standard deviation: that of the
        published value (``None`` is returned if it is unknown), and ``deviation`` if the figure is a mean.
        """
        if self.sigma is None:
            return None
        return (self.of(own) - self.number) / hypot(self.sigma, deviation)

    def away(self, mean: float, deviation: float) -> float:
        """Difference of the mean of many flights to the flown value in standard deviations of the published
        value, if known, and of a single flight; infinite for a difference without either.
        """
        difference = self.of(mean) - self.number
        width = hypot(self.sigma or 0.0, deviation)
        return difference / width if width > 0.0 else copysign(inf, difference) if difference else 0.0

    def kept(self, own: float) -> bool | None:
        """True if a requirement is met, ``None`` for a flown value; NaN meets no requirement."""
        if self.at_most is not None:
            return own <= self.at_most
        return own >= self.at_least if self.at_least is not None else None


#: Entries of ``published`` by the name of the figure; ``None`` removes that of an extended scenario.
Published = Mapping[str, float | PublishedFigure | None]


class PublishedPair(NamedTuple):
    """A figure and its published value or requirement."""

    figure: FigureOfMerit
    published: PublishedFigure


def published_figures(entries: Published) -> list[PublishedPair]:
    """Every published figure with its declaration, in the order of the file."""
    given = ((name, entry) for name, entry in entries.items() if entry is not None)
    return [
        PublishedPair(
            figure_of_merit(name), one if isinstance(one, PublishedFigure) else PublishedFigure(value=one)
        )
        for name, one in given
    ]


def published_problems(names: Iterable[str], events: Collection[str]) -> dict[str, str]:
    """Messages by dotted path for published values that are no figure of a flight with these ``events``."""
    endings = ", ".join(f"_{quantity}" for quantity in AT_EVENTS)
    words = f"no figure of a flight has this name, nor is it an event of the mission with one of {endings}"
    return {
        f"published.{name}": words + did_you_mean(name, DECLARED)
        for name in names
        if name not in DECLARED and event_and_quantity(name, events) is None
    }
