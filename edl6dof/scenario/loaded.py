"""A validated scenario and the files it was read from.

This module imports no family of models, so that plugins can be loaded before the families are built.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from edl6dof.config.document.document import Document
    from edl6dof.scenario.schema import Scenario


@dataclass(frozen=True, repr=False)
class LoadedScenario:
    """A validated scenario, and the files that it was read from.

    Attributes:
        scenario: the nominal scenario, which the flight computer believes.
        truth: the scenario with its ``truth`` section applied, from which the plant is built.
        document: the files it was read from, with the place and status of every value.
    """

    scenario: Scenario
    truth: Scenario
    document: Document

    def __repr__(self) -> str:
        return f"<LoadedScenario {self.scenario.name}: {self.scenario.description}>"

    @cached_property
    def warnings(self) -> list[str]:
        """One line with file, line and key for each value that is allowed but unusual, perhaps by mistake."""
        from edl6dof.config.refused import steps
        from edl6dof.config.validate import new_entry
        from edl6dof.scenario.unusual import unusual_in

        found = {(*path, "name"): new_entry(near) for path, near in self.document.similar.items()}
        unusual = unusual_in(self.scenario) | unusual_in(self.truth)
        found |= {steps(path): words for path, words in unusual.items()}
        return [str(self.document.problem(path, words)) for path, words in found.items()]
