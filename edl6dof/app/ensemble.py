"""The flights of a campaign, flown again for their trajectories: a campaign keeps one row of each, and every
case repeats exactly.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from os.path import lexists
from pathlib import Path
from typing import Any

import numpy as np

from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import fly_rows
from edl6dof.campaign.run import resumed_plan
from edl6dof.campaign.storage.store import Store
from edl6dof.replay.history import thin, vector
from edl6dof.replay.scene.ensemble import Trajectory
from edl6dof.sim.flight import Flight

#: Cases drawn; more would hide each other.
MOST = 2000
RATE_HZ = 0.5


def is_campaign(folder: Path) -> bool:
    """Whether a folder holds a campaign."""
    return lexists(folder / "campaign.json")


def campaign_plan(folder: Path) -> Plan:
    """The plan of a campaign's folder.

    Raises:
        ConfigError: it was flown with another program or other files, so its flights would not repeat; or its
            plan cannot be read.
    """
    return resumed_plan(Store(folder))


def trajectories(plan: Plan) -> list[Trajectory]:
    """The trajectory of every case, in order; a case that could not fly has none."""
    count = min(plan.count, MOST)
    found = []
    for done, row in enumerate(fly_rows(plan.loaded, plan.cases(0, count), collect=_places), start=1):
        if "places" in row:
            found.append(Trajectory(row["places"], "" if row["success"] else str(row["cause"])))
        if sys.stderr.isatty():
            print(
                f"\r{done} of {count} cases flown again",
                end="" if done < count else "\n",
                file=sys.stderr,
                flush=True,
            )
    return found


def _places(flight: Flight) -> Mapping[str, Any]:
    """Positions in landing-site axes, a row every two seconds, copied: the telemetry belongs to the next
    case.
    """
    rows = thin(np.array(flight.telemetry["t_s"]), RATE_HZ)
    return {"places": vector(flight.telemetry, "truth.site", "east north up", "_m")[rows].astype(np.float32)}
