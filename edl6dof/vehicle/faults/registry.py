"""The kinds of fault that each of ``faults`` may name as its ``kind``.

A member's parameters derive from the fault of a component (:mod:`edl6dof.vehicle.faults.component`), and
say so what may break, of thrusters also how they fail.  Its kernel
``inflict(fault, case, since, command, plant)`` runs in every base cycle from the time ``since`` (s) at which
the fault began, after the commands have reached valves and engines and before the plant moves;
``fault.component`` is the index of the component among those of its kind.
"""

from __future__ import annotations

from edl6dof.config.base import REQUIRED
from edl6dof.interface.effectors import ThrusterFailure
from edl6dof.interface.events import Action
from edl6dof.interface.roles import Role
from edl6dof.registry import Family
from edl6dof.vehicle.faults import engine, instrument, parachute, surface, tank, thruster
from edl6dof.vehicle.faults.component import Component, ComponentFault, FailingThrusters

FAULT_KINDS = Family(
    "fault kind",
    (
        *(*thruster.MEMBERS, *surface.MEMBERS, *parachute.MEMBERS, *engine.MEMBERS, *tank.MEMBERS),
        *instrument.MEMBERS,
    ),
)


def components_of(kind: str) -> tuple[Component, ...]:
    """The kinds of component of which a kind of fault is about one."""
    return _about(kind).components


def over_after(kind: str) -> tuple[Action, ...]:
    """What is done to the component after which a kind of fault changes nothing."""
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


FaultChoice = FAULT_KINDS.params_model("FaultChoice", "kind", REQUIRED, "What breaks.")

inflict_kind = FAULT_KINDS.role("inflict", "fault", "case", "since", "command", "plant")
