"""DAVE-ML models (AIAA S-119): constants, simple arithmetic and gridded tables, evaluated as the file states
them.

Read: ``variableDef`` with ``initialValue``, limits and MathML ``calculation`` (plus, minus, times, divide,
power, abs), ``breakpointDef``, ``griddedTableDef`` and ``function`` with linear interpolation, held beyond
its ends.  Everything else that would change a value is refused with file and line.  Descriptions, provenance,
uncertainty and check data change no value and are passed over.

Source: ANSI/AIAA S-119-2011 and the DAVE-ML 2.0 reference; the last breakpoint of a table varies fastest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.config.errors import ConfigError
from edl6dof.interchange.xmlfile import line_of, local_name, read_xml, refused, text_of

if TYPE_CHECKING:
    from lxml.etree import _Element

_IGNORED = {
    "fileHeader",
    "checkData",
    "description",
    "provenance",
    "provenanceRef",
    "uncertainty",
    "modificationRef",
}
_MARKS = {"isInput", "isControl", "isDisturbance", "isState", "isStateDeriv", "isOutput", "isStdAIAA"}

_OPERATORS: dict[str, tuple[Callable[..., float], int, int]] = {
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
                _OPERATORS[local_name(operator)][0](
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


def read_daveml(path: Path) -> Model:
    """Read a file.

    Raises:
        ConfigError: it is no DAVE-ML, or holds something that is not supported; with file, line and element.
    """
    root = read_xml(path)
    if local_name(root) != "DAVEfunc":
        raise refused(
            path,
            line_of(root),
            f"is not a DAVE-ML file: its root is <{local_name(root)}>, not <DAVEfunc>",
        )
    model, reader = Model(path), _Reader(path)
    for element in root:
        kind = local_name(element)
        if kind == "variableDef":
            variable = reader.variable(element)
            if variable.id in model.variables:
                raise refused(path, variable.line, f"variable {variable.id!r} is defined twice")
            model.variables[variable.id] = variable
        elif kind == "breakpointDef":
            reader.breakpoints[reader.need(element, "bpID")] = reader.ascending(
                reader.child(element, "bpVals")
            )
        elif kind == "griddedTableDef":
            reader.tables[reader.need(element, "gtID")] = reader.gridded(element)
        elif kind == "function":
            output, function = reader.function(element)
            model.functions[output] = function
        elif kind not in _IGNORED:
            raise reader.unsupported(element)
    _check_references(model)
    return model


def _check_references(model: Model) -> None:
    for variable in model.variables.values():
        for ci in () if variable.formula is None else variable.formula.iter("{*}ci"):
            if text_of(ci) not in model.variables:
                raise model.error(line_of(ci), f"unknown variable {text_of(ci)!r}", variable.name)
    for output, function in model.functions.items():
        for name in (output, *function.inputs):
            if name not in model.variables:
                raise model.error(function.line, f"unknown variable {name!r}", "function")
    for identifier in model.variables:
        model.inputs_of(identifier)


class _Reader:
    """Reads single elements and knows the breakpoints and tables met so far."""

    def __init__(self, path: Path):
        self.path = path
        self.breakpoints: dict[str, np.ndarray] = {}
        self.tables: dict[str, tuple[tuple[np.ndarray, ...], np.ndarray]] = {}

    def unsupported(self, element: _Element, words: str = "is not supported") -> ConfigError:
        text = (
            "supported are constants, calculations with "
            + ", ".join(_OPERATORS)
            + ", and gridded tables with linear interpolation"
        )
        return refused(self.path, line_of(element), f"<{local_name(element)}> {words} ({text})")

    def need(self, element: _Element, attribute: str) -> str:
        if (value := element.get(attribute)) is None:
            raise refused(
                self.path, line_of(element), f"<{local_name(element)}> needs the attribute {attribute!r}"
            )
        return value.strip()

    def child(self, element: _Element, name: str) -> _Element:
        if (found := element.find(f"{{*}}{name}")) is None:
            raise refused(self.path, line_of(element), f"<{local_name(element)}> needs a <{name}>")
        return found

    def number(self, element: _Element, text: str | None) -> float:
        try:
            value = float(text or "")
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise refused(
                self.path,
                line_of(element),
                f"<{local_name(element)}> must hold a finite number (got {(text or '')[:40]!r})",
            )
        return value

    def numbers(self, element: _Element) -> np.ndarray:
        return np.array(
            [self.number(element, word) for word in (element.text or "").replace(",", " ").split()]
        )

    def ascending(self, element: _Element) -> np.ndarray:
        values = self.numbers(element)
        if len(values) == 0 or np.any(np.diff(values) <= 0.0):
            raise refused(self.path, line_of(element), f"<{local_name(element)}> must hold ascending numbers")
        return values

    def variable(self, element: _Element) -> Variable:
        formula, marks = None, set()
        for child in element:
            kind = local_name(child)
            if kind == "calculation":
                formula = self.child(self.child(child, "math"), "*")
                self.check_formula(formula)
            elif kind in _MARKS:
                marks.add(kind)
            elif kind not in _IGNORED:
                raise self.unsupported(child)
        value, low, high = (element.get(name) for name in ("initialValue", "minValue", "maxValue"))
        return Variable(
            self.need(element, "varID"),
            self.need(element, "name"),
            element.get("units", "").strip(),
            line_of(element),
            None if value is None else self.number(element, value),
            -math.inf if low is None else self.number(element, low),
            math.inf if high is None else self.number(element, high),
            bool(marks & {"isInput", "isControl", "isDisturbance", "isState"}),
            formula,
        )

    def check_formula(self, node: _Element) -> None:
        kind = local_name(node)
        if kind == "ci":
            return
        if kind == "cn":
            self.number(node, node.text)
            return
        if kind != "apply" or len(node) == 0:
            raise self.unsupported(node)
        operator, *arguments = node
        if local_name(operator) not in _OPERATORS:
            raise self.unsupported(operator)
        _, least, most = _OPERATORS[local_name(operator)]
        if not least <= len(arguments) <= most:
            raise self.unsupported(operator, f"cannot take {len(arguments)} arguments")
        for argument in arguments:
            self.check_formula(argument)

    def gridded(self, element: _Element) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        axes = []
        for reference in self.child(element, "breakpointRefs"):
            name = self.need(reference, "bpID")
            if name not in self.breakpoints:
                raise refused(self.path, line_of(reference), f"unknown breakpoints {name!r}")
            axes.append(self.breakpoints[name])
        return tuple(axes), self.shaped(self.child(element, "dataTable"), axes)

    def shaped(self, element: _Element, axes: Sequence[np.ndarray]) -> np.ndarray:
        values, shape = self.numbers(element), tuple(map(len, axes))
        if values.size != math.prod(shape):
            words = (
                f"<{local_name(element)}> holds {values.size} numbers, its breakpoints ask for "
                f"{math.prod(shape)}"
            )
            raise refused(self.path, line_of(element), words)
        return values.reshape(shape)

    def function(self, element: _Element) -> tuple[str, Function]:
        """Output variable and table of a ``function``, whose points stand inside it or in a table it refers
        to.
        """
        inputs = list(self.independent(element))
        names = tuple(self.need(item, "varID") for item in inputs)
        if inputs and local_name(inputs[0]) == "independentVarPts":
            axes = tuple(self.ascending(item) for item in inputs)
            points = self.child(element, "dependentVarPts")
            return self.need(points, "varID"), Function(
                line_of(element), names, axes, self.shaped(points, axes)
            )
        output = self.need(self.child(element, "dependentVarRef"), "varID")
        axes, values = self.table(self.child(element, "functionDefn"))
        if len(axes) != len(names):
            words = f"<function> has {len(names)} independent variables, its table {len(axes)}"
            raise refused(self.path, line_of(element), words)
        for item, axis in zip(inputs, axes, strict=True):
            low, high = item.get("min"), item.get("max")
            if (low is not None and self.number(item, low) > axis[0]) or (
                high is not None and self.number(item, high) < axis[-1]
            ):
                raise self.unsupported(item, "with limits inside its breakpoints is not supported")
        return output, Function(line_of(element), names, axes, values)

    def independent(self, element: _Element) -> Iterator[_Element]:
        for child in element:
            kind = local_name(child)
            if kind in ("independentVarRef", "independentVarPts"):
                if child.get("interpolate", "linear") != "linear":
                    raise self.unsupported(
                        child, f"with interpolate={child.get('interpolate')!r} is not supported"
                    )
                if child.get("extrapolate", "neither") != "neither":
                    raise self.unsupported(
                        child, f"with extrapolate={child.get('extrapolate')!r} is not supported"
                    )
                yield child
            elif kind not in {*_IGNORED, "dependentVarRef", "dependentVarPts", "functionDefn"}:
                raise self.unsupported(child)

    def table(self, element: _Element) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        for child in element:
            kind = local_name(child)
            if kind == "griddedTableRef":
                if (name := self.need(child, "gtID")) not in self.tables:
                    raise refused(self.path, line_of(child), f"unknown table {name!r}")
                return self.tables[name]
            if kind in ("griddedTableDef", "griddedTable"):
                return self.gridded(child)
            if kind not in _IGNORED:
                raise self.unsupported(child)
        raise refused(self.path, line_of(element), "<functionDefn> holds no table")
