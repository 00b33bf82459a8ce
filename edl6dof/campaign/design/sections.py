"""The ``campaign:``, ``sweep:`` and ``fault_matrix:`` sections of a scenario file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, Union, get_args, get_origin

import numpy as np
from pydantic import Field, model_validator

from edl6dof.campaign.design.distributions import (
    DISCRETE,
    LOG_NORMAL,
    NORMAL,
    TRUNCATED_NORMAL,
    UNIFORM,
    DistributionParams,
)
from edl6dof.campaign.row_columns import Of
from edl6dof.config.base import REQUIRED, Params, Title, param, section, stated
from edl6dof.config.errors import refusal
from edl6dof.registry import Family, Member
from edl6dof.spatial.arrays import cholesky
from edl6dof.vehicle.faults.component import Component
from edl6dof.vehicle.faults.fault import FaultStart

DISTRIBUTIONS = Family("distribution", (NORMAL, TRUNCATED_NORMAL, UNIFORM, LOG_NORMAL, DISCRETE))


def _params(member: Member) -> type[DistributionParams]:
    """Parameter model of a distribution.

    Raises:
        ConfigError: a plugin's distribution cannot be chosen by its name.
    """
    field = member.params.model_fields.get("kind")
    named = field is not None and get_origin(field.annotation) is Literal and get_args(field.annotation)
    if not issubclass(member.params, DistributionParams) or named != (member.name,):
        wanted = f"its parameters must be DistributionParams with kind: Literal[{member.name!r}]"
        raise refusal("plugins", f"distribution {member.name}: {wanted}")
    return member.params


if TYPE_CHECKING:
    Distribution = DistributionParams
else:  # the members, plugins included, are known only at run time
    Distribution = Annotated[
        Union[tuple(_params(member) for member in DISTRIBUTIONS.members)],  # noqa: UP007  as many as there are
        Field(discriminator="kind"),
    ]


class Correlated(Params):
    """Parameters dispersed together: normally about their nominal values, with a covariance matrix."""

    of: Of = param(
        "truth", "values that are changed: of the truth, of the on-board model (belief), or of both"
    )
    paths: list[str] = param(REQUIRED, "dotted paths", min_length=2)
    three_sigma: list[float] | None = param(None, "three standard deviations of each; needs correlation")
    correlation: list[list[float]] | None = param(None, "correlation matrix")
    covariance: list[list[float]] | None = param(
        None, "covariance matrix, instead of three_sigma and correlation"
    )

    @model_validator(mode="after")
    def _a_covariance(self) -> Self:
        given = (self.three_sigma is not None, self.correlation is not None, self.covariance is not None)
        matrix = self.correlation if self.covariance is None else self.covariance
        if matrix is None or given not in ((True, True, False), (False, False, True)):
            raise ValueError("must give three_sigma and correlation, or covariance")
        size = len(self.paths)
        if len(matrix) != size or any(len(row) != size for row in matrix):
            raise ValueError(f"the matrix must have {size} rows of {size} numbers, one for each path")
        if self.three_sigma is not None and (len(self.three_sigma) != size or min(self.three_sigma) <= 0.0):
            raise ValueError(f"three_sigma must be {size} positive numbers")
        if self.correlation is not None and any(self.correlation[i][i] != 1.0 for i in range(size)):
            raise ValueError("the diagonal of the correlation matrix must be 1")
        if not np.array_equal(matrix, np.transpose(matrix)):
            raise ValueError("the matrix must be symmetric")
        try:
            cholesky(self.matrix)
        except ValueError:
            words = "the matrix must be positive definite: no parameters correlate like this"
            raise ValueError(words) from None
        return self

    @property
    def matrix(self) -> np.ndarray:
        """Covariance matrix."""
        if self.covariance is not None:
            return np.asarray(self.covariance)
        sigma = np.asarray(self.three_sigma) / 3.0
        return np.asarray(self.correlation) * np.outer(sigma, sigma)


class FaultDraw(Params):
    """A fault that happens in some of the flights."""

    chance: float = param(REQUIRED, "probability of a fault in one flight", gt=0.0, le=1.0)
    one_of: list[dict[str, Any]] = param(
        REQUIRED,
        "faults, written as in the section faults of a scenario; one of them occurs, all equally likely",
        min_length=1,
    )
    later_s: float = param(
        0.0, "largest random delay after the moment of the fault, uniformly distributed", ge=0.0
    )


class CampaignParams(Params):
    """Number of flights, and the differences of each from the scenario."""

    cases: int = param(1000, "number of flights, or of rows of the Sobol design", ge=1, le=10_000_000)
    seed: int = param(1, "seed of the dispersions; the same seed gives the same cases", ge=0)
    sampling: Literal["monte_carlo", "latin_hypercube", "sobol", "sobol_indices"] = param(
        "monte_carlo",
        (
            "independent random cases, one in each of as many strata of every parameter, a scrambled Sobol "
            "sequence, or the design of Sobol indices: for each row two cases and one more for each group of "
            "dispersions"
        ),
    )
    profiles: bool = param(True, "whether each case meets random profiles (density, gusts) of its own")
    truth: dict[str, Distribution] = param(
        None,
        (
            "dispersions that the flight computer does not know, by dotted path; * stands for every item "
            "of a list"
        ),
        factory=dict,
    )
    belief: dict[str, Distribution] = param(
        None, "dispersions of the on-board model alone; the truth does not change", factory=dict
    )
    both: dict[str, Distribution] = param(
        None, "dispersions of the truth that the flight computer knows", factory=dict
    )
    correlated: list[Correlated] = param(None, "groups of parameters dispersed together", factory=list)
    constant: list[str] = param(
        None,
        (
            "dispersed parameters that are constant but unknown (epistemic), by dotted path; * stands for "
            "any text. All others are random from flight to flight (aleatory)"
        ),
        factory=list,
    )
    faults: list[FaultDraw] = param(None, "faults that happen in some of the flights", factory=list)

    @model_validator(mode="after")
    def _a_design_of_numbers(self) -> Self:
        if self.sampling == "sobol_indices" and self.faults:
            raise ValueError("sampling sobol_indices swaps numbers between flights and takes no faults")
        return self


class Axis(Params):
    """One axis of a sweep: a parameter and its values."""

    path: str = param(REQUIRED, "dotted path")
    of: Of = param("both", "value that is changed: of the truth, of the on-board model (belief), or of both")
    values: list[Any] | None = param(None, "the values", min_length=1)
    first: float | None = param(None, "first value, instead of values")
    last: float | None = param(None, "last value, with first")
    count: int | None = param(None, "number of evenly spaced values from first to last", ge=2, le=10_000)

    @model_validator(mode="after")
    def _values_or_range(self) -> Self:
        given = [item is not None for item in (self.values, self.first, self.last, self.count)]
        if given not in ([True, False, False, False], [False, True, True, True]):
            raise ValueError("must give values, or first, last and count")
        return self

    @property
    def points(self) -> list[Any]:
        """The values along the axis."""
        if self.values is not None:
            return list(self.values)
        first, last, count = stated(self.first), stated(self.last), stated(self.count)
        return [float(value) for value in np.linspace(first, last, count)]


class SweepParams(Params):
    """A grid over some parameters; with a campaign section, all its cases are flown at every point."""

    axes: list[Axis] = param(
        REQUIRED, "the grid's axes, the last varying fastest", min_length=1, max_length=6
    )

    @model_validator(mode="after")
    def _axes_differ(self) -> Self:
        if len({axis.path for axis in self.axes}) < len(self.axes):
            raise ValueError("the axes must have different paths")
        return self


class FaultMoment(Params):
    """A moment at which components fail, and its name."""

    name: Title = param(REQUIRED, "name of the moment, such as 60 s, mortar, or a phase")
    at: FaultStart = section("when the fault begins")


class FaultGroup(Params):
    """Components of one kind that fail in one way, one after the other at each of several moments."""

    kind: str = param(REQUIRED, "kind of fault")
    component: Component = param(REQUIRED, "kind of component that fails")
    names: list[str] = param(REQUIRED, "components that fail, one after the other", min_length=1)
    settings: dict[str, Any] = param(
        None, "other keys of each fault, as in the section faults of a scenario", factory=dict
    )
    moments: list[FaultMoment] = param(REQUIRED, "moments at which they fail", min_length=1)


class FaultMatrixParams(Params):
    """Faults of which each flight has one, or several at once."""

    groups: list[FaultGroup] = param(REQUIRED, "components that fail, and moments", min_length=1)
    together: int = param(1, "components that fail at the same moment", ge=1, le=4)


class CampaignFile(Params):
    """Sections of a scenario file for many flights of the scenario."""

    campaign: CampaignParams | None = param(None, "dispersed flights")
    sweep: SweepParams | None = param(None, "flights on a grid")
    fault_matrix: FaultMatrixParams | None = param(None, "flights with faults, one for each cell")
