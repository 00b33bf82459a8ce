"""Two named sets of a law's numbers: as its paper prints them, and as they are flown here.

A field declares both at once: its default is what is flown, ``printed`` what the paper has; a default of
status published is both.  The key ``settings`` chooses.  With ``as_printed`` every such field has the number
of the paper: another one is refused, so that nothing detuned goes by the paper's name.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal, Self

from pydantic import model_validator

from edl6dof.config.base import Params, param
from edl6dof.config.errors import Inconsistent


class PrintedParams(Params):
    """Parameters of a law, some of which its paper prints."""

    settings: Literal["flown", "as_printed"] = param(
        "flown",
        "flown: the defaults of this software; as_printed: the numbers of the paper",
        record=False,
    )

    @model_validator(mode="before")
    @classmethod
    def _take_printed(cls, given: Any) -> Any:
        """Give every field its printed number that is not given."""
        if isinstance(given, dict) and given.get("settings") == "as_printed":
            return {**cls.printed(), **given}
        return given

    @model_validator(mode="after")
    def _named_truly(self) -> Self:
        if self.settings == "as_printed" and (wrong := self._other_than_printed()):
            raise Inconsistent(wrong)
        return self

    @classmethod
    def decided_by(cls, key: str) -> Iterable[str]:
        """Choosing the settings takes back what was said of the numbers that go by their name."""
        return cls.printed() if key == "settings" else ()

    @classmethod
    def printed(cls) -> dict[str, Any]:
        """Return what the paper prints, by field name."""
        found = {}
        for name, info in cls.model_fields.items():
            if isinstance(extra := info.json_schema_extra, dict):
                if "printed" in extra:
                    found[name] = extra["printed"]
                elif extra.get("status") == "published":
                    found[name] = info.default
        return found

    def _other_than_printed(self) -> dict[str, str]:
        return {
            name: f"is {value:g} with settings: as_printed (got {own:g}): leave it out, or say flown"
            for name, value in self.printed().items()
            if (own := getattr(self, name)) != value
        }
