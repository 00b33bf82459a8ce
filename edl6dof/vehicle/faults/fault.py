"""Faults: what breaks, and when.  They change the true vehicle only; the flight computer has to find out.

A fault acts on one component of the vehicle, given by its name; the only one of its kind need not be named.
It begins at a flight time, or a while after a mission phase was entered, and lasts, unless its kind knows a
duration.  It acts between the
actuators and the plant: :func:`inflict` runs after the commands of a base cycle have reached the valves and
before the plant moves.

Left out: intermittent faults, and valves that fail between open and shut.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import Params, param, section
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.interface.capacities import MAX_FAULTS
from edl6dof.jit import kernel
from edl6dof.vehicle.faults.component import COMPONENTS, Component, Components
from edl6dof.vehicle.faults.registry import FaultChoice, components_of, inflict_kind
from edl6dof.vehicle.plant import NOT_BEGUN


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


class FaultParams(FaultChoice):
    """One fault."""

    thruster: str | None = param(None, "name of the thruster that fails, where one does", record=False)
    branch: str | None = param(None, "name of the propellant branch that fails, where one does", record=False)
    rcs: str | None = param(None, "name of the thruster set, where all of it fails", record=False)
    surface: str | None = param(None, "name of the surface that fails, where one does", record=False)
    engine: str | None = param(None, "name of the engine that fails, where one does", record=False)
    parachute: str | None = param(None, "name of the parachute that fails, where one does", record=False)
    tank: str | None = param(None, "name of the tank that fails, where one does", record=False)
    gyro: str | None = param(None, "name of the gyro that fails, where one does", record=False)
    accelerometer: str | None = param(
        None, "name of the accelerometer that fails, where one does", record=False
    )
    inertial_unit: str | None = param(None, "name of the inertial unit, where it fails", record=False)
    beam: str | None = param(None, "name of the radar beam that fails, where one does", record=False)
    star_tracker: str | None = param(None, "name of the star tracker, where it fails", record=False)
    flow_meter: str | None = param(
        None, "name of the branch whose flow meter fails, where one does", record=False
    )
    landing_camera: str | None = param(None, "name of the landing camera, where it fails", record=False)
    lidar: str | None = param(None, "name of the lidar, where it fails", record=False)
    stereo: str | None = param(None, "name of the stereo cameras, where they fail", record=False)
    at: FaultStart = section("when it begins", record=False)

    @model_validator(mode="after")
    def _names_its_component(self) -> FaultParams:
        about = components_of(self.kind)
        named = [name for name in COMPONENTS if getattr(self, name) is not None]
        if not set(named) <= set(about) or len(named) > 1:
            given = ", ".join(f"{name} {getattr(self, name)!r}" for name in named)
            raise ValueError(f"{self.kind} is about one {' or '.join(about)} and nothing else (got {given})")
        if not named and len(about) > 1:
            raise ValueError(f"{self.kind} must name one {' or '.join(about)}")
        return self

    @property
    def component(self) -> Component:
        """Kind of component that the fault is about."""
        about = components_of(self.kind)
        return next((name for name in about if getattr(self, name) is not None), about[0])

    def acts_on(self, components: Components) -> str:
        """Name of the component that a checked fault acts on, of those there are."""
        name: str | None = getattr(self, self.component)
        return name or components[self.component][0]

    def label(self, components: Components) -> str:
        """Short name: ``D7 stuck off``, ``main engine shortfall``."""
        return f"{self.acts_on(components)} {self.kind.replace('_', ' ')}"


FAULT = np.dtype(
    [
        ("of", "i8"),  # kind of component, index in COMPONENTS
        ("component", "i8"),  # index of the one that fails among those of its kind
        ("phase", "i8"),  # index of the mission phase, -1 for a flight time
        ("after", "f8"),  # s after the start of the phase, or flight time
        ("params", dtype_of(FaultParams)),
    ],
    align=True,
)
FAULTS = np.dtype([("count", "i8"), ("slots", FAULT, (MAX_FAULTS,))], align=True)


def fault_problems(
    faults: Sequence[FaultParams], components: Components, phases: Sequence[str]
) -> dict[str, str]:
    """Components and phases that do not exist or are not named, by dotted key."""
    problems: dict[str, str] = {}
    for index, fault in enumerate(faults):
        kind, names = fault.component, components.get(fault.component, ())
        given, allowed = getattr(fault, kind), ", ".join(names) or "none"
        if given is None and len(names) != 1:
            problems[f"faults.{index}"] = f"{fault.kind} must name its {kind}; names: {allowed}"
        elif given is not None and given not in names:
            problems[f"faults.{index}.{kind}"] = f"no {kind} named {given!r}; names: {allowed}"
        if fault.at.phase is not None and fault.at.phase not in phases:
            problems[f"faults.{index}.at.phase"] = (
                f"no phase named {fault.at.phase!r}; names: {', '.join(phases) or 'none'}"
            )
    return problems


def fill_faults(
    record: np.void, faults: Sequence[FaultParams], components: Components, phases: Sequence[str]
) -> None:
    """Write checked faults into a ``FAULTS`` record, names turned into indices."""
    record["count"] = len(faults)
    for slot, fault in zip(record["slots"], faults, strict=False):
        slot["of"] = COMPONENTS.index(fault.component)
        slot["component"] = components[fault.component].index(fault.acts_on(components))
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
            inflict_kind(
                fault.params.kind, fault, case, since=plant.fault_since[i], command=command, plant=plant
            )
