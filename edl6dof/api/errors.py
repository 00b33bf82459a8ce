"""Errors in the words of the caller: arguments in Python, options on a command line, extras not installed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from importlib import import_module
from os import PathLike, fspath
from typing import Any

from edl6dof.config.errors import ConfigError


def library(name: str, caller: str, extra: str = "") -> Any:
    """The module of a library, of the extra that is called as it is, or as ``extra`` says.

    Raises:
        ImportError: it is not installed; says what ``caller`` needs and how to get it.
    """
    try:
        return import_module(name)
    except ImportError:
        raise ImportError(f"{caller} needs {name}: pip install 'edl6dof[{extra or name}]'") from None


#: Whether a command line asks, whose user has typed options.
_OPTIONS = ContextVar("options", default=False)


@contextmanager
def naming_options() -> Iterator[None]:
    """Inside the block errors name options: the caller is a command line."""
    before = _OPTIONS.set(True)
    try:
        yield
    finally:
        _OPTIONS.reset(before)


@contextmanager
def naming_arguments(**names: str) -> Iterator[None]:
    """Name arguments, and not options, as the place of a mistake: ``overrides`` and ``cases`` for ``--set
    PATH=VALUE`` and ``--cases``.  Decorates a function, too.

    Args:
        names: arguments that are not called as their option is: that of ``--at`` by ``at="at_s"``.
    """
    try:
        yield
    except ConfigError as error:
        if not _OPTIONS.get():
            error.problems = tuple(replace(one, file=argument(one.file, names)) for one in error.problems)
            error.args = (error.problems,)
        raise


def argument(place: str, names: dict[str, str]) -> str:
    """Return the argument that an option is; another place as it is.

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
    """Return a scenario as it was named.

    Raises:
        TypeError: it is neither a name nor a path.
    """
    if isinstance(given, str | PathLike):
        return str(fspath(given))
    raise TypeError(f"a scenario is a file or a name, such as 'tianwen1' (got {given!r})")
