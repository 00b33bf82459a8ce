"""Changes of a scenario as the texts that ``--set`` takes, or as plain data."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

#: Texts ``"dotted.path=value"``; or data by dotted path, or nested as in a scenario file.
Overrides = Iterable[str] | Mapping[str, Any]


def texts(overrides: Overrides) -> tuple[str, ...]:
    """Changes as texts ``dotted.path=value``.

    >>> texts({"wind": {"gust.enabled": True}, "seed": 3})
    ('wind={"gust.enabled": true}', 'seed=3')
    >>> texts({"wind": {"gust": {"enabled": True}}})
    ('wind.gust.enabled=true',)

    Raises:
        TypeError: a value is neither a number, a text, true or false, nothing, nor lists or mappings of
            them.
    """
    if isinstance(overrides, str):
        raise TypeError(f"overrides are a list of texts or a mapping; write [{overrides!r}]")
    if isinstance(overrides, Mapping):
        return tuple(f"{path}={_text(value)}" for path, value in _leaves(overrides))
    return tuple(overrides)


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


def _text(value: Any) -> str:
    """A value as JSON, which is YAML."""
    return json.dumps(value, default=_plain, allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"{value!r} cannot stand in a scenario")
