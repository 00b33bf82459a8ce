"""Changes of a scenario as the texts that ``--set`` takes, or as plain data."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import PurePath
from typing import Any

from edl6dof.config.errors import ConfigError, Problem

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
    """Values by dotted path; a mapping is one value where its keys are dotted paths themselves, as those of
    ``truth`` are, or where it is empty.
    """
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
