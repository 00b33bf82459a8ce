"""A DAVE-ML model as read: its variables, formulas and tables, and their values in the file's own units.

Source: ANSI/AIAA S-119-2011 and the DAVE-ML 2.0 reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.config.errors import ConfigError
from edl6dof.interchange.xmlfile import line_of, local_name, refused, text_of

if TYPE_CHECKING:
    from lxml.etree import _Element

#: Arithmetic of MathML: the function, and the least and the largest number of its arguments.
OPERATORS: dict[str, tuple[Callable[..., float], int, int]] = {
    "plus": (lambda *a: math.fsum(a), 1, 99),
    "times": (lambda *a: math.prod(a), 1, 99),
    "minus": (lambda a, b=None: -a if b is None else a - b, 1, 2),
    "divide": (lambda a, b: a / b, 2, 2),
    "power": (lambda a, b: a**b, 2, 2),
    "abs": (abs, 1, 1),
}

#: Unit of DAVE-ML to (kind, factor to SI).
UNITS: dict[str, tuple[str, float]] = {
    "nd": ("number", 1.0), "": ("number", 1.0), "_rad": ("number", 1.0), "_deg": ("number", 180.0 / math.pi),
    "m": ("length", 1.0), "ft": ("length", 0.3048), "m2": ("area", 1.0), "ft2": ("area", 0.3048**2),
    "kg": ("mass", 1.0), "lbm": ("mass", 0.45359237), "slug": ("mass", 0.45359237 * 9.80665 / 0.3048),
    "kgm2": ("inertia", 1.0), "slugft2": ("inertia", 0.45359237 * 9.80665 * 0.3048),
    "rad": ("angle", 1.0), "deg": ("angle", math.pi / 180.0), "rad_s": ("rate", 1.0), "deg_s": ("rate",
    math.pi / 180.0),
    "m_s": ("speed", 1.0), "ft_s": ("speed", 0.3048),
}  # fmt: skip


@dataclass(frozen=True)
class Variable:
    """One ``variableDef``; ``formula`` is its MathML root, if it has one."""

    id: str
    name: str
    units: str
    line: int
    value: float | None
    low: float
    high: float
    is_input: bool
    formula: _Element | None


@dataclass(frozen=True)
class Function:
    """One ``function``: a table over the variables ``inputs``, values shaped like the axes."""

    line: int
    inputs: tuple[str, ...]
    axes: tuple[np.ndarray, ...]
    values: np.ndarray


@dataclass
class Model:
    """The content of one file."""

    path: Path
    variables: dict[str, Variable] = field(default_factory=dict)
    functions: dict[str, Function] = field(default_factory=dict)

    def named(self, name: str) -> Variable | None:
        """The variable of a standard name."""
        return next((variable for variable in self.variables.values() if variable.name == name), None)

    def inputs_of(self, identifier: str, seen: tuple[str, ...] = ()) -> set[str]:
        """Variables without a value of their own that a variable depends on."""
        variable = self.variables[identifier]
        if identifier in seen:
            raise self.error(variable.line, f"variable {identifier!r} depends on itself", variable.name)
        if identifier in self.functions:
            parts: set[str] = set(self.functions[identifier].inputs)
        elif variable.formula is not None:
            parts = {text_of(ci) for ci in variable.formula.iter("{*}ci")}
        else:
            return set() if variable.value is not None and not variable.is_input else {identifier}
        return set().union(*(self.inputs_of(part, (*seen, identifier)) for part in parts))

    def evaluate(self, identifier: str, given: Mapping[str, float] | None = None) -> float:
        """Value of a variable in the file's own units; ``given`` holds inputs by variable identifier."""
        given = given or {}
        variable = self.variables[identifier]
        if identifier in given:
            value = given[identifier]
        elif identifier in self.functions:
            table = self.functions[identifier]
            value = interpolate(table, [self.evaluate(name, given) for name in table.inputs])
        elif variable.formula is not None:
            value = self._formula(variable, variable.formula, given)
        elif variable.value is not None:
            value = variable.value
        else:
            raise self.error(
                variable.line, "has neither initialValue nor calculation nor function", variable.name
            )
        return min(max(value, variable.low), variable.high)

    def _formula(self, variable: Variable, node: _Element, given: Mapping[str, float]) -> float:
        kind = local_name(node)
        if kind == "ci":
            return self.evaluate(text_of(node), given)
        if kind == "cn":
            return float(text_of(node))
        operator, *arguments = node
        try:
            return float(
                OPERATORS[local_name(operator)][0](
                    *(self._formula(variable, item, given) for item in arguments)
                )
            )
        except (ArithmeticError, ValueError, TypeError) as error:
            raise self.error(line_of(node), f"cannot be calculated: {error}", variable.name) from None

    def error(self, line: int, message: str, name: str = "") -> ConfigError:
        """An error at a line of this file."""
        return refused(self.path, line, message, name=name)


def interpolate(table: Function, point: Sequence[float]) -> float:
    """Linear in every direction, held beyond the ends."""
    values = table.values
    for axis, x in zip(table.axes, point, strict=True):
        i = int(np.clip(np.searchsorted(axis, x, side="right") - 1, 0, max(len(axis) - 2, 0)))
        if len(axis) == 1:
            values = values[0]
            continue
        share = float(np.clip((x - axis[i]) / (axis[i + 1] - axis[i]), 0.0, 1.0))
        values = values[i] + share * (values[i + 1] - values[i])
    return float(values)
