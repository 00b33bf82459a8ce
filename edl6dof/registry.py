"""Families of interchangeable models: guidance laws, attitude controllers.

A member is one file with its parameter model, its memory layout and its kernels.  It joins a family by one
line in the family's tuple.  YAML chooses it by name; the name becomes an integer in the records.  Compiled
code calls the member of that integer through :meth:`Family.switch`, or a flight passes it as a function
(:meth:`Family.role`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np
from numba import types
from pydantic import create_model

from edl6dof.config.base import Params, group, param
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.kernels.functions import adapted, static

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

    def switch(self, role: str, *arguments: str) -> Callable[..., Any]:
        """Function ``f(index, *arguments)`` that calls the ``role`` kernel of member ``index``, from Python
        and from kernels: every member is compiled with the caller.

        Of the arguments named in ``OWN``, which hold a section for each member, a member gets its own alone.
        """
        kernels = [member.kernels[role] for member in self.members]
        return static(kernels, arguments, [_own(name, arguments) for name in self.names])

    def role(self, role: str, *arguments: str) -> Role:
        """The ``role`` kernels of the members, to be passed to the loop as functions of ``arguments``.

        Of the arguments named in ``OWN``, which hold a section for each member, a member gets its own alone.
        """
        return Role(self, role, arguments)


class Role:
    """Kernels of one role of a family's members; a flight passes those that it carries to the loop."""

    def __init__(self, family: Family, role: str, arguments: tuple[str, ...]) -> None:
        self.family, self.role, self.arguments = family, role, arguments
        self._functions: dict[int, Any] = {}

    def __call__(self, index: int, *given: Any) -> Any:
        """Call the kernel of member ``index`` from Python."""
        return self.function(index)(*given)

    def function(self, index: int) -> Any:
        """The kernel of member ``index`` as a function of the role's arguments."""
        if index not in self._functions:
            member = self.family.members[index]
            passed = _own(member.name, self.arguments)
            name = f"{self.role}_of_{member.name}"
            self._functions[index] = adapted(member.kernels[self.role], name, self.arguments, passed)
        return self._functions[index]


class Place(NamedTuple):
    """Where the loop is given members of a family.

    Attributes:
        role: which kernel of them.
        type: of the function, or of a tuple of functions by index of the member.
        path: in a record, to the index of the member, where a flight has one.
    """

    role: Role
    type: types.FunctionType | types.UniTuple
    path: tuple[str, ...] = ()

    def functions(self, carried: Collection[int]) -> Any:
        """What the loop is given for members of these indices.  In a tuple, members that are not carried
        stand for one that is.

        Raises:
            ValueError: the family has more members than the tuple has places.
        """
        if not isinstance(self.type, types.UniTuple):
            (index,) = carried
            return self.role.function(index)
        first = min(carried, default=0)
        if max(carried, default=0) >= self.type.count:
            raise ValueError(f"there may be {self.type.count} members of {self.role.family.title} at most")
        return tuple(self.role.function(i if i in carried else first) for i in range(self.type.count))

    def compile(self, names: Collection[str]) -> None:
        """Compile the members of these names."""
        kind = self.type.dtype if isinstance(self.type, types.UniTuple) else self.type
        for index, name in enumerate(self.role.family.names):
            if name in names:
                self.role.function(index).compile(kind.signature)


def _own(section: str, arguments: Sequence[str]) -> list[str]:
    """What a member is passed for the arguments of its family."""
    return [f"{name}['{section}']" if name in OWN else name for name in arguments]
