"""Calls of one kernel among several, chosen by an index, and of a kernel that is compiled on its own.

A static choice is compiled whole with its caller: for the small kernels in the equations of motion.  A lazy
one is compiled kernel by kernel, each when it is first called (:mod:`edl6dof.lazy_calls`): for whatever a
flight can do without.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import update_wrapper
from typing import Any

from numba import types
from numba.extending import overload

from edl6dof.lazy_calls import LazyCall

#: What a kernel returns that is called lazily: nothing, or a number.
NOTHING, NUMBER = types.none, types.float64


def numbers(*shape: int) -> types.Type:
    """What a kernel returns that is called lazily: a tuple of so many numbers, or of so many such tuples."""
    return types.UniTuple(numbers(*shape[1:]), shape[0]) if shape else NUMBER


@dataclass(frozen=True)
class Choice:
    """Kernels of which an index chooses one.

    Attributes:
        name: of the choice, unique.
        kernels: by index.
        arguments: names of what they are given.
        own: names of the arguments that hold a section for each kernel, of which it gets its own alone.
        sections: names of those sections by index.
        alone: whether there is one kernel and no index.
    """

    name: str
    kernels: Sequence[Callable[..., Any]]
    arguments: Sequence[str]
    own: Sequence[str] = ()
    sections: Sequence[str] = ()
    alone: bool = False

    def call(self, index: int) -> str:
        """Source text of the call of one kernel."""
        given = (f"{name}['{self.sections[index]}']" if name in self.own else name for name in self.arguments)
        return f"f{index}({', '.join(given)})"


def static(choice: Choice) -> Callable[..., Any]:
    """Function ``f(index, *arguments)`` that calls kernel ``index``, from Python and from kernels."""
    chain = _chain(choice)
    return _function(choice, chain, chain)


def lazy(choice: Choice, returns: types.Type) -> Callable[..., Any]:
    """As :func:`static`, of kernels that are compiled when they are first called, and return ``returns``."""
    own = [name in choice.own for name in choice.arguments]
    scope = {"call": LazyCall(choice.name, choice.kernels, choice.sections, own, returns).intrinsic()}
    arguments = ", ".join(choice.arguments)
    index, parameters = ("0" if choice.alone else "index"), _parameters(choice)
    exec(f"def by_address({parameters}): return call({index}, ({arguments},))", scope)
    by_address: Callable[..., Any] = scope["by_address"]
    return _function(choice, _chain(choice), by_address)


def on_its_own(returns: types.Type) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorator of a kernel that is compiled when it is first called and not with its callers, and that
    returns ``returns``.
    """

    def decorate(kernel: Callable[..., Any]) -> Callable[..., Any]:
        name, arguments = f"{kernel.__module__}.{kernel.__name__}", inspect.signature(kernel).parameters
        return update_wrapper(lazy(Choice(name, (kernel,), tuple(arguments), alone=True), returns), kernel)

    return decorate


def _parameters(choice: Choice) -> str:
    return ", ".join([*(() if choice.alone else ("index",)), *choice.arguments])


def _chain(choice: Choice) -> Callable[..., Any]:
    """Function that calls the kernel of an index.

    numba cannot index a tuple of functions, so the if-chain is written out once, at compile time, by
    ``overload``; callers stay cacheable (measured: same speed as a hand-written chain).
    """
    lines = [f"def chain({_parameters(choice)}):"]
    for i in range(1, len(choice.kernels)):
        lines += [f"    if index == {i}:", f"        return {choice.call(i)}"]
    lines.append(f"    return {choice.call(0)}")
    scope: dict[str, Any] = {f"f{i}": kernel for i, kernel in enumerate(choice.kernels)}
    exec("\n".join(lines), scope)
    chain: Callable[..., Any] = scope["chain"]
    return chain


def _function(choice: Choice, chain: Callable[..., Any], compiled: Callable[..., Any]) -> Callable[..., Any]:
    """The function, which calls ``chain`` from Python, and ``compiled`` from kernels."""
    scope: dict[str, Any] = {"chain": chain, "compiled": compiled}
    exec(f"def function({_parameters(choice)}): return chain({_parameters(choice)})", scope)
    exec(f"def choose({_parameters(choice)}): return compiled", scope)
    overload(scope["function"])(scope["choose"])
    function: Callable[..., Any] = scope["function"]
    return function
