"""The planet is data: no code holds the numbers of Mars or of its gas.

The check cases in ``edl6dof/verify`` bring scenes of their own, some with a planet like Mars: they are no
part of a flight.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

import edl6dof

CODE = Path(edl6dof.__file__).parent
MARS = CODE / "data" / "planets" / "mars.yaml"
MAP = CODE / "data" / "topography" / "mola_1deg_colat_lon.yaml"
#: Numbers of Mars and of carbon dioxide that other sources print, and that code once held.
PRINTED = (
    188.92,
    191.8,
    1.2857,
    3396190.0,
    3376200.0,
    3389500.0,
    3397200.0,
    169.89,
    1.9027e-4,
    44.01,
    3.86e-10,
    9354.0,
    0.0158,
    -4099.4,
)


def numbers(tree: object) -> Iterator[float]:
    """Every number of a planet file but its colours."""
    for key, value in tree.items() if isinstance(tree, dict) else ():
        if key == "appearance":
            continue
        yield from numbers(value)
        if isinstance(value, float) and value != 0.0:
            yield value


def literals(source: str) -> set[float]:
    constants = (node.value for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Constant))
    return {float(value) for value in constants if type(value) in (int, float)}


FORBIDDEN = {abs(value) for file in (MARS, MAP) for value in numbers(yaml.safe_load(file.read_text()))} | {
    abs(v) for v in PRINTED
}


FLYING = sorted(file for file in CODE.rglob("*.py") if "verify" not in file.parts)


def test_the_numbers_are_those_of_mars():
    assert {191.0, 1.29, 1.33, 3396190.0, 4.59e-10, 1.9027e-4} <= FORBIDDEN and len(FORBIDDEN) > 15


@pytest.mark.parametrize("file", FLYING, ids=lambda file: file.relative_to(CODE).as_posix())
def test_no_code_holds_the_numbers_of_mars(file):
    assert not literals(file.read_text(encoding="utf-8")) & FORBIDDEN


def test_a_planted_number_is_found():
    assert literals("RADIUS = 3_389_500  # m") & FORBIDDEN
