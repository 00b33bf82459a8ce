"""Faults: what breaks, and when.  They change the true vehicle only; the flight computer has to find out.

A fault begins at a flight time, or a while after a mission phase was entered, and lasts.  It acts between the
actuators and the plant: :func:`inflict` runs after the commands of a base cycle have reached the valves and
before the plant moves.

Left out: intermittent faults, leaks, and valves that fail between open and shut.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Params, param, section
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.interface.capacities import MAX_FAULTS
from edl6dof.interface.events import DEPLOY
from edl6dof.jit import kernel
from edl6dof.registry import Family, Member
from edl6dof.vehicle.plant import NOT_BEGUN, THRUST, THRUSTER_KINDS
from edl6dof.vehicle.surfaces import wing_opening

#: Longer than any base cycle, s: a valve held open is open all through it.
LONG = 1.0

#: Numbers of ``THRUSTER_KINDS``.
STUCK_OFF, STUCK_ON, DEGRADED = 1, 2, 3


class StuckOffParams(Params):
    """The thruster does not fire any more."""


class StuckOnParams(Params):
    """The thruster's valve does not close any more; only isolating the thruster stops it."""


class DegradedParams(Params):
    """The thruster gives less thrust."""

    thrust_factor: float = param(0.5, "thrust left", ge=0.0, lt=1.0)


class WingStuckParams(Params):
    """The trim wing opens no further."""

    opening: float = param(
        0.0, "opening at which it stays, unless it is further open already", ge=0.0, lt=1.0
    )


class WingLostParams(Params):
    """The trim wing is torn off."""


class ParachuteDelayParams(Params):
    """The mortar fires late."""

    delay_s: float = param(3.0, "time lost", gt=0.0, le=600.0)


class EngineShortfallParams(Params):
    """The main engine gives less thrust than its throttle is set to."""

    thrust_factor: float = param(0.8, "thrust left", ge=0.0, lt=1.0)


class ThrottleStuckParams(Params):
    """The throttle of the main engine stays where it is; before ignition, at full thrust.  Cut-off still
    works.
    """


@kernel
def stuck_off(fault, case, since, command, plant):
    """Keep the valve shut."""
    i = fault.thruster
    plant.valves.fault[i] = STUCK_OFF
    plant.valves.opens[i] = plant.valves.closes[i] = plant.t


@kernel
def stuck_on(fault, case, since, command, plant):
    """Keep the valve open."""
    i = fault.thruster
    plant.valves.fault[i] = STUCK_ON
    plant.valves.opens[i], plant.valves.closes[i] = plant.t, plant.t + LONG


@kernel
def degraded(fault, case, since, command, plant):
    """Take away part of the thrust."""
    i = fault.thruster
    plant.valves.fault[i] = DEGRADED
    plant.valves.lost[i] = 1.0 - fault.params.degraded.thrust_factor


@kernel
def wing_stuck(fault, case, since, command, plant):
    """Limit the opening of every surface."""
    for i in range(case.vehicle.n_surfaces):
        already = wing_opening(case.vehicle.surfaces[i], since - plant.wing_start[i])
        plant.wing_lost[i] = 1.0 - max(fault.params.wing_stuck.opening, already)


@kernel
def wing_lost(fault, case, since, command, plant):
    """Take every surface away."""
    for i in range(case.vehicle.n_surfaces):
        plant.wing_lost[i] = 1.0


@kernel
def parachute_delay(fault, case, since, command, plant):
    """Put every deployment of a parachute off when it is commanded."""
    for i in range(case.events.n_events):
        if command.request[i] != 0 and case.events.events[i].action == DEPLOY:
            plant.due[i] += fault.params.parachute_delay.delay


@kernel
def engine_shortfall(fault, case, since, command, plant):
    """Take away part of the thrust of every engine."""
    for i in range(case.vehicle.n_engines):
        plant.thrust_lost[i] = 1.0 - fault.params.engine_shortfall.thrust_factor


@kernel
def throttle_stuck(fault, case, since, command, plant):
    """Hold the level of every engine of the moment the fault began."""
    for i in range(case.vehicle.n_engines):
        if plant.t == since:
            running = plant.running[i] != 0
            plant.thrust_held[i] = plant.y[THRUST + i] if running else case.vehicle.engines[i].full_thrust
        plant.thrust_command[i] = plant.thrust_held[i]


FAULT_KINDS = Family(
    "fault kind",
    (
        Member("stuck_off", StuckOffParams, {"inflict": stuck_off}, "Hu et al. 2022, section 6.3"),
        Member("stuck_on", StuckOnParams, {"inflict": stuck_on}, "valve failed open"),
        Member("degraded", DegradedParams, {"inflict": degraded}, "partly blocked feed or catalyst"),
        Member("wing_stuck", WingStuckParams, {"inflict": wing_stuck}, "Hu et al. 2022, section 4.3"),
        Member("wing_lost", WingLostParams, {"inflict": wing_lost}, "structural failure"),
        Member("parachute_delay", ParachuteDelayParams, {"inflict": parachute_delay}, "late mortar"),
        Member(
            "engine_shortfall", EngineShortfallParams, {"inflict": engine_shortfall}, "low chamber pressure"
        ),
        Member("throttle_stuck", ThrottleStuckParams, {"inflict": throttle_stuck}, "seized throttle valve"),
    ),
)

_inflict = FAULT_KINDS.switch("inflict", "fault", "vehicle", "since", "command", "plant")
_Kinds: Any = FAULT_KINDS.params_model("FaultKinds", "kind", REQUIRED, "What breaks.")


class FaultStart(Params):
    """When a fault begins: at a flight time, or a while after a phase was entered."""

    phase: str | None = param(None, "mission phase after whose start the fault begins", record=False)
    plus_s: float = param(0.0, "time after the start of that phase", record=False, ge=0.0)
    time_s: float | None = param(None, "flight time, instead of a phase", record=False, ge=0.0)

    @model_validator(mode="after")
    def _phase_or_time(self) -> FaultStart:
        if (self.phase is None) == (self.time_s is None):
            raise ValueError("must name either a phase (with plus_s) or a time_s")
        return self


class FaultParams(_Kinds):
    """One fault."""

    thruster: str | None = param(None, "name of the thruster that a thruster fault is about", record=False)
    at: FaultStart = section("when it begins", record=False)

    @model_validator(mode="after")
    def _thruster_where_needed(self) -> FaultParams:
        if self.kind in THRUSTER_KINDS and self.thruster is None:
            raise ValueError(f"{self.kind} must name its thruster")
        if self.kind not in THRUSTER_KINDS and self.thruster is not None:
            raise ValueError(f"{self.kind} is not about a thruster (got {self.thruster!r})")
        return self

    @property
    def label(self) -> str:
        """Short name: ``D7 stuck off``."""
        return " ".join(filter(None, (self.thruster, self.kind.replace("_", " "))))


FAULT = np.dtype(
    [
        ("thruster", "i8"),
        ("phase", "i8"),  # index of the mission phase, -1 for a flight time
        ("after", "f8"),  # s after the start of the phase, or flight time
        ("params", dtype_of(FaultParams)),
    ],
    align=True,
)
FAULTS = np.dtype([("count", "i8"), ("slots", FAULT, (MAX_FAULTS,))], align=True)


def fault_problems(
    faults: Sequence[FaultParams], thrusters: Sequence[str], phases: Sequence[str]
) -> dict[str, str]:
    """Names of thrusters and phases that do not exist, by dotted key."""
    problems: dict[str, str] = {}
    for index, fault in enumerate(faults):
        if fault.thruster is not None and fault.thruster not in thrusters:
            problems[f"faults.{index}.thruster"] = (
                f"no thruster named {fault.thruster!r}; names: {', '.join(thrusters) or 'none'}"
            )
        if fault.at.phase is not None and fault.at.phase not in phases:
            problems[f"faults.{index}.at.phase"] = (
                f"no phase named {fault.at.phase!r}; names: {', '.join(phases) or 'none'}"
            )
    return problems


def fill_faults(
    record: np.void, faults: Sequence[FaultParams], thrusters: Sequence[str], phases: Sequence[str]
) -> None:
    """Write checked faults into a ``FAULTS`` record, names turned into indices."""
    record["count"] = len(faults)
    for slot, fault in zip(record["slots"], faults, strict=False):
        slot["thruster"] = thrusters.index(fault.thruster) if fault.thruster is not None else -1
        slot["phase"] = phases.index(fault.at.phase) if fault.at.phase is not None else -1
        slot["after"] = fault.at.plus_s if fault.at.phase is not None else fault.at.time_s
        fill(slot["params"], fault)


@kernel
def begin(fault, index, command, plant):
    """Note when fault ``index`` begins: in the first base cycle at or after its time."""
    started = plant.t
    if fault.phase >= 0:
        if command.phase < fault.phase:
            return
        if plant.phase_seen[index] == NOT_BEGUN:
            plant.phase_seen[index] = plant.t
        started = plant.t - plant.phase_seen[index]
    if started >= fault.after - 1e-9:
        plant.fault_since[index] = plant.t


@kernel
def inflict(case, command, plant):
    """Let every fault that has begun act on the commanded actuators."""
    faults = case.faults
    for i in range(faults.count):
        fault = faults.slots[i]
        if plant.fault_since[i] == NOT_BEGUN:
            begin(fault, i, command, plant)
        if plant.fault_since[i] != NOT_BEGUN:
            _inflict(fault.params.kind, fault, case, plant.fault_since[i], command, plant)
