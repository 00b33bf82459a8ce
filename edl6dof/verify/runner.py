"""Run one check case; a case that breaks fails and the others go on."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

from edl6dof.verify.cases.nesc import NotInstalledError
from edl6dof.verify.outcome import History, Outcome, Result
from edl6dof.verify.registry import CASES


@dataclass(frozen=True, repr=False)
class Report:
    """What became of one case.

    Attributes:
        note: why it was skipped or broke; empty otherwise.
        skipped: it cannot run on this installation, which fails nothing.
    """

    name: str
    results: tuple[Result, ...]
    history: History | None
    seconds: float
    note: str = ""
    skipped: bool = False

    def __repr__(self) -> str:
        outcome = "skipped" if self.skipped else "within tolerance" if self.passed else "FAILED"
        return f"<Report {self.name}: {len(self.results)} comparisons, {outcome}>"

    @property
    def passed(self) -> bool:
        """Whether every comparison of the case is within its tolerance."""
        return self.skipped or Outcome(self.results).passed

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON; an error that is not finite becomes null."""
        rows = [
            {
                **vars(result),
                "error": float(result.error) if math.isfinite(result.error) else None,
                "passed": result.passed,
            }
            for result in self.results
        ]
        state = {
            "passed": self.passed,
            "skipped": self.skipped,
            "note": self.note,
            "seconds": round(self.seconds, 3),
        }
        return {"case": self.name, **state, "results": rows}


def run_case(name: str) -> Report:
    """Run one case by name."""
    begin = time.perf_counter()
    try:
        outcome = CASES[name]()
    except NotInstalledError as error:
        return Report(name, (), None, 0.0, str(error), skipped=True)
    except Exception as error:  # a case that breaks is a failed case, and the table goes on
        return Report(name, (), None, time.perf_counter() - begin, f"{type(error).__name__}: {error}")
    return Report(name, outcome.results, outcome.history, time.perf_counter() - begin)
