"""Families of interchangeable models, such as guidance laws.

A member is one file with its parameter model, its memory layout and its kernels; one line in the family's
tuple adds it.  YAML chooses it by name, which becomes an integer in the records.  Compiled code calls the
member of that integer (:meth:`Family.switch`), or a flight passes it as a function (:meth:`Family.role`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from typing import Any, Literal, NamedTuple

import numpy as np
from numba import types
from pydantic import create_model

from edl6dof.config.base import Params, group, param
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.kernels.functions import Given, Passed, choice, function_type
from edl6dof.records import record

EMPTY_MEMORY = record(("unused", "f8"))

#: Members from outside the package by title of their family, and titles of the families that exist.
_joined: dict[str, list[Member]] = {}
_built: set[str] = set()


def join(title: str, member: Member) -> None:
    """Add a member from outside the package to a family that is not built yet."""
    _joined.setdefault(title, []).append(member)


def is_built(title: str) -> bool:
    """Return True if the family of this title exists, so that no member can be added to it."""
    return title in _built


@dataclass(frozen=True)
class Member:
    """One model of a family.

    Attributes:
        name: its name in YAML.
        params: its parameter model; the YAML section has the same name.
        kernels: compiled functions by role; the family decides the roles and signatures.
        source: paper or report it implements.
        memory: record layout of its memory between calls.
        tables: record layout of the tables that are computed for it on the ground.
        plan: fills the tables before a flight of the member; the family decides the arguments.
        writes: fields that it fills in a record shared by the members of its family.
        reads: fields that it needs of a record that members of another family fill.
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


@dataclass(frozen=True, eq=False)
class Family:
    """All interchangeable models of one kind."""

    title: str
    members: tuple[Member, ...]

    def __post_init__(self) -> None:
        """Add the members from outside the package."""
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
        """Parameter model with a section for each member of this process, and the choice of one unless
        ``choice`` is ``None``.

        A section may be left out; one that must hold something is then ``None``.  With ``bare`` a member
        without parameters has no section.
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

    def switch(self, role: str, *arguments: str, own: Collection[str] = ()) -> Callable[..., Any]:
        """Function ``f(index, *arguments)`` that calls the ``role`` kernel of member ``index``, from Python
        and from kernels: every member is compiled with the caller.  ``own`` as for :meth:`role`.
        """
        return self.role(role, *arguments, own=own).of(frozenset(range(len(self.members))))

    def role(self, role: str, *arguments: str, own: Collection[str] = ()) -> Role:
        """The ``role`` kernels of the members that a flight carries, as one function of an index and
        ``arguments`` that is passed to the loop.

        ``own``: those of the arguments that hold a section for each member; a member is passed its section.
        """
        return Role(self, role, arguments, own)


class Role(NamedTuple):
    """Kernels of one role of a family's members; the attributes are those of :meth:`Family.role`."""

    family: Family
    role: str
    arguments: tuple[str, ...]
    own: Collection[str] = ()

    def __call__(self, index: int, *given: Any) -> Any:
        """Call the kernel of member ``index`` from Python."""
        return self.of(frozenset((index,)))(index, *given)

    def of(self, indices: frozenset[int]) -> Any:
        """Kernel that calls one of these members by its index; without any index, the first member."""
        return _choice_of(self, indices or frozenset((0,)))

    def passed(self, section: str) -> list[str]:
        """Source of the arguments for the member with this section: of those in ``own`` only its section."""
        return [f"{name}['{section}']" if name in self.own else name for name in self.arguments]


@cache
def _choice_of(role: Role, indices: frozenset[int]) -> Any:
    """Kernel that calls one of these members."""
    family = role.family
    names = {index: family.members[index].name for index in sorted(indices)}
    label = f"{role.role}_of_{sha256(repr((family.title, names)).encode()).hexdigest()[:12]}"
    kernels = {index: family.members[index].kernels[role.role] for index in names}
    return choice(label, kernels, role.arguments, {index: role.passed(name) for index, name in names.items()})


class Place(NamedTuple):
    """Place in the loop that receives members of a family as a function.

    Attributes:
        role: role of the kernels.
        type: type of the function.
        path: path in a record to the index of the member, if a flight has one.
    """

    role: Role
    type: Passed
    path: tuple[str, ...] = ()

    def function(self, carried: Collection[int]) -> Given:
        """Return the function that the loop receives for the members with these indices."""
        return Given(self.role.of(frozenset(carried)), self.type)

    def compile(self, names: Collection[str]) -> None:
        """Compile the members with these names."""
        known = self.role.family.names
        found = frozenset(index for index, name in enumerate(known) if name in names)
        for indices in map(frozenset, [[one] for one in found]) if self.path else [found]:
            self.function(indices).compile()


def place(
    title: str, role: Role, path: tuple[str, ...], returns: types.Type, *arguments: types.Type
) -> Place:
    """Return the place whose function takes a member's index and the role's arguments, of these types."""
    names = "index", *role.arguments
    return Place(role, function_type(title, names, returns, types.int64, *arguments), path)
