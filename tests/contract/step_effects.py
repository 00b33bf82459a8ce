"""Records that a kernel writes, by itself or by the kernels that it calls, from the syntax of its source."""

import ast
import inspect
import textwrap
from functools import cache

from edl6dof.fsw.functions import PLACES
from edl6dof.fsw.hazard.detection import detect_hazards

#: Records whose fields count one by one: the memories of the flight software, the signals of a module.
DIVIDED = ("fsw", "signals")


def callees(name, scope):
    """Functions that a kernel calls by a name, each with the names of its arguments."""
    if name in PLACES:  # those of all members
        role = PLACES[name].role
        names = ("index", *role.arguments)
        return [(member.kernels[role.role].py_func, names) for member in role.family.members]
    called = detect_hazards if name == "detect_hazards" else scope.get(name)
    called = getattr(called, "py_func", called)
    return [(called, arguments(called))] if inspect.isfunction(called) else []


def arguments(function):
    """Names of the arguments of a function."""
    return tuple(inspect.signature(function).parameters)


@cache
def body(function):
    """Syntax tree of a function, node by node in the order of its statements."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    return [node for statement in tree.body for node in ast.walk(statement)]


def record_of(node, known):
    """Record that an expression is part of, by the names ``known`` for records; none for another one."""
    field = None
    while isinstance(node, ast.Subscript | ast.Attribute):
        field, node = getattr(node, "attr", field), node.value
    record = known.get(node.id) if isinstance(node, ast.Name) else None
    return f"{record}.{field}" if record in DIVIDED and field else record


def names_of_records(function):
    """Names for records in a function, and the fields of the named tuples that it fills with them."""
    known, fields = {name: name for name in arguments(function)}, {}
    for node in body(function):
        for target in node.targets if isinstance(node, ast.Assign) else ():
            names, values = (getattr(side, "elts", [side]) for side in (target, node.value))
            for name, value in zip(names, values, strict=False):
                if isinstance(name, ast.Name) and isinstance(value, ast.Call):
                    fields |= {f"{name.id}.{one.arg}": one.value for one in value.keywords}
                elif isinstance(name, ast.Name):
                    known[name.id] = record_of(value, known)
    return known, {field: record_of(value, known) for field, value in fields.items()}


def calls(function):
    """Calls of other functions in one: name, function called, and what stands for each of its arguments."""
    for node in body(function):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            for called, names in callees(node.func.id, function.__globals__):
                given = dict(zip(names, node.args, strict=False))
                yield node.func.id, called, given | {one.arg: one.value for one in node.keywords}


def written_by_calls(function):
    """Each call of another function in one, and a record of the first that it writes."""
    known, fields = names_of_records(function)
    for name, called, given in calls(function):
        for argument, _, field in (record.partition(".") for record in written(called)):
            value = given[argument]
            if field and isinstance(value, ast.Name) and f"{value.id}.{field}" in fields:
                yield name, fields[f"{value.id}.{field}"]
            else:
                record = record_of(value, known)
                yield name, f"{record}.{field}" if record and field else record


def stored(function):
    """Records that a function writes by itself."""
    known, _ = names_of_records(function)
    parts = (node for node in body(function) if isinstance(node, ast.Subscript | ast.Attribute))
    return {record_of(node, known) for node in parts if isinstance(node.ctx, ast.Store)} - {None}


@cache
def written(function):
    """Arguments that a function writes, by itself or by its calls; of divided records the fields."""
    return stored(function) | {record for _, record in written_by_calls(function)} - {None}


def unused(function):
    """Arguments of a function that it does not look at."""
    loaded = {node.id for node in body(function) if isinstance(node, ast.Name)}
    return set(arguments(function)) - loaded
