"""NASA NESC 6-DOF check cases 1 to 10 (NASA/TM-2015-218675) on Earth.

gravity central or J2 | atmosphere US76 | winds none, steady or sheared | vehicle sphere, brick | source:
simulation 04 of the NESC study, row by row in cases 1, 2, 6 and 9, at the end in the others | tolerance: set
before the comparison, 0.01 ft, 0.001 ft/s, 1e-4 deg/s, 1e-3 deg, 1e-6 deg of latitude and longitude; flights,
reading and comparison are those of :mod:`edl6dof.verify.nesc_cases`.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import edl6dof
from edl6dof.verify.outcome import Outcome, Result

DATA = Path(edl6dof.__file__).parent / "data" / "nesc"
COMPARISON = "edl6dof.verify.nesc_cases"


class NotInstalledError(RuntimeError):
    """A check case lacks its reference data."""


def run(planted: Sequence[str] = ()) -> Outcome:
    """Fly every case that has reference data and compare it.

    Raises:
        NotInstalledError: reference data or comparison are not part of this installation.
    """
    if not any(DATA.glob("*.csv")) or find_spec(COMPARISON) is None:
        raise NotInstalledError("the NESC reference data are not part of this installation")
    from edl6dof.verify.nesc_cases import CASES, SOURCE, TOLERANCES, differences, flown, reference

    results = []
    for number in CASES:
        found = differences(flown(number, planted), reference(number))
        for _, quantity, limit, unit in TOLERANCES:
            if quantity in found:
                about, error = f"case {number}: {quantity}", float(found[quantity])
                results.append(
                    Result(
                        about,
                        "whole plant on Earth",
                        SOURCE,
                        error,
                        limit,
                        unit,
                        "set beforehand; room for the constants of US76",
                    )
                )
    return Outcome(tuple(results))
