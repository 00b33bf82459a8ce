"""Reading of DAVE-ML models (AIAA S-119): constants, simple arithmetic and gridded tables.

Read: ``variableDef`` with ``initialValue``, limits and MathML ``calculation`` (arithmetic, elementary
functions, comparisons and ``piecewise``), ``breakpointDef``, ``griddedTableDef`` and ``function`` with linear
interpolation, held beyond its ends.  Everything else that would change a value is refused with file and line.
Descriptions, provenance and uncertainty change no value and are ignored; check data must be met.

Source: ANSI/AIAA S-119-2011 and the DAVE-ML 2.0 reference; the last breakpoint of a table varies fastest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from edl6dof.config.errors import ConfigError
from edl6dof.interchange.daveml_model import (
    OPERATORS,
    Function,
    Model,
    Variable,
    check_own_data,
    line_of,
    read_xml,
    refused,
    text_of,
)

_IGNORED = {
    *("fileHeader", "description", "provenance", "provenanceRef", "uncertainty", "modificationRef"),
}
_MARKS = {"isInput", "isControl", "isDisturbance", "isState", "isStateDeriv", "isOutput", "isStdAIAA"}


def read_daveml(path: Path) -> Model:
    """Read a file.

    Raises:
        ConfigError: the file is no DAVE-ML, uses an unsupported element, or fails its own check data; with
            file, line and element.
    """
    root = read_xml(path)
    if root.tag != "DAVEfunc":
        raise refused(path, line_of(root), f"is not a DAVE-ML file: its root is <{root.tag}>, not <DAVEfunc>")
    model, reader = Model(path), _Reader(path)
    for element in root:
        kind = element.tag
        if kind == "variableDef":
            variable = reader.variable(element)
            if variable.id in model.variables:
                raise refused(path, variable.line, f"variable {variable.id!r} is defined twice")
            model.variables[variable.id] = variable
        elif kind == "breakpointDef":
            values = reader.ascending(reader.child(element, "bpVals"))
            reader.breakpoints[reader.need(element, "bpID")] = values
        elif kind == "griddedTableDef":
            reader.tables[reader.need(element, "gtID")] = reader.gridded(element)
        elif kind == "function":
            output, function = reader.function(element)
            model.functions[output] = function
        elif kind not in _IGNORED and kind != "checkData":
            raise reader.unsupported(element)
    _check_references(model)
    for check_data in root.iterfind("checkData"):
        check_own_data(model, check_data)
    return model


def _check_references(model: Model) -> None:
    for variable in model.variables.values():
        for ci in () if variable.formula is None else variable.formula.iter("ci"):
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

    def refused(self, element: Element, words: str) -> ConfigError:
        return refused(self.path, line_of(element), f"<{element.tag}> {words}")

    def unsupported(self, element: Element, words: str = "is not supported") -> ConfigError:
        text = f"constants, calculations with {', '.join(OPERATORS)}, piecewise, and gridded tables"
        return self.refused(element, f"{words} (supported are {text} with linear interpolation)")

    def need(self, element: Element, attribute: str) -> str:
        if (value := element.get(attribute)) is None:
            raise self.refused(element, f"needs the attribute {attribute!r}")
        return value.strip()

    def child(self, element: Element, name: str) -> Element:
        if (found := element.find(name)) is None:
            raise self.refused(element, f"needs a <{name}>")
        return found

    def number(self, element: Element, text: str | None) -> float:
        try:
            value = float(text or "")
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.refused(element, f"must hold a finite number (got {(text or '')[:40]!r})")
        return value

    def numbers(self, element: Element) -> np.ndarray:
        words = (element.text or "").replace(",", " ").split()
        return np.array([self.number(element, word) for word in words])

    def ascending(self, element: Element) -> np.ndarray:
        values = self.numbers(element)
        if len(values) == 0 or np.any(np.diff(values) <= 0.0):
            raise self.refused(element, "must hold ascending numbers")
        return values

    def variable(self, element: Element) -> Variable:
        formula, marks = None, set()
        for child in element:
            kind = child.tag
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

    def check_formula(self, node: Element) -> None:
        kind = node.tag
        if kind == "cn":
            self.number(node, node.text)
        elif kind == "piecewise":
            self.check_piecewise(node)
        elif kind == "apply" and len(node):
            self.check_apply(*node)
        elif kind != "ci":
            raise self.unsupported(node)

    def check_apply(self, operator: Element, *arguments: Element) -> None:
        if operator.tag == "piecewise" and not arguments:
            self.check_piecewise(operator)
            return
        if operator.tag not in OPERATORS:
            raise self.unsupported(operator)
        _, least, most = OPERATORS[operator.tag]
        if not least <= len(arguments) <= most:
            raise self.unsupported(operator, f"cannot take {len(arguments)} arguments")
        for argument in arguments:
            self.check_formula(argument)

    def check_piecewise(self, node: Element) -> None:
        """Check that each piece has a value and a condition, and that an ``otherwise`` stands last."""
        kinds = [child.tag for child in node]
        if kinds[-1:] == ["otherwise"]:
            kinds.pop()
        if set(kinds) != {"piece"}:
            raise self.refused(node, "must hold <piece>, and last perhaps <otherwise>")
        for child in node:
            wanted = 2 if child.tag == "piece" else 1
            if len(child) != wanted:
                words = "a value" if wanted == 1 else "a value and a condition"
                raise self.refused(child, f"must hold {words}")
            for part in child:
                self.check_formula(part)

    def gridded(self, element: Element) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        axes = []
        for reference in self.child(element, "breakpointRefs"):
            name = self.need(reference, "bpID")
            if name not in self.breakpoints:
                raise refused(self.path, line_of(reference), f"unknown breakpoints {name!r}")
            axes.append(self.breakpoints[name])
        return tuple(axes), self.shaped(self.child(element, "dataTable"), axes)

    def shaped(self, element: Element, axes: Sequence[np.ndarray]) -> np.ndarray:
        values, shape = self.numbers(element), tuple(map(len, axes))
        if values.size != math.prod(shape):
            words = f"holds {values.size} numbers, its breakpoints ask for {math.prod(shape)}"
            raise self.refused(element, words)
        return values.reshape(shape)

    def function(self, element: Element) -> tuple[str, Function]:
        """Output variable and table of a ``function``; its points are inside, or referred to."""
        inputs = list(self.independent(element))
        names = tuple(self.need(item, "varID") for item in inputs)
        if inputs and inputs[0].tag == "independentVarPts":
            axes = tuple(self.ascending(item) for item in inputs)
            points = self.child(element, "dependentVarPts")
            table = Function(line_of(element), names, axes, self.shaped(points, axes))
            return self.need(points, "varID"), table
        output = self.need(self.child(element, "dependentVarRef"), "varID")
        axes, values = self.table(self.child(element, "functionDefn"))
        if len(axes) != len(names):
            words = f"has {len(names)} independent variables, its table {len(axes)}"
            raise self.refused(element, words)
        for item, axis in zip(inputs, axes, strict=True):
            low, high = item.get("min"), item.get("max")
            if (low is not None and self.number(item, low) > axis[0]) or (
                high is not None and self.number(item, high) < axis[-1]
            ):
                raise self.unsupported(item, "with limits inside its breakpoints is not supported")
        return output, Function(line_of(element), names, axes, values)

    def independent(self, element: Element) -> Iterator[Element]:
        for child in element:
            kind = child.tag
            if kind in ("independentVarRef", "independentVarPts"):
                for name, known in (("interpolate", "linear"), ("extrapolate", "neither")):
                    if (given := child.get(name, known)) != known:
                        raise self.unsupported(child, f"with {name}={given!r} is not supported")
                yield child
            elif kind not in {*_IGNORED, "dependentVarRef", "dependentVarPts", "functionDefn"}:
                raise self.unsupported(child)

    def table(self, element: Element) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
        for child in element:
            kind = child.tag
            if kind == "griddedTableRef":
                if (name := self.need(child, "gtID")) not in self.tables:
                    raise refused(self.path, line_of(child), f"unknown table {name!r}")
                return self.tables[name]
            if kind in ("griddedTableDef", "griddedTable"):
                return self.gridded(child)
            if kind not in _IGNORED:
                raise self.unsupported(child)
        raise self.refused(element, "holds no table")
