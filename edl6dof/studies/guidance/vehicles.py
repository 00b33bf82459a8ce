"""The entries that the comparison flies: two missions in six degrees of freedom on instruments, with either
trigger of their parachute, and the point masses of three papers.

A paper's point mass is flown here with what a vehicle has: a bank angle that turns at a rate, and a drag
reference that is updated by the range to go.  The paper as it is printed is flown by its own study.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import degrees
from typing import Any

import numpy as np

from edl6dof.campaign.design.plan import load_plan
from edl6dof.fsw.guidance.entry.prediction.reference import reference_bank
from edl6dof.scenario.loading import LoadedScenario, load_scenario
from edl6dof.scenario.records import build_records

ENTRY = "flight_software.guidance.entry"
SEED = 2021

_BANK_RATE_DEG_S = 20.0
#: What the point mass of a paper is given to be flown like a vehicle.
_AS_A_VEHICLE = (
    "point_mass.bank_response=rate_limited",
    f"point_mass.bank_rate_deg_s={_BANK_RATE_DEG_S:g}",
    f"{ENTRY}.bank_rate_deg_s={_BANK_RATE_DEG_S:g}",
    f"{ENTRY}.tracking.update=true",
)


@dataclass(frozen=True)
class Vehicle:
    """An entry by the name of its scenario.

    Attributes:
        name: of the scenario.
        changes: ``--set`` texts that this comparison adds.
        dispersions: campaign whose dispersions it is flown with, too; none where empty.
    """

    name: str
    changes: tuple[str, ...] = ()
    dispersions: str = ""

    def load(self, *more: str) -> LoadedScenario:
        """The scenario down to the mortar."""
        return load_scenario(self.name, ["mission.goal=deployment", *self.changes, *more])


VEHICLES = (
    *(Vehicle(name, dispersions="tianwen1_mc") for name in ("tianwen1", "tianwen1_range_trigger")),
    *(Vehicle(name, dispersions="msl_mc") for name in ("msl", "msl_range_trigger")),
    Vehicle("zheng2015", _AS_A_VEHICLE),
    Vehicle("wu2013", _AS_A_VEHICLE),
    Vehicle("yan2016", _AS_A_VEHICLE),
)

#: What a law is flown with besides: FNPEG plans its reversals itself.
_WITH_LAW = {"fnpeg": (f"{ENTRY}.reversal.logic=own_sign",)}


def with_law(vehicle: Vehicle, law: str) -> LoadedScenario:
    """The entry flown by a law; the open-loop law flies the bank angle that was planned."""
    planned = vehicle.load(f"{ENTRY}.reference_bank.fit_range=true")
    return vehicle.load(
        "simulation.log_every=5",
        f"{ENTRY}.law={law}",
        *_WITH_LAW.get(law, ()),
        f"{ENTRY}.bank_profile={json.dumps({'points': planned_bank(planned)})}",
    )


def planned_bank(loaded: LoadedScenario) -> list[dict[str, float]]:
    """The planned bank angle as points of an open-loop profile over speed."""
    onboard = build_records(loaded).onboard[0]
    shift = float(onboard["reference"]["shift"])
    slowest = loaded.scenario.flight_software.guidance.entry.align_speed_m_s + 1.0
    return [
        {"at": round(float(v), 3), "bank_deg": degrees(reference_bank(onboard, shift, v))}
        for v in np.linspace(slowest, loaded.scenario.initial.speed, 16)
    ]


def entries(dispersions: str, flights: int) -> list[dict[str, Any]]:
    """True values of dispersed entries: those of a campaign; what acts after the mortar changes nothing."""
    return [dict(case.truth) for case in load_plan(dispersions, cases=flights).cases()]
