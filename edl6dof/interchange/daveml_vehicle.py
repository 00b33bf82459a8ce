"""Vehicle data from DAVE-ML files: mass, inertia and aerodynamic coefficients, by their AIAA
S-119 standard names.

    vehicle:
      daveml: [brick_inertia.dml, brick_aero.dml]

A vehicle has three kinds of aerodynamics: a constant drag coefficient with rate damping (``aero.constant``),
tables of drag, lift and pitching moment over Mach number and angle of attack (``aero.capsule.static_table``),
and six coefficients over both angles, with other inputs of the model, such as deflections, given under
``daveml_inputs`` (``aero.body``).  The kind of a file is found by evaluating it; a file with effects beyond
its kind is refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from edl6dof.config.base import stated
from edl6dof.config.document.document import Document
from edl6dof.config.document.source import Mark
from edl6dof.config.errors import ConfigError
from edl6dof.interchange.daveml import read_daveml
from edl6dof.interchange.daveml_aero import (
    ALPHA,
    AREAS,
    CHORDS,
    DRAG,
    FLOW,
    FORCES,
    LIFT,
    MACH,
    MOMENTS,
    RATES,
    SPANS,
    SPEED,
    factor,
    is_sampled,
    length_of,
    settings,
)
from edl6dof.interchange.daveml_model import Model, Number

SIDE = FORCES[1]
ROLL, PITCH, YAW = MOMENTS
AREA, SPAN, CHORD = AREAS[0], SPANS[0], CHORDS[0]
MASS = "totalMass"
INERTIA = tuple(f"bodyMomentOfInertia_{axis}" for axis in ("Roll", "Pitch", "Yaw"))
PRODUCTS = tuple(f"bodyProductOfInertia_{axes}" for axes in ("ZX", "XY", "YZ"))
CENTRE = tuple(f"bodyPositionOfCmWrtMrc_{axis}" for axis in "XYZ")
#: Station of the centre of mass aft of the nose, in place of the first of them.
STATION = "vrsPositionOfCM_X"

_SUPPORTED = "constant drag, no lift or side force, and Cl = Clp p b/2V, Cm = Cmq q c/2V, Cn = Cnr r b/2V"

#: Airspeed (m/s) and rates p, q, r (rad/s) at which a constant model must agree with its own coefficients.
_PROBES = (
    (100.0, 0.0, 0.0, 0.0),
    (100.0, 1.0, -0.7, 0.4),
    (250.0, -0.3, 0.5, 2.0),
    (40.0, 0.9, 0.2, -1.1),
    (900.0, 0.0, -3.0, 0.0),
)


#: Values by dotted path below ``vehicle``, as in YAML, each with its place in a ``.dml`` file.
Part = dict[str, tuple[Any, Mark]]


def _put(part: Part, model: Model, line: int, values: Mapping[str, Any]) -> None:
    """Add values, which the file of a model gives in one line, to a part."""
    part.update((path, (value, Mark(str(model.path), line, 1))) for path, value in values.items())


def expand_daveml(document: Document) -> Document:
    """Copy the data of the files named under ``vehicle.daveml`` to the ``vehicle`` section, and return the
    document; a value in the YAML file has precedence.

    Raises:
        ConfigError: a file is missing or wrong, or contains a model that a vehicle cannot have.
    """
    vehicle = document.data.get("vehicle")
    if not isinstance(vehicle, dict):
        return document  # for the validation to refuse
    names = vehicle.get("daveml")
    if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
        return document  # absent, empty, or for the validation to refuse
    mark = document.mark(("vehicle", "daveml"))
    folder = Path(mark.file).parent if Path(mark.file).is_file() else Path.cwd()
    paths = [folder / name for name in names]
    for index, path in enumerate(paths):
        if not path.is_file():
            words = f"no such file (got {names[index]!r}; looked for {path})"
            raise ConfigError([document.problem(("vehicle", "daveml", index), words)])
    inputs = vehicle.get("daveml_inputs")
    numbers = inputs.values() if isinstance(inputs, dict) else ()
    if not all(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers):
        return document  # for the validation to refuse
    part = vehicle_part(paths, {str(name): float(x) for name, x in inputs.items()} if inputs else {})
    document.forget(("vehicle", "daveml"))
    vehicle["daveml"] = []
    for name, (value, place) in part.items():
        _adopt(document, ("vehicle", *name.split(".")), value, place)
    document.files += tuple(paths)
    return document


def _adopt(document: Document, keys: tuple[str, ...], value: Any, mark: Mark) -> None:
    """Put a value into the document unless the YAML file gives it."""
    node = document.data
    for depth, key in enumerate(keys[:-1], start=1):
        if key not in node:
            node[key] = {}
            document.marks[keys[:depth]] = mark
        node = node[key]
        if not isinstance(node, dict):
            return  # for the validation to refuse
    if keys[-1] not in node:
        node[keys[-1]] = value
        document.marks[keys] = mark
        document.sources[".".join(keys)] = Path(mark.file).name


def vehicle_part(paths: Iterable[Path], inputs: Mapping[str, float] | None = None) -> Part:
    """Mass properties and aerodynamics of DAVE-ML files, converted to SI units.

    Args:
        paths: the files.
        inputs: inputs of the models other than the flow, by name or identifier and in their own units.

    Raises:
        ConfigError: a file cannot be read or is beyond the models of a vehicle, or no file has such an input.
    """
    part: Part = {}
    unused, inputs = set(inputs or ()), inputs or {}
    model = None
    for path in paths:
        model = read_daveml(path)
        unused -= {name for name in unused if model.named(name) is not None}
        has_aero = model.named(DRAG) is not None or model.named(FORCES[0]) is not None
        if model.named(MASS) is not None:
            _mass(model, part, inputs)
        if has_aero:
            _aerodynamics(model, part, inputs)
        if model.named(MASS) is None and not has_aero:
            raise model.error(1, f"holds neither mass properties ({MASS}) nor aerodynamics ({DRAG})")
    if unused and model is not None:
        raise model.error(1, f"neither it nor another file has an input of this name: {sorted(unused)[0]}")
    return part


def _mass(model: Model, part: Part, inputs: Mapping[str, float]) -> None:
    mass, line = _constant(model, MASS, "mass", inputs)
    inertia = [_constant(model, name, "inertia", inputs)[0] for name in INERTIA]
    centre = [_constant(model, name, "length", inputs)[0] if model.named(name) else 0.0 for name in CENTRE]
    if model.named(CENTRE[0]) is None and model.named(STATION) is not None:
        centre[0] = -_constant(model, STATION, "length", inputs)[0]
    _put(part, model, line, {"mass.entry_kg": mass, "mass.entry_centre_m": centre})
    _put(part, model, _line(model, INERTIA[0]), {"mass.entry_inertia_kg_m2": inertia})
    zx, xy, yz = (
        _constant(model, name, "inertia", inputs)[0] if model.named(name) else 0.0 for name in PRODUCTS
    )
    if zx or xy or yz:
        _put(part, model, _line(model, PRODUCTS[0]), {"mass.entry_products_kg_m2": [xy, zx, yz]})


def _aerodynamics(model: Model, part: Part, given: Mapping[str, float]) -> None:
    if is_sampled(model):
        _body(model, part, given)
        return
    names = (DRAG, LIFT, SIDE, ROLL, PITCH, YAW)
    outputs = [variable for name in names if (variable := model.named(name)) is not None]
    inputs = {model.variables[i].name for output in outputs for i in model.inputs_of(output.id)}
    if unknown := inputs - {SPEED, MACH, ALPHA, *RATES}:
        name = sorted(unknown)[0]
        known = ", ".join((SPEED, MACH, ALPHA, *RATES))
        words = f"aerodynamics that depend on {name} are not supported (known: {known})"
        raise model.error(_line(model, name), words, name)
    if inputs & {MACH, ALPHA}:
        _table(model, part)
    else:
        _constants(model, part)


def _constants(model: Model, part: Part) -> None:
    """Constant drag and rate damping: Cl = Clp p b/2V, Cm = Cmq q c/2V, Cn = Cnr r b/2V."""
    area, line = _constant(model, AREA, "area")
    span = _constant(model, SPAN, "length")[0] if model.named(SPAN) else None
    chord = _constant(model, CHORD, "length")[0] if model.named(CHORD) else None
    drag = _probe(model, DRAG, *_PROBES[0])
    expected = {DRAG: lambda v, p, q, r: drag, LIFT: lambda v, p, q, r: 0.0, SIDE: lambda v, p, q, r: 0.0}
    damping = {}
    for axis, name, length in ((0, ROLL, span), (1, PITCH, chord), (2, YAW, span)):
        unit = [1.0 if k == axis else 0.0 for k in range(3)]
        moment = _probe(model, name, 100.0, *unit) if model.named(name) else 0.0
        if moment != 0.0 and length is None:
            words = f"needs {CHORD if axis == 1 else SPAN} to be made dimensionless"
            raise model.error(_line(model, name), words, name)
        damping[name] = moment * 200.0 / length if length else 0.0
        expected[name] = lambda v, *w, a=axis, d=damping[name], b=length: d * w[a] * (b or 0.0) / (2.0 * v)
    for name, law in expected.items():
        near = 1e-9 * max(abs(damping.get(name, 0.0)), abs(drag), 1e-3)
        for probe in _PROBES if model.named(name) else ():
            if abs(_probe(model, name, *probe) - law(*probe)) > near:
                raise model.error(_line(model, name), f"is not of a supported form: {_SUPPORTED}", name)
    line_of = {name: _line(model, name) if model.named(name) else line for name in expected}
    _put(part, model, line, {"aero.model": "constant", "aero.constant.reference_area_m2": area})
    _put(part, model, line_of[DRAG], {"aero.constant.drag_coefficient": drag})
    for key, length, name in (("span_m", span, SPAN), ("chord_m", chord, CHORD)):
        if length is not None:
            _put(part, model, _line(model, name), {f"aero.constant.{key}": length})
    for key, name in (("roll_damping", ROLL), ("pitch_damping", PITCH), ("yaw_damping", YAW)):
        _put(part, model, line_of[name], {f"aero.constant.{key}": damping[name]})


def _body(model: Model, part: Part, given: Mapping[str, float]) -> None:
    """Six coefficients over both angles: the body's table is made from the same file."""
    named = next((found for name in AREAS if (found := model.named(name)) is not None), None)
    if named is None:
        raise model.error(1, f"lacks the reference area ({' or '.join(AREAS)})")
    area, line = _constant(model, named.name, "area", {})
    settings(model, given, FLOW)
    lengths = {"chord_m": length_of(model, CHORDS), "span_m": length_of(model, SPANS)}
    values = {
        "file": str(model.path.resolve()),
        "inputs": {k: v for k, v in given.items() if model.named(k) is not None},
        "reference_area_m2": area,
        **{key: length for key, length in lengths.items() if length is not None},
    }
    _put(part, model, line, {"aero.model": "body"} | {f"aero.body.{key}": x for key, x in values.items()})


def _table(model: Model, part: Part) -> None:
    """Tables over Mach and angle of attack: the capsule's static table is read from the same file."""
    area, line = _constant(model, AREA, "area")
    static_table(model.path)
    values = {"static_table": str(model.path.resolve()), "diameter_m": 2.0 * sqrt(area / pi)}
    _put(part, model, line, {"aero.model": "capsule"} | {f"aero.capsule.{k}": x for k, x in values.items()})


def static_table(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mach numbers, angles of attack (deg) and [Mach, angle, (CD, CL, Cm)] at the breakpoints of a file.

    Raises:
        ConfigError: the coefficients depend on another variable, or one is missing.
    """
    model = read_daveml(path)
    grids: dict[str, set[float]] = {MACH: set(), ALPHA: set()}
    coefficients = []
    for name in (DRAG, LIFT, PITCH):
        if (variable := model.named(name)) is None:
            raise model.error(1, f"a table of aerodynamics needs {name}")
        inputs = {model.variables[identifier].name for identifier in model.inputs_of(variable.id)}
        if not inputs <= {MACH, ALPHA}:
            words = f"must depend on {MACH} and {ALPHA} alone (depends on {', '.join(sorted(inputs))})"
            raise model.error(variable.line, words, name)
        coefficients.append(variable)
    for function in model.functions.values():
        for identifier, axis in zip(function.inputs, function.axes, strict=True):
            variable = model.variables[identifier]
            if variable.name in grids:
                degrees = factor(model, variable, "angle") * 180.0 / pi if variable.name == ALPHA else 1.0
                grids[variable.name].update(np.round(axis * degrees, 9))
    mach, alpha = (np.array(sorted(grids[name])) for name in (MACH, ALPHA))
    if len(mach) < 2 or len(alpha) < 2:
        raise model.error(1, f"has no table over {MACH} and {ALPHA}")
    at: dict[str, Number] = {}
    for name, axis, kind in ((MACH, mach[:, None], ""), (ALPHA, alpha * pi / 180.0, "angle")):
        if (variable := model.named(name)) is not None:
            unit = factor(model, variable, kind) if kind else 1.0
            at[variable.id] = np.broadcast_to(axis, (len(mach), len(alpha))).ravel() / unit
    columns = [np.broadcast_to(model.values(one.id, at), mach.size * alpha.size) for one in coefficients]
    return mach, alpha, np.stack(columns, axis=-1).reshape(len(mach), len(alpha), 3)


def _probe(model: Model, name: str, speed: float, *rates: float) -> float:
    """A coefficient that the model has, at an airspeed (m/s) and body rates (rad/s)."""
    values = {SPEED: (speed, "speed")} | {name: (r, "rate") for name, r in zip(RATES, rates, strict=True)}
    given = {
        v.id: value / factor(model, v, kind)
        for key, (value, kind) in values.items()
        if (v := model.named(key)) is not None
    }
    variable = stated(model.named(name))
    factor(model, variable, "number")
    return model.evaluate(variable.id, given)


def _constant(
    model: Model, name: str, kind: str, inputs: Mapping[str, float] | None = None
) -> tuple[float, int]:
    """SI value and line of a variable that depends on nothing but ``inputs`` and initial values."""
    if (variable := model.named(name)) is None:
        raise model.error(1, f"lacks the variable {name}")
    own = (inputs or {}).items()
    given = {found.id: value for key, value in own if (found := model.named(key)) is not None}
    needed = model.inputs_of(variable.id) - given.keys()
    if unknown := sorted(one for one in needed if model.variables[one].value is None):
        words = f"depends on {', '.join(unknown)}: give a value under vehicle.daveml_inputs"
        raise model.error(variable.line, words, name)
    return model.evaluate(variable.id, given) * factor(model, variable, kind), variable.line


def _line(model: Model, name: str) -> int:
    variable = model.named(name)
    return variable.line if variable is not None else 1
