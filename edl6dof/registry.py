"""Families of interchangeable models: guidance laws, attitude controllers.

A member is one file with its parameter model, its memory layout and its kernels.  It joins a family by one
line in the family's tuple.  YAML chooses it by name; the name becomes an integer; compiled code dispatches on
that integer through :meth:`Family.switch`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numba import types
from pydantic import create_model

from edl6dof.config.base import Params, group, param
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.dispatch import Choice, lazy, static

EMPTY_MEMORY = np.dtype([("unused", "f8")], align=True)
#: Arguments that hold a section for each member of a family.
OWN = ("params", "plan", "unit", "memory")

#: Members from outside the package by title of their family, and the titles of the families that exist
#: already.
_joined: dict[str, list[Member]] = {}
_built: set[str] = set()


def join(title: str, member: Member) -> None:
    """Let a member from outside the package stand in a family that is still to be built."""
    _joined.setdefault(title, []).append(member)


def is_built(title: str) -> bool:
    """Whether the family of this title exists, so that nobody can join it any more."""
    return title in _built


@dataclass(frozen=True)
class Member:
    """One model of a family.

    Attributes:
        name: its name in YAML.
        params: its parameter model; the YAML section has the same name.
        kernels: compiled functions by role; the family decides the roles and signatures.
        source: paper or report it implements.
        memory: record layout of what it remembers between calls.
        tables: record layout of what is planned for it on the ground.
        plan: fills those tables, before a flight in which the member is chosen; the family decides the
            arguments.
        writes: fields it fills, where the members of a family fill one record together.
        reads: fields it needs of a record that others fill.
    """

    name: str
    params: type[Params]
    kernels: dict[str, Callable[..., Any]]
    source: str
    memory: np.dtype = field(default=EMPTY_MEMORY)
    tables: np.dtype = field(default=EMPTY_MEMORY)
    plan: Callable[..., None] | None = None
    writes: tuple[str, ...] = ()
    reads: tuple[str, ...] = ()


@dataclass(frozen=True)
class Family:
    """All members that can stand in one place."""

    title: str
    members: tuple[Member, ...]

    def __post_init__(self) -> None:
        """Take in the members from outside the package."""
        outside = [member for member in _joined.get(self.title, []) if member not in self.members]
        if taken := {member.name for member in outside} & {member.name for member in self.members}:
            message = (
                f"one {self.title} of the package is called {', '.join(sorted(taken))} already; give yours "
                "another name"
            )
            raise ConfigError([Problem("plugins", 0, 0, "", message)])
        object.__setattr__(self, "members", (*self.members, *outside))
        _built.add(self.title)

    @property
    def names(self) -> tuple[str, ...]:
        """Names that YAML may use, in registration order (the order is the integer in records)."""
        return tuple(member.name for member in self.members)

    def member(self, name: str) -> Member:
        """The member called ``name``."""
        return self.members[self.names.index(name)]

    def params_model(
        self, class_name: str, choice: str | None, default: str, doc: str, *, bare: bool = False
    ) -> Any:
        """Parameter model with one section for each member, and the choice of one unless it is made elsewhere
        (``choice`` None).

        It is made for the members of this process, plugins included, so that its type is not known before.
        A section may be left out; one that must hold something is then ``None``.  With ``bare`` a member
        without parameters has none.
        """
        fields: dict[str, Any] = {}
        if choice is not None:
            fields[choice] = (Literal[self.names], param(default, f"which {self.title} flies"))
        for member in self.members:
            own, meaning = member.params.model_fields, (member.params.__doc__ or "").strip().splitlines()[0]
            if any(info.is_required() for info in own.values()):
                fields[member.name] = (member.params | None, param(None, meaning))
            elif own or not bare:
                fields[member.name] = (member.params, group(member.params, meaning))
        return create_model(class_name, __base__=Params, __doc__=doc, **fields)

    @property
    def memory(self) -> np.dtype:
        """Record with the memory of every member."""
        return np.dtype([(member.name, member.memory) for member in self.members], align=True)

    @property
    def tables(self) -> np.dtype:
        """Record with the planned tables of every member."""
        return np.dtype([(member.name, member.tables) for member in self.members], align=True)

    def switch(self, role: str, *arguments: str, returns: types.Type | None = None) -> Callable[..., Any]:
        """Function ``f(index, *arguments)`` that calls the ``role`` kernel of member ``index``, from Python
        and from kernels.

        Of the arguments named in ``OWN``, which hold a section for each member, a member gets its own alone.
        With ``returns``, what the kernels return, a member is compiled when a flight first calls it; without,
        every member is compiled with the caller, for small kernels in the equations of motion.
        """
        kernels = [member.kernels[role] for member in self.members]
        choice = Choice(f"{self.title}: {role}", kernels, arguments, OWN, self.names)
        return static(choice) if returns is None else lazy(choice, returns)
