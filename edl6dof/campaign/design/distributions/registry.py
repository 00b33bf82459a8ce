"""The distributions that a campaign file may name after ``kind:``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal, Union, get_args, get_origin

from pydantic import Field

from edl6dof.campaign.design.distributions import discrete, log_normal, normal, truncated_normal, uniform
from edl6dof.campaign.design.distributions.base import DistributionParams
from edl6dof.config.errors import refusal
from edl6dof.registry import Family, Member

DISTRIBUTIONS = Family(
    "distribution",
    (normal.MEMBER, truncated_normal.MEMBER, uniform.MEMBER, log_normal.MEMBER, discrete.MEMBER),
)


def _params(member: Member) -> type[DistributionParams]:
    """Parameter model of a distribution, which a plugin may have got wrong.

    Raises:
        ConfigError: it is no distribution that can be chosen by its name.
    """
    field = member.params.model_fields.get("kind")
    named = field is not None and get_origin(field.annotation) is Literal and get_args(field.annotation)
    if not issubclass(member.params, DistributionParams) or named != (member.name,):
        wanted = f"its parameters must be DistributionParams with kind: Literal[{member.name!r}]"
        raise refusal("plugins", f"distribution {member.name}: {wanted}")
    return member.params


if TYPE_CHECKING:
    Distribution = DistributionParams
else:  # which members there are, plugins included, is known only when it runs
    Distribution = Annotated[
        Union[tuple(_params(member) for member in DISTRIBUTIONS.members)],  # noqa: UP007  as many as there are
        Field(discriminator="kind"),
    ]
