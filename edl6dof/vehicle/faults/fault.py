"""Faults of the true vehicle: kind, component and start.  The flight computer gets no notice of them.

A fault acts on one component of the vehicle, given by its name; the only one of its kind need not be named.
It begins at a flight time, or a while after a mission phase was entered, and lasts to the end of the flight
or for a duration.  An intermittent fault is present in some of the intervals of this time, at random (a loose
contact).  It acts between the actuators and the plant:
:func:`edl6dof.vehicle.actuate.inflict` runs after the commands of a base cycle have reached the valves and
before the plant moves.

A kind of fault is a member of :data:`FAULT_KINDS`: its parameters derive from the fault of a component
(:mod:`edl6dof.vehicle.faults.component`), which declares the components that may break and, of thrusters, how
they fail.  Its kernel ``inflict(fault, case, since, command, plant)`` runs in every base cycle in which the
fault is present; ``since`` (s) is the time at which it began, and ``fault.component`` the index of the
component among those of its kind.  Before each of these cycles the effects of the last one are cleared, so a
fault whose kernel no longer runs has ended.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydantic import create_model, model_validator

from edl6dof.config.base import REQUIRED, Params, param, section
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.environment.profiles import FAULT_STREAM
from edl6dof.interface.capacities import MAX_FAULTS
from edl6dof.records import record
from edl6dof.registry import Family
from edl6dof.spatial.random_numbers import Stream
from edl6dof.vehicle.faults import actuators, instrument
from edl6dof.vehicle.faults.component import COMPONENTS, Component, ComponentFault, Components

FAULT_KINDS = Family("fault kind", (*actuators.MEMBERS, *instrument.MEMBERS))


def about(kind: str) -> type[ComponentFault]:
    """Parameter model of a kind of fault; it declares the kinds of component that can have the fault."""
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


_named: dict[str, Any] = {
    name: (str | None, param(None, f"name of the {name.replace('_', ' ')}, where one fails", record=False))
    for name in COMPONENTS
}
_NamedComponent: Any = create_model("_NamedComponent", __base__=FaultChoice, **_named)


class FaultParams(_NamedComponent):
    """One fault."""

    at: FaultStart = section("when it begins", record=False)
    duration_s: float | None = param(
        None,
        "time from its beginning to its end; left out: 1 s of gyros_saturated, others last to the end of the "
        "flight",
        record=False,
        gt=0.0,
    )
    presence: float = param(
        1.0, "probability with which it is present in an interval; below 1: intermittent", gt=0.0, le=1.0
    )
    interval_s: float = param(
        0.1, "length of the intervals of an intermittent fault; it is present in the first", ge=0.001, le=1e4
    )

    @model_validator(mode="after")
    def _may_end(self) -> FaultParams:
        if not about(self.kind).ends and (self.duration_s is not None or self.presence < 1.0):
            raise ValueError(f"{self.kind} cannot end: leave out duration_s and presence")
        return self

    @model_validator(mode="after")
    def _names_its_component(self) -> FaultParams:
        allowed = about(self.kind).components
        named, one_of = [name for name in COMPONENTS if getattr(self, name) is not None], " or ".join(allowed)
        if not set(named) <= set(allowed) or len(named) > 1:
            given = ", ".join(f"{name} {getattr(self, name)!r}" for name in named)
            raise ValueError(f"{self.kind} is about one {one_of} and nothing else (got {given})")
        if not named and len(allowed) > 1:
            raise ValueError(f"{self.kind} must name one {one_of}")
        return self

    @property
    def component(self) -> Component:
        """Kind of component that the fault acts on."""
        allowed = about(self.kind).components
        return next((name for name in allowed if getattr(self, name) is not None), allowed[0])

    @property
    def lasts_s(self) -> float:
        """Time from its beginning to its end, s; infinite if it lasts to the end of the flight."""
        return self.duration_s or about(self.kind).usual_duration_s

    def acts_on(self, components: Components) -> str:
        """Name of the component that a checked fault acts on; ``components``: names by kind."""
        name: str | None = getattr(self, self.component)
        return name or components[self.component][0]

    def label(self, components: Components) -> str:
        """Short name: ``D7 stuck off``, ``main engine shortfall``."""
        return f"{self.acts_on(components)} {self.kind.replace('_', ' ')}"


FAULT = record(
    ("of", "i8"),  # kind of component, index in COMPONENTS
    ("component", "i8"),  # index of the one that fails among those of its kind
    ("phase", "i8"),  # index of the mission phase, -1 for a flight time
    ("after", "f8"),  # s after the start of the phase, or flight time
    ("duration", "f8"),  # s; infinite: to the end of the flight
    ("key", "i8"),  # of the random numbers of an intermittent fault
    ("params", dtype_of(FaultParams)),
)
FAULTS = record(("count", "i8"), ("slots", FAULT, (MAX_FAULTS,)))


def fault_problems(
    faults: Sequence[FaultParams], components: Components, phases: Sequence[str]
) -> dict[str, str]:
    """Problems of faults with a wrong or missing component or phase: messages by dotted key."""
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
    record: np.void,
    faults: Sequence[FaultParams],
    components: Components,
    phases: Sequence[str],
    seed: tuple[int, int],
) -> None:
    """Write checked faults into a ``FAULTS`` record, names turned into indices; ``seed``: seed and number of
    the case, to which the random numbers of intermittent faults belong.
    """
    record["count"] = len(faults)
    if faults:
        record["slots"]["key"] = Stream(*seed, FAULT_STREAM).keys(MAX_FAULTS)
    for slot, fault in zip(record["slots"], faults, strict=False):
        slot["of"] = COMPONENTS.index(fault.component)
        slot["component"] = components[fault.component].index(fault.acts_on(components))
        slot["phase"] = phases.index(fault.at.phase) if fault.at.phase is not None else -1
        slot["after"] = fault.at.plus_s if fault.at.phase is not None else fault.at.time_s
        slot["duration"] = fault.lasts_s
        fill(slot["params"], fault)
