"""Arguments of a caller: scenarios by name, changes of them, and errors that name the caller's arguments."""

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
    """Import a library of an extra; the extra has the name of the library, or the name ``extra``.

    Raises:
        ImportError: the library is not installed; the message names ``caller`` and the installation command.
    """
    try:
        return import_module(name)
    except ImportError:
        raise ImportError(f"{caller} needs {name}: pip install 'edl6dof[{extra or name}]'") from None


#: True if the caller is the command line, whose user has typed options.
_OPTIONS = ContextVar("options", default=False)


@contextmanager
def naming_options() -> Iterator[None]:
    """Let errors inside the block name options, because the caller is the command line."""
    token = _OPTIONS.set(True)
    try:
        yield
    finally:
        _OPTIONS.reset(token)


@contextmanager
def naming_arguments(**names: str) -> Iterator[None]:
    """Let errors name arguments instead of options: ``overrides`` and ``cases`` for ``--set PATH=VALUE`` and
    ``--cases``.  Also a decorator.

    Args:
        names: arguments whose names differ from those of their options: ``at="at_s"`` for ``--at``.
    """
    try:
        yield
    except ConfigError as error:
        if not _OPTIONS.get():
            error.problems = tuple(replace(one, file=argument(one.file, names)) for one in error.problems)
            error.args = (error.problems,)
        raise


def argument(place: str, names: dict[str, str]) -> str:
    """Return the argument that corresponds to an option; return any other place unchanged.

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


#: Texts ``"dotted.path=value"``; or data by dotted path, or nested as in a scenario file.
Overrides = Iterable[str] | Mapping[str, Any]


def texts(overrides: Overrides) -> tuple[str, ...]:
    """Return changes as texts ``dotted.path=value``.

    >>> texts({"wind": {"gust.enabled": True}, "seed": 3})
    ('wind={"gust.enabled": true}', 'seed=3')
    >>> texts({"wind": {"gust": {"enabled": True}}})
    ('wind.gust.enabled=true',)

    Raises:
        TypeError: the changes are neither texts nor a mapping; or a value is not a number, a text, a path, a
            truth value, ``None``, or a list or mapping of these.
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


def named(scenario: Any, overrides: Overrides = ()) -> tuple[str, tuple[str, ...]]:
    """Return name and changes of a scenario: of a :class:`edl6dof.Scenario`, its own changes come first.

    Raises:
        TypeError: the scenario is none of these, or the changes are of a wrong kind.
    """
    if isinstance(scenario, str | PathLike):
        return str(fspath(scenario)), texts(overrides)
    if hasattr(scenario, "overrides"):
        return scenario.source, (*scenario.overrides, *texts(overrides))
    raise TypeError(
        f"a scenario is a file or a name, such as 'tianwen1', or edl6dof.Scenario (got {scenario!r})"
    )


def listed(names: str | float | Iterable[str | float]) -> str:
    """Return names or times as a text with commas."""
    return str(names) if isinstance(names, str | float | int) else ",".join(map(str, names))


def _leaves(data: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield values by dotted path; a mapping that is empty or has dotted keys, as ``truth``, is one value."""
    for key, value in data.items():
        path = f"{above}{key}"
        if isinstance(value, Mapping) and value and not any("." in str(inner) for inner in value):
            yield from _leaves(value, f"{path}.")
        else:
            yield path, value


def _text(path: str, value: Any) -> str:
    """Return a value as JSON, which is valid YAML."""
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
