"""Figures of every experiment beside the published ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pyarrow as pa

from edl6dof.studies.cases import values
from edl6dof.studies.study import Finding
from edl6dof.studies.wu2013.experiments import (
    EXPERIMENTS,
    FLOWN,
    KEPT,
    LAWS,
    MODEL_DRAG,
    NAVIGATED,
    ORDER,
    PRINTED,
    Experiment,
)
from edl6dof.studies.wu2013.flights import CLOSE, converged_s

#: Largest miss of 2,000 entries by law, km; and from when on the curves of figure 3 coincide, s.
MISS_KM, CONVERGED_S = {"ehgo_fl": 8.6, "fl": 18.0}, 0.6
#: Share of the published value within which it counts as reproduced: of the largest of 2,000 misses, which
#: itself varies by as much from one draw of 2,000 to another (5 to 95 %), and of a time read off a figure.
MISS_WITHIN, TIME_WITHIN = 0.15, 0.2
#: Runs from which the largest miss of so many entries is gated as the largest of 2,000.
ENOUGH = 1000

UPDATED = (
    "an update every 5 s takes out what the entry errors have done, under either law; misses of the "
    f"published size come without it ('{KEPT.name}')"
)
MEASURED = (
    "with measured drag and a known scale height FL errs in L/D alone and ends as close as with the "
    "observer; misses of twice those of EHGO+FL and more come when FL does not measure drag "
    f"('{MODEL_DRAG.name}'), and with slow gains ('{FLOWN.name}'); errors of navigation make the printed "
    f"observer the worse of the two ('{NAVIGATED.name}')"
)
#: Why a law's largest miss does not come out; empty where it does.
CAUSES = {
    (PRINTED.name, "ehgo_fl"): UPDATED,
    (PRINTED.name, "fl"): UPDATED,
    (ORDER.name, "ehgo_fl"): UPDATED,
    (ORDER.name, "fl"): UPDATED,
    (KEPT.name, "ehgo_fl"): "",
    (KEPT.name, "fl"): MEASURED,
}

#: Experiments that are none of the paper's.
APART = (NAVIGATED, FLOWN)

Groups = Mapping[tuple[str, str], pa.Table]


def findings(groups: Groups, starts: Mapping[float, dict[str, np.ndarray]]) -> tuple[Finding, ...]:
    """All findings; ``groups`` has the flights by experiment and law, ``starts`` the history of a flight by
    the share of the drag that its observer starts from.
    """
    found = []
    for experiment in EXPERIMENTS:
        if experiment is PRINTED:
            found += _convergence(starts)
        for law in experiment.laws:
            found += _law(experiment, law, groups[experiment.name, law])
    return tuple(found)


def _law(experiment: Experiment, law: str, table: pa.Table) -> tuple[Finding, Finding]:
    miss, error = values(table, "parachute_miss_m") / 1e3, values(table, "rms_error_m_s2")
    claimed = (experiment.name, law) in CAUSES and len(miss) >= ENOUGH
    return (
        Finding(
            f"{LAWS[law]}: largest miss",
            "km",
            float(np.max(miss)),
            None if experiment in APART else MISS_KM[law],
            note=f"{len(miss)} entries",
            within=MISS_WITHIN if claimed else None,
            why=CAUSES[experiment.name, law] if claimed else "",
            experiment=experiment.name,
        ),
        Finding(
            f"{LAWS[law]}: RMS drag error",
            "m/s2",
            float(np.mean(error)),
            note="from 30 s, mean",
            experiment=experiment.name,
        ),
    )


def _convergence(starts: Mapping[float, dict[str, np.ndarray]]) -> list[Finding]:
    """Figure 3: when the estimates come to coincide with the truth; where they start is not printed."""
    found = []
    for share, h in starts.items():
        slowest = max(converged_s(h, name) for name in ("drag", "rate"))
        found.append(
            Finding(
                f"Fig. 3: within {100 * CLOSE:g} %, from {100 * share:g} % of the drag",
                "s",
                slowest,
                CONVERGED_S,
                within=TIME_WITHIN if share > 0.0 else None,
                experiment=PRINTED.name,
            )
        )
    return found
