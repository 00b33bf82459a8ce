"""Arguments of a caller: scenarios by name, changes of them, and errors in the caller's own words."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from importlib import import_module
from os import PathLike, fspath
from pathlib import PurePath
from typing import Any

from edl6dof.config.errors import ConfigError, Problem


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


#: Texts ``"dotted.path=value"``; or data by dotted path, or nested as in a scenario file.
Overrides = Iterable[str] | Mapping[str, Any]


def texts(overrides: Overrides) -> tuple[str, ...]:
    """Changes as texts ``dotted.path=value``.

    >>> texts({"wind": {"gust.enabled": True}, "seed": 3})
    ('wind={"gust.enabled": true}', 'seed=3')
    >>> texts({"wind": {"gust": {"enabled": True}}})
    ('wind.gust.enabled=true',)

    Raises:
        TypeError: they are neither; or a value is neither a number, a text, a path, true or false, nothing,
            nor lists or mappings of them.
        ConfigError: a number is not finite.
    """
    if isinstance(overrides, str):
        raise TypeError(f"overrides are a list of texts or a mapping; write [{overrides!r}]")
    if isinstance(overrides, Mapping):
        return tuple(f"{path}={_text(path, value)}" for path, value in _leaves(overrides))
    if not isinstance(overrides, Iterable):
        raise TypeError(f"overrides are a list of texts 'path=value' or a mapping (got {overrides!r})")
    found = tuple(overrides)
    for one in found:
        if not isinstance(one, str):
            raise TypeError(f"overrides are texts 'path=value', or a mapping of all of them (got {one!r})")
    return found


def _leaves(data: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Values by dotted path; a mapping that is empty or has dotted keys, as ``truth``, is one value."""
    for key, value in data.items():
        path = f"{above}{key}"
        if isinstance(value, Mapping) and value and not any("." in str(inner) for inner in value):
            yield from _leaves(value, f"{path}.")
        else:
            yield path, value


def _text(path: str, value: Any) -> str:
    """A value as JSON, which is YAML."""
    try:
        return json.dumps(value, default=_plain, allow_nan=False)
    except TypeError as error:
        raise TypeError(f"{path}: {error}") from None
    except ValueError:
        raise ConfigError([Problem("overrides", 0, 0, path, f"must be finite (got {value!r})")]) from None


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "tolist"):
        return value.tolist()  # of numpy
    if isinstance(value, PurePath):
        return str(value)
    raise TypeError(f"{value!r} cannot stand in a scenario")
