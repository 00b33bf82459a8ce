"""Faults: what breaks, and when.  They change the true vehicle only; the flight computer has to find out.

A fault acts on one component of the vehicle, given by its name; the only one of its kind need not be named.
It begins at a flight time, or a while after a mission phase was entered, and lasts, unless its kind has a
duration.  It acts between the actuators and the plant:
:func:`edl6dof.vehicle.actuate.inflict` runs after the commands of a base cycle have reached the valves and
before the plant moves.

A kind of fault is a member of :data:`FAULT_KINDS`: its parameters derive from the fault of a component
(:mod:`edl6dof.vehicle.faults.component`), which declares the components that may break and, of thrusters, how
they fail.  Its kernel ``inflict(fault, case, since, command, plant)`` runs in every base cycle from the time
``since`` (s) at which the fault began; ``fault.component`` is the index of the component among those of its
kind.

Left out: intermittent faults, and valves that fail between open and shut.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Params, param, section
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.interface.capacities import MAX_FAULTS
from edl6dof.interface.effectors import Action, ThrusterFailure
from edl6dof.interface.roles import Role
from edl6dof.registry import Family
from edl6dof.vehicle.faults import actuators, instrument
from edl6dof.vehicle.faults.component import (
    COMPONENTS,
    Component,
    ComponentFault,
    Components,
    FailingThrusters,
)

FAULT_KINDS = Family("fault kind", (*actuators.MEMBERS, *instrument.MEMBERS))


def components_of(kind: str) -> tuple[Component, ...]:
    """The kinds of component of which a kind of fault is about one."""
    return _about(kind).components


def over_after(kind: str) -> tuple[Action, ...]:
    """Actions on the component after which a kind of fault changes nothing."""
    return _about(kind).over_after


def happens_in(kind: str) -> tuple[Role, ...]:
    """Roles of the phases in which a kind of fault happens, none if in every one."""
    return _about(kind).happens_in


def failure_of(kind: str) -> ThrusterFailure | None:
    """How the thrusters fail that a kind of fault makes fail, ``None`` if it makes none fail."""
    about = _about(kind)
    return about.failure if issubclass(about, FailingThrusters) else None


def _about(kind: str) -> type[ComponentFault]:
    params = FAULT_KINDS.member(kind).params
    assert issubclass(params, ComponentFault), f"the parameters of {kind} must derive from ComponentFault"
    return params


FaultChoice: Any = FAULT_KINDS.params_model("FaultChoice", "kind", REQUIRED, "What breaks.")

inflict_kind = FAULT_KINDS.role("inflict", "fault", "case", "since", "command", "plant")


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
