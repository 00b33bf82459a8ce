"""A DAVE-ML model as read: variables, formulas and tables, their values in the units of the file, and the
check data in the file; and the reading of XML of unknown origin.

XML is read without entities, DTD, network and giant trees.  A file that declares entities is refused (they
are how XML attacks work, and no model needs them); a reference to a DTD, as in NASA's files, is allowed and
never followed.

Source: ANSI/AIAA S-119-2011 and the DAVE-ML 2.0 reference.
"""

from __future__ import annotations

import functools
import math
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

import numpy as np

from edl6dof.config.document.locate import shown
from edl6dof.config.document.regular import read_regular
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.spatial import arrays

MAX_BYTES = 5_000_000
#: Deepest nesting of elements that is read.
DEEPEST = 100

_ENTITIES = "declares XML entities, which are not allowed"


class Located(Element):
    """An element, without its namespace, and the line on which it begins."""

    line = 0


def read_xml(path: Path) -> Element:
    """Root element of an XML file.

    Raises:
        ConfigError: the file cannot be read, is no XML, or declares entities.
    """
    try:
        content = read_regular(path, MAX_BYTES)
    except OSError as error:
        raise refused(path, 0, f"cannot be read: {error.strerror or error}") from None
    tree, parser, open_tags = TreeBuilder(element_factory=Located), expat.ParserCreate(), list[str]()

    def start(tag: str, attributes: dict[str, str]) -> None:
        open_tags.append(tag.rpartition(":")[2])
        if len(open_tags) > DEEPEST:
            raise refused(path, parser.CurrentLineNumber, f"is nested more than {DEEPEST} elements deep")
        element = tree.start(open_tags[-1], attributes)
        assert isinstance(element, Located)
        element.line = parser.CurrentLineNumber

    def entity(*_: object) -> None:
        raise refused(path, parser.CurrentLineNumber, _ENTITIES)

    parser.StartElementHandler, parser.EndElementHandler = start, lambda _: tree.end(open_tags.pop())
    parser.CharacterDataHandler, parser.buffer_text = tree.data, True
    parser.EntityDeclHandler = parser.SkippedEntityHandler = entity
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        words = f"is not well-formed XML: {expat.ErrorString(error.code)}"
        raise refused(path, error.lineno, words, error.offset + 1) from None
    return tree.close()


def refused(path: Path, line: int, message: str, column: int = 1, name: str = "") -> ConfigError:
    """The error of one place in a file."""
    return ConfigError([Problem(shown(path), line, column if line else 0, name, message)])


def line_of(element: Element) -> int:
    """Line on which an element begins."""
    return getattr(element, "line", 0)


def text_of(element: Element) -> str:
    """Text of an element without blanks around it; empty when it has none."""
    return (element.text or "").strip()


#: A number, or one for each of many points.
Number = float | np.ndarray

#: Arithmetic of MathML: the function, and the least and the largest number of its arguments.
OPERATORS: dict[str, tuple[Callable[..., Any], int, int]] = {
    "plus": (lambda *a: functools.reduce(operator.add, a), 1, 99),
    "times": (lambda *a: functools.reduce(operator.mul, a), 1, 99),
    "minus": (lambda a, b=None: -a if b is None else a - b, 1, 2),
    "divide": (lambda a, b: a / b, 2, 2),
    "power": (arrays.pow, 2, 2),
    "abs": (np.abs, 1, 1),
    "root": (np.sqrt, 1, 1),
    "exp": (arrays.exp, 1, 1),
    "ln": (arrays.log, 1, 1),
    "sin": (arrays.sin, 1, 1),
    "cos": (arrays.cos, 1, 1),
    "tan": (arrays.tan, 1, 1),
    "arcsin": (arrays.asin, 1, 1),
    "arccos": (arrays.acos, 1, 1),
    "arctan": (arrays.atan, 1, 1),
    "min": (lambda *a: functools.reduce(np.minimum, a), 1, 99),
    "max": (lambda *a: functools.reduce(np.maximum, a), 1, 99),
    "lt": (np.less, 2, 2),
    "leq": (np.less_equal, 2, 2),
    "gt": (np.greater, 2, 2),
    "geq": (np.greater_equal, 2, 2),
    "eq": (np.equal, 2, 2),
    "neq": (np.not_equal, 2, 2),
    "and": (lambda *a: functools.reduce(np.logical_and, a), 2, 99),
    "or": (lambda *a: functools.reduce(np.logical_or, a), 2, 99),
    "not": (np.logical_not, 1, 1),
}

#: Unit of DAVE-ML to (kind, factor to SI).
UNITS: dict[str, tuple[str, float]] = {
    "nd": ("number", 1.0), "": ("number", 1.0), "_rad": ("number", 1.0), "_deg": ("number", 180.0 / math.pi),
    "frac": ("number", 1.0), "pct": ("number", 0.01),
    "m": ("length", 1.0), "ft": ("length", 0.3048), "m2": ("area", 1.0), "ft2": ("area", 0.3048**2),
    "kg": ("mass", 1.0), "lbm": ("mass", 0.45359237), "slug": ("mass", 0.45359237 * 9.80665 / 0.3048),
    "kgm2": ("inertia", 1.0), "slugft2": ("inertia", 0.45359237 * 9.80665 * 0.3048),
    "rad": ("angle", 1.0), "deg": ("angle", math.pi / 180.0), "rad_s": ("rate", 1.0), "deg_s": ("rate",
    math.pi / 180.0),
    "N": ("force", 1.0), "lbf": ("force", 0.45359237 * 9.80665), "sec": ("time", 1.0), "s": ("time", 1.0),
    "kg_s": ("flow", 1.0), "m_s": ("speed", 1.0), "ft_s": ("speed", 0.3048),
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
    formula: Element | None


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
        """The variable of a standard name, which some files give as its identifier."""
        own = (variable for variable in self.variables.values() if variable.name == name)
        return next(own, self.variables.get(name))

    def inputs_of(self, identifier: str, seen: tuple[str, ...] = ()) -> set[str]:
        """Variables without a value of their own that a variable depends on."""
        variable = self.variables[identifier]
        if identifier in seen:
            raise self.error(variable.line, f"variable {identifier!r} depends on itself", variable.name)
        if identifier in self.functions:
            parts: set[str] = set(self.functions[identifier].inputs)
        elif variable.formula is not None:
            parts = {text_of(ci) for ci in variable.formula.iter("ci")}
        else:
            return set() if variable.value is not None and not variable.is_input else {identifier}
        return set().union(*(self.inputs_of(part, (*seen, identifier)) for part in parts))

    def evaluate(self, identifier: str, given: Mapping[str, float] | None = None) -> float:
        """Value of a variable in the file's own units; ``given`` holds inputs by variable identifier."""
        return float(self.values(identifier, given or {}))

    def values(self, identifier: str, given: Mapping[str, Number]) -> Number:
        """Values at many points, as by :meth:`evaluate`: arrays of one length in ``given`` and in the
        result.
        """
        return self._value(identifier, given, {})

    def _value(self, identifier: str, given: Mapping[str, Number], known: dict[str, Number]) -> Number:
        if identifier in known:
            return known[identifier]
        variable, value = self.variables[identifier], None
        if identifier in given:
            value = given[identifier]
        elif identifier in self.functions:
            table = self.functions[identifier]
            value = interpolate(table, [self._value(name, given, known) for name in table.inputs])
        elif variable.formula is not None:
            with np.errstate(all="ignore"):
                value = self._formula(variable, variable.formula, given, known)
            if not np.all(np.isfinite(value)):
                raise self.error(variable.line, "cannot be calculated: it is not finite", variable.name)
        elif (value := variable.value) is None:
            words = "has neither initialValue nor calculation nor function"
            raise self.error(variable.line, words, variable.name)
        known[identifier] = np.minimum(np.maximum(value, variable.low), variable.high)
        return known[identifier]

    def _formula(
        self, variable: Variable, node: Element, given: Mapping[str, Number], known: dict[str, Number]
    ) -> Number:
        kind = node.tag
        if kind == "ci":
            return self._value(text_of(node), given, known)
        if kind == "cn":
            return float(text_of(node))
        if kind == "piecewise":
            return self._piecewise(variable, node, given, known)
        operator, *arguments = node
        if operator.tag == "piecewise":  # NASA's files put one into an apply of its own
            return self._piecewise(variable, operator, given, known)
        try:
            with_values = [self._formula(variable, item, given, known) for item in arguments]
            found: Number = OPERATORS[operator.tag][0](*with_values)
        except (ArithmeticError, ValueError, TypeError) as error:
            raise self.error(line_of(node), f"cannot be calculated: {error}", variable.name) from None
        return found

    def _piecewise(
        self, variable: Variable, node: Element, given: Mapping[str, Number], known: dict[str, Number]
    ) -> Number:
        """Value of the first piece whose condition holds, else of ``otherwise``; all pieces are evaluated."""
        pieces = [child for child in node if child.tag == "piece"]
        other = node.find("otherwise")
        found: Any = np.nan if other is None else self._formula(variable, other[0], given, known)
        for piece in reversed(pieces):
            value, holds = (self._formula(variable, part, given, known) for part in piece)
            found = np.where(holds, value, found)
        return found

    def error(self, line: int, message: str, name: str = "") -> ConfigError:
        """An error at a line of this file."""
        return refused(self.path, line, message, name=name)


def interpolate(table: Function, point: Sequence[Number]) -> Number:
    """Interpolate linearly in every direction, constant beyond the ends; at one point or at many."""
    many = np.broadcast_arrays(*(np.atleast_1d(x) for x in point))
    values = np.broadcast_to(table.values, (len(many[0]), *table.values.shape))
    rows = np.arange(len(many[0]))
    for axis, x in zip(table.axes, many, strict=True):
        if len(axis) == 1:
            values = values[:, 0]
            continue
        i = np.clip(np.searchsorted(axis, x, side="right") - 1, 0, len(axis) - 2)
        share = np.clip((x - axis[i]) / (axis[i + 1] - axis[i]), 0.0, 1.0)
        low = values[rows, i]
        values = low + share.reshape(-1, *(1 for _ in low.shape[1:])) * (values[rows, i + 1] - low)
    return values if any(np.ndim(x) for x in point) else float(values[0])


#: Share of the value (of one, where it is smaller) that counts as equal where a file gives no tolerance, a
#: choice of this software.
_DEFAULT_TOLERANCE = 1e-6


def check_own_data(model: Model, check_data: Element) -> None:
    """Evaluate each static shot of a file: inputs, and the outputs that its author computed.

    A model that does not reproduce them is damaged, or is read here in another way than its author meant.

    Source: ANSI/AIAA S-119-2011, ``checkData``; the tolerance is absolute.

    Raises:
        ConfigError: every output outside its tolerance, and every signal that is no number or not of the
        model.
    """
    problems = [problem for shot in check_data.iterfind("staticShot") for problem in _of_shot(model, shot)]
    if problems:
        raise ConfigError(problems)


def _of_shot(model: Model, shot: Element) -> Iterator[Problem]:
    given = dict(_signal(model, signal) for signal in shot.iterfind("checkInputs/signal"))
    for signal in shot.iterfind("checkOutputs/signal"):
        identifier, wanted = _signal(model, signal)
        tolerance = _number(model, signal, "tol", _DEFAULT_TOLERANCE * max(1.0, abs(wanted)))
        found = model.evaluate(identifier, given)
        if not abs(found - wanted) <= tolerance:
            message = (
                f"check case {shot.get('name', '')!r} of the file itself is not met: {found:.9g}, "
                f"not {wanted:.9g} (tolerance {tolerance:.3g})"
            )
            yield Problem(shown(model.path), line_of(signal), 1, identifier, message)


def _signal(model: Model, signal: Element) -> tuple[str, float]:
    """Variable and value of a signal, which has the identifier or the name of the variable."""
    words = [text_of(part) for tag in ("varID", "signalName") for part in signal.iterfind(tag)]
    name = words[0] if words else ""
    variable = model.named(name)
    if variable is None:
        raise refused(model.path, line_of(signal), f"check data of an unknown variable {name!r}")
    return variable.id, _number(model, signal, "signalValue", None)


def _number(model: Model, signal: Element, tag: str, default: float | None) -> float:
    part = signal.find(tag)
    if part is None and default is not None:
        return default
    try:
        return float("" if part is None else text_of(part))
    except ValueError:
        raise refused(model.path, line_of(signal), f"<signal> needs a number in <{tag}>") from None
