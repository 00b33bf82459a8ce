"""The planet is data: no code holds the numbers of Mars or of its gas.

Looked for are numbers of three digits or more that are no year: they can come from a planet alone, whereas a
ratio such as 7/5 stands for much else.
The check cases in ``edl6dof/verify`` bring scenes of their own, some with a planet like Mars: they are no
part of a flight.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from source_rules import breaches, modules, nodes

import edl6dof

CODE = Path(edl6dof.__file__).parent
MARS = CODE / "data" / "planets" / "mars.yaml"
MAP = CODE / "data" / "topography" / "mola_1deg_colat_lon.yaml"
#: Numbers of Mars and of carbon dioxide that other sources print, and that code once held.
PRINTED = (
    188.92,
    191.8,
    1.2857,
    1.29,
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
    """Every number of a planet file but its colours and the table of its radiation, values such as 12.5."""
    if isinstance(tree, dict):
        tree = [value for key, value in tree.items() if key not in ("appearance", "speeds")]
    for value in tree if isinstance(tree, list) else ():
        yield from numbers(value)
        if isinstance(value, float):
            yield value


def digits(value: float) -> int:
    """Significant digits that a number is written with."""
    return len(repr(value).split("e")[0].replace(".", "").strip("-0"))


def literals(source: str) -> set[float]:
    constants = (node.value for node in nodes(source) if isinstance(node, ast.Constant))
    return {float(value) for value in constants if type(value) in (int, float)}


YEARS = range(1900, 2100)
OF_FILES = [value for file in (MARS, MAP) for value in numbers(yaml.safe_load(file.read_text()))]
FORBIDDEN = {abs(value) for value in (*OF_FILES, *PRINTED) if digits(value) >= 3 and value not in YEARS}
FLYING = [(name, source) for name, source in modules() if name.split(".")[1] != "verify"]


def test_the_numbers_are_those_of_mars():
    assert {191.0, 960.2, 1.33, 3396190.0, 4.59e-10, 1.9027e-4} <= FORBIDDEN and len(FORBIDDEN) > 45
    assert set(map(abs, PRINTED)) < FORBIDDEN


@pytest.mark.parametrize("value, count", [(1.4, 2), (-3e-7, 1), (191.0, 3), (0.0158, 3), (1.9027e-4, 5)])
def test_digits_are_counted(value, count):
    assert digits(value) == count


def test_no_code_holds_the_numbers_of_mars():
    assert len(FLYING) > 300
    assert breaches(lambda _, source: literals(source) & FORBIDDEN, FLYING) == {}


@pytest.mark.parametrize(
    "number", ["3_389_500", "3396190.0", "191.0", "960.2", "1.29", "4.59e-10", "1.9027e-4"]
)
def test_a_planted_number_is_found(number):
    assert literals(f"PLANTED = -{number}  # of Mars") & FORBIDDEN
