"""Aerodynamics of a DAVE-ML model on a grid of Mach number, angle of attack and sideslip, with its damping.

The model gives forces along the axes of B, or drag, lift and side force; and moments.  Its other inputs, such
as deflections, are given.  The grid is refined between the nodes of the model, to follow effects that are not
linear between them (a total angle, the square of sideslip).
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from pathlib import Path
from typing import NamedTuple

import numpy as np

from edl6dof.interchange.daveml import read_daveml
from edl6dof.interchange.daveml_model import UNITS, Model, Number, Variable
from edl6dof.spatial import arrays

DRAG, LIFT = "totalCoefficientOfDrag", "totalCoefficientOfLift"
FORCES = tuple(f"aeroBodyForceCoefficient_{axis}" for axis in "XYZ")
MOMENTS = tuple(f"aeroBodyMomentCoefficient_{axis}" for axis in ("Roll", "Pitch", "Yaw"))
SPEED, MACH, ALPHA, BETA = "trueAirspeed", "mach", "angleOfAttack", "angleOfSideslip"
RATES = tuple(f"bodyAngularRate_{axis}" for axis in ("Roll", "Pitch", "Yaw"))
FLOW = (SPEED, MACH, ALPHA, BETA, *RATES)
#: Names of the reference area, and of the lengths of pitch and of roll and yaw.
AREAS = ("referenceWingArea", "referenceArea")
CHORDS = ("referenceWingChord", "longitudinalReferenceLength", "referenceLength")
SPANS = ("referenceWingSpan", "lateralReferenceLength", "lateralReferencelength", "referenceLength")

#: Airspeed (m/s) and rate (rad/s) at which damping is read off, and the ends of a range without nodes (rad).
_V, _RATE = 100.0, 0.5
_AROUND = {ALPHA: pi, BETA: 0.5 * pi}
_EVEN = {ALPHA: 81, BETA: 41}
#: Columns of (CX, CY, CZ, Cl, Cm, Cn) that each rate may change.
_DAMPED = ((1, 3, 5), (0, 2, 4), (1, 3, 5))


class Sampled(NamedTuple):
    """Nodes (angles in rad), ``static`` [Mach, alpha, beta, (CX, CY, CZ, Cl, Cm, Cn)] and ``damping``
    [Mach, alpha, 9] as ``BODY_TABLE`` has them.
    """

    mach: np.ndarray
    alpha: np.ndarray
    beta: np.ndarray
    static: np.ndarray
    damping: np.ndarray


def sampled_model(
    path: Path, inputs: Mapping[str, float], most: tuple[int, int, int], points: int
) -> Sampled:
    """The aerodynamics of a model with its other ``inputs`` given, on at most ``most`` nodes of each axis and
    ``points`` in all.

    Raises:
        ConfigError: the model cannot be read, lacks a coefficient, or depends on an input that is not given.
    """
    model = read_daveml(path)
    given = settings(model, inputs, FLOW)
    nodes = [_nodes(model, name) for name in (MACH, ALPHA, BETA)]
    spare = max(1, int(min(0.5 * most[1] / len(nodes[1]), 0.5 * most[2] / len(nodes[2]))))
    while spare > 1 and len(nodes[0]) * (spare * len(nodes[1])) * (spare * len(nodes[2])) > points:
        spare -= 1
    mach, alpha, beta = nodes[0], _refined(nodes[1], spare), _refined(nodes[2], spare)
    at = {MACH: mach[:, None, None], ALPHA: alpha[:, None], BETA: beta}
    static = _at(model, given, {**at, SPEED: _V})
    return Sampled(mach, alpha, beta, static, _damping(model, given, mach, alpha, beta))


def settings(model: Model, inputs: Mapping[str, float], flow: tuple[str, ...]) -> dict[str, float]:
    """Values of the inputs of a model other than ``flow``, by identifier and in its units.

    Raises:
        ConfigError: an input is not given.
    """
    given = {found.id: x for name, x in inputs.items() if (found := model.named(name)) is not None}
    for output in _outputs(model).values():
        for identifier in sorted(model.inputs_of(output.id)):
            variable = model.variables[identifier]
            if variable.name in flow or identifier in given:
                continue
            if variable.value is None:
                words = (
                    f"is not given: write it under vehicle.daveml_inputs, in {variable.units or 'no unit'}"
                )
                raise model.error(variable.line, words, variable.name)
            given[identifier] = variable.value
    return given


def is_sampled(model: Model) -> bool:
    """Return whether a model has more than constants, or than drag, lift and pitching moment over Mach number
    and angle of attack, and so needs the grid.
    """
    outputs = _outputs(model).values()
    names = {model.variables[i].name for output in outputs for i in model.inputs_of(output.id)}
    forces = model.named(FORCES[0]) is not None or model.named(FORCES[2]) is not None
    return forces or BETA in names or bool(names - set(FLOW))


def factor(model: Model, variable: Variable, kind: str) -> float:
    """Factor to SI of the unit of a variable of a kind."""
    found, value = UNITS.get(variable.units, ("", 0.0))
    if found != kind:
        allowed = ", ".join(unit for unit, (of, _) in UNITS.items() if of == kind and unit)
        words = f"unit {variable.units!r} is not one of {kind} (known: {allowed})"
        raise model.error(variable.line, words, variable.name)
    return value


def _outputs(model: Model) -> dict[str, Variable]:
    """The coefficients that a model has, by standard name."""
    names = (DRAG, LIFT, *FORCES, *MOMENTS)
    return {name: found for name in names if (found := model.named(name)) is not None}


def _nodes(model: Model, name: str) -> np.ndarray:
    """Nodes of a quantity (angles in rad): those of tables over it, or over variables that depend on it."""
    variable = model.named(name)
    scale = 1.0 if variable is None or name == MACH else factor(model, variable, "angle")
    found: set[float] = set()
    for function in model.functions.values():
        for identifier, axis in zip(function.inputs, function.axes, strict=True):
            if variable is not None and variable.id in ({identifier} | model.inputs_of(identifier)):
                values = np.round(axis * scale, 12)
                # of an absolute value or a total angle the other sign as well
                found.update(values if identifier == variable.id else np.concatenate((-values, values)))
    if name == MACH:
        return np.array(sorted(found)) if len(found) > 1 else np.array([0.0, 1.0])
    if len(found) < 2:
        return np.linspace(-_AROUND[name], _AROUND[name], _EVEN[name])
    return np.array(sorted(found | {0.0}))


def _refined(nodes: np.ndarray, parts: int) -> np.ndarray:
    """The nodes, and ``parts`` - 1 more between each two."""
    steps = nodes[:-1, None] + np.diff(nodes)[:, None] * np.arange(parts) / parts
    return np.append(steps.ravel(), nodes[-1])


def _at(model: Model, given: Mapping[str, float], flow: Mapping[str, Number]) -> np.ndarray:
    """(CX, CY, CZ, Cl, Cm, Cn) along a last axis, at values in SI units that broadcast."""
    shape = np.broadcast_shapes(*(np.shape(value) for value in flow.values()))
    values: dict[str, Number] = dict(given)
    kinds = {SPEED: "speed", ALPHA: "angle", BETA: "angle", MACH: "number"} | dict.fromkeys(RATES, "rate")
    for name in FLOW:
        if (variable := model.named(name)) is not None:
            many = np.broadcast_to(np.asarray(flow.get(name, 0.0)), shape).ravel()
            values[variable.id] = many / factor(model, variable, kinds[name])
    outputs = _outputs(model)

    def value(name: str) -> np.ndarray:
        if name not in outputs:
            return np.zeros(shape)
        found = model.values(outputs[name].id, values) * factor(model, outputs[name], "number")
        return np.broadcast_to(found, (int(np.prod(shape)),)).reshape(shape)

    alpha = np.broadcast_to(np.asarray(flow.get(ALPHA, 0.0)), shape)
    if FORCES[0] in outputs or FORCES[2] in outputs:
        forces = [value(name) for name in FORCES]
    elif DRAG in outputs:
        drag, lift = value(DRAG), value(LIFT)
        c, s = arrays.cos(alpha), arrays.sin(alpha)
        forces = [lift * s - drag * c, value(FORCES[1]), -lift * c - drag * s]
    else:
        raise model.error(1, f"lacks {DRAG} and {LIFT}, and {FORCES[0]} and {FORCES[2]}")
    return np.stack((*forces, *(value(name) for name in MOMENTS)), axis=-1)


def _damping(
    model: Model, given: Mapping[str, float], mach: np.ndarray, alpha: np.ndarray, beta: np.ndarray
) -> np.ndarray:
    """Damping coefficients [Mach, alpha, 9] at zero sideslip, checked against those of other states."""
    at = {MACH: mach[:, None], ALPHA: alpha}
    still = _at(model, given, {**at, SPEED: _V})
    found = np.zeros((*still.shape[:2], 9))
    spans, chords = length_of(model, SPANS), length_of(model, CHORDS)
    for k, (rate, columns) in enumerate(zip(RATES, _DAMPED, strict=True)):
        length = (spans, chords, spans)[k]
        change = _at(model, given, {**at, SPEED: _V, rate: _RATE}) - still
        if np.any(np.delete(change, columns, axis=-1) != 0.0):
            raise model.error(1, f"a force or moment that {rate} does not usually make is not supported")
        fast = {**at, BETA: 0.5 * beta[-1], SPEED: 2.0 * _V}
        again = _at(model, given, {**fast, rate: 3.0 * _RATE}) - _at(model, given, fast)
        if np.max(np.abs(again - 1.5 * change)) > 1e-9 * max(1.0, float(np.max(np.abs(change)))):
            words = (
                "must be linear in its rate times length over speed, and the same at all angles of sideslip"
            )
            raise model.error(1, f"damping by {rate} {words}")
        if not np.any(change):
            continue
        if length is None:
            raise model.error(1, f"damping by {rate} needs a reference length to be made dimensionless")
        found[..., 3 * k : 3 * k + 3] = change[..., columns] * 2.0 * _V / (_RATE * length)
    return found


def length_of(model: Model, names: tuple[str, ...]) -> float | None:
    """Reference length (m) by one of ``names``, ``None`` if the model has none of these."""
    variable = next((found for name in names if (found := model.named(name)) is not None), None)
    return None if variable is None else model.evaluate(variable.id) * factor(model, variable, "length")
