"""What a calibration found, as a scenario file that extends the one it began with."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from edl6dof.config.document.extends import EXTENDS
from edl6dof.config.document.scalars import write_scalar


def overlay_text(name: str, extended: str, values: Mapping[str, float], claims: Mapping[str, str]) -> str:
    """YAML text: ``extends``, a name, and each value at its dotted path with what is claimed of it.

    Args:
        name: of the new scenario.
        extended: scenario that it extends, by name or path.
        values: by dotted path; a path may name items of lists, but no element of a list of numbers.
        claims: comment of each value, by dotted path.
    """
    tree: dict[str, Any] = {}
    for path, value in values.items():
        *parents, key = path.split(".")
        inside = tree
        for parent in parents:
            inside = inside.setdefault(parent, {})
        inside[key] = (value, claims[path])
    lines = [f"{EXTENDS}: {write_scalar(extended)}", f"name: {write_scalar(name)}", *_lines(tree, "")]
    return "\n".join(lines) + "\n"


def _lines(tree: Mapping[str, Any], pad: str) -> Iterator[str]:
    for key, inside in tree.items():
        if isinstance(inside, dict):
            yield f"{pad}{write_scalar(key)}:"
            yield from _lines(inside, pad + "  ")
        else:
            value, claim = inside
            yield f"{pad}{write_scalar(key)}: {write_scalar(value)}  # {claim}"
