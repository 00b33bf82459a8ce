"""Errors in the words of Python: what is wrong is an argument here, and no option that somebody typed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from edl6dof.config.errors import ConfigError

P = ParamSpec("P")
R = TypeVar("R")


@contextmanager
def told_in_python(**names: str) -> Iterator[None]:
    """Name arguments, and not options, as the place of a mistake: ``overrides`` and ``cases`` for ``--set
    PATH=VALUE`` and ``--cases``.

    Args:
        names: arguments that are not called as their option is: that of ``--at`` by ``at="at_s"``.
    """
    try:
        yield
    except ConfigError as error:
        error.problems = tuple(replace(one, file=argument(one.file, names)) for one in error.problems)
        error.args = (error.problems,)
        raise


def in_python(**names: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """A function whose errors are told so; the arguments are those of :func:`told_in_python`."""

    def decorated(function: Callable[P, R]) -> Callable[P, R]:
        @wraps(function)
        def inner(*args: P.args, **options: P.kwargs) -> R:
            with told_in_python(**names):
                return function(*args, **options)

        return inner

    return decorated


def argument(place: str, names: dict[str, str]) -> str:
    """The argument that an option is; another place as it is.

    >>> argument("--set seed=x", {}), argument("--at", {"at": "at_s"}), argument("my.yaml", {})
    ('overrides', 'at_s', 'my.yaml')
    """
    if not place.startswith("--"):
        return place
    option = place.partition(" ")[0]
    if option == "--set":
        return "overrides"
    words = [word.removeprefix("--").replace("-", "_") for word in place.split(", ")]
    return ", ".join(names.get(word, word) for word in words)


def scenario_name(given: Any) -> str:
    """A scenario as it was named.

    Raises:
        TypeError: it is neither a name nor a path.
    """
    from os import PathLike, fspath

    if isinstance(given, str | PathLike):
        return str(fspath(given))
    raise TypeError(f"a scenario is a file or a name, such as 'tianwen1' (got {given!r})")
