"""Rules over the package's own source text: which module may import which, and what a kernel may be given."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import edl6dof

PACKAGE = Path(edl6dof.__file__).parent

#: Layers from the bottom up (design.md, section 3); a module imports its own layer or lower ones.
LAYERS = (
    (
        "kernels",
        "child",
        "durable",
        "records",
        "__version__",
    ),
    ("config", "manifest", "registry", "plugins"),
    ("spatial",),
    ("interface",),
    ("interchange",),
    ("environment",),
    ("vehicle",),
    ("sensors",),
    ("fsw",),
    ("telemetry",),
    ("metrics",),
    ("scenario",),
    ("sim",),
    ("runs", "export"),
    ("campaign",),
    ("calibration", "design"),
    ("report", "replay"),
    ("verify", "missions"),
    ("api", "gym", "serve", "studies", "cli", "__init__", "__main__"),
)
HEIGHT = {name: height for height, names in enumerate(LAYERS) for name in names}


def modules(*folders: str) -> list[tuple[str, str]]:
    """Dotted name and source of every module, of the whole package or of some folders."""
    return [(name, source) for name, source in _everything() if not folders or name.split(".")[1] in folders]


@cache
def _everything() -> list[tuple[str, str]]:
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        found.append((".".join(("edl6dof", *parts)), path.read_text(encoding="utf-8")))
    return found


def breaches(rule: Callable[[str, str], Any], sources: list[tuple[str, str]]) -> dict[str, Any]:
    """What a rule of a module's name and source finds, by module; modules that keep it are left out."""
    return {name: found for name, source in sources if (found := rule(name, source))}


@cache
def parsed(source: str) -> ast.Module:
    """A source's syntax tree, read once for all rules."""
    return ast.parse(source)


@cache
def nodes(source: str) -> tuple[ast.AST, ...]:
    """Every node of that tree, which is walked once for all rules."""
    return tuple(ast.walk(parsed(source)))


def imports(source: str, module: str = "edl6dof.x.y") -> Iterator[tuple[int, str]]:
    """Line and absolute dotted name of everything a source imports, wherever the statement stands."""
    for node in nodes(source):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parents = module.split(".")[: -node.level]
                base = ".".join([*parents, base] if base else parents)
            yield node.lineno, base
            yield from ((node.lineno, f"{base}.{alias.name}") for alias in node.names)
        elif isinstance(node, ast.Call) and _called(node) in ("import_module", "__import__"):
            yield from (
                (node.lineno, str(name.value)) for name in node.args[:1] if isinstance(name, ast.Constant)
            )


def rings(sources: list[tuple[str, str]]) -> list[tuple[str, ...]]:
    """Modules that import each other, wherever the statements stand: each ring once, by name."""
    known = {name.removesuffix(".__init__") for name, _ in sources} - {"edl6dof"}
    graph = {
        name.removesuffix(".__init__"): {target for _, target in imports(source, name) if target in known}
        for name, source in sources
    }
    reached = {name: _reached(graph, name) for name in known}
    found = {
        tuple(sorted(other for other in reached[name] if name in reached[other]))
        for name in known
        if name in reached[name]
    }
    return sorted(ring for ring in found if len(ring) > 1)


def _reached(graph: dict[str, set[str]], start: str) -> set[str]:
    """Modules that one imports, by way of others too."""
    found: set[str] = set()
    waiting = [start]
    while waiting:
        new = graph[waiting.pop()] - found
        found |= new
        waiting += new
    return found


def _called(node: ast.Call) -> str:
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def forbidden_imports(source: str, prefixes: tuple[str, ...], module: str = "edl6dof.x.y") -> list[str]:
    """``line: name`` of the imports that begin with one of ``prefixes``."""
    return sorted({f"{line}: {name}" for line, name in imports(source, module) if _within(name, prefixes)})


def _within(name: str, prefixes: tuple[str, ...]) -> bool:
    return any(name == prefix or name.startswith(prefix + ".") for prefix in prefixes)


def forbidden_parameters(source: str, names: tuple[str, ...]) -> list[str]:
    """``line: function(parameter)`` of functions that take a parameter of one of ``names``."""
    found = []
    for node in nodes(source):
        if isinstance(node, ast.FunctionDef | ast.Lambda | ast.AsyncFunctionDef):
            label = getattr(node, "name", "lambda")
            found += [f"{node.lineno}: {label}({a.arg})" for a in _parameters(node) if a.arg in names]
    return found


def untyped(source: str) -> list[str]:
    """``line: function(parameter)`` of what has no type, ``return`` included; a kernel is compiled for the
    types that it meets.
    """
    found = []
    for node in nodes(source):
        if isinstance(node, ast.FunctionDef) and not is_kernel(node):
            names = [
                a.arg for a in _parameters(node) if a.annotation is None and a.arg not in ("self", "cls")
            ]
            if node.returns is None and node.name != "__init__":
                names.append("return")
            found += [f"{node.lineno}: {node.name}({name})" for name in names]
    return found


def _parameters(function: ast.FunctionDef | ast.Lambda | ast.AsyncFunctionDef) -> list[ast.arg]:
    every = function.args
    packed = filter(None, (every.vararg, every.kwarg))
    return [*every.posonlyargs, *every.args, *every.kwonlyargs, *packed]


def has_kernels(source: str) -> bool:
    """Whether a source defines a compiled function."""
    return any(isinstance(node, ast.FunctionDef) and is_kernel(node) for node in nodes(source))


def is_kernel(function: ast.FunctionDef) -> bool:
    """Whether a function is compiled."""
    return any(
        getattr(mark, "id", getattr(mark, "attr", "")) in ("kernel", "inlined_kernel", "njit", "jit")
        for mark in function.decorator_list
    )


#: Methods and functions that take a text apart.
PARSING = (
    "startswith",
    "endswith",
    "removeprefix",
    "removesuffix",
    "split",
    "rsplit",
    "partition",
    "rpartition",
    "find",
    "index",
)
PARSING += ("search", "match", "fullmatch", "findall", "finditer", "sub")


def parsed_prose(source: str) -> list[str]:
    """``line: text`` of calls that take the key, name or detail of an event, or the words of an outcome,
    apart.
    """
    found = []
    for node in nodes(source):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in PARSING:
            found += [
                f"{node.lineno}: {ast.unparse(node)}"
                for part in (node.func.value, *node.args)
                if any(map(_prose, ast.walk(part)))
            ]
        elif isinstance(node, ast.Compare) and any(isinstance(way, ast.In | ast.NotIn) for way in node.ops):
            found += [
                f"{node.lineno}: {ast.unparse(node)}"
                for part in node.comparators
                if any(map(_prose, ast.walk(part)))
            ]
    return sorted(set(found))


def _prose(node: ast.AST) -> bool:
    if isinstance(node, ast.Attribute):
        return node.attr == "outcome"
    if not (isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant)):
        return False
    of_event = isinstance(node.value, ast.Name) and node.value.id in ("event", "e", "one", "moment")
    return node.slice.value == "outcome" or (of_event and node.slice.value in ("key", "name", "detail"))


def layer_of(module: str) -> str:
    """Second part of a dotted name: the folder or top file that decides the layer."""
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else "__init__"


def upward_imports(module: str, source: str) -> list[str]:
    """``module:line imports name`` where the imported layer lies above the importing one."""
    mine = HEIGHT[layer_of(module)]
    found = []
    for line, name in imports(source, module):
        if name == "edl6dof":
            continue
        if name.startswith("edl6dof.") and HEIGHT.get(layer_of(name), HEIGHT["cli"]) > mine:
            found.append(f"{module}:{line} imports {name}")
    return sorted(set(found))


#: Calls that make a whole number of a float: what is not a number becomes one that lies outside every table.
WHOLE = (
    "int",
    "round",
    "floor",
    "ceil",
    "trunc",
    "rint",
    "int32",
    "int64",
    "intp",
    "uint8",
    "uint32",
    "uint64",
    "astype",
    "searchsorted",
)


def whole_numbers_in_kernels(source: str) -> list[str]:
    """``line: kernel calls name`` of what compiled functions make whole numbers with."""
    return [
        f"{call.lineno}: {function.name} calls {_called(call)}"
        for function in nodes(source)
        if isinstance(function, ast.FunctionDef) and is_kernel(function)
        for call in ast.walk(function)
        if isinstance(call, ast.Call) and _called(call) in WHOLE
    ]


def whole_number_names(source: str) -> set[str]:
    """Names to which a module assigns whole numbers when it is loaded: one, several, or a ``range``."""
    found = set()
    for node in _at_load(parsed(source).body):
        targets = (
            node.targets
            if isinstance(node, ast.Assign)
            else [node.target]
            if isinstance(node, ast.AnnAssign)
            else []
        )
        if targets and node.value is not None and _is_whole(node.value):
            found |= {
                name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)
            }
    return found


def _at_load(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """Statements outside functions and classes, those under conditions too."""
    for node in body:
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node
            for part in ("body", "orelse", "handlers", "finalbody"):
                yield from _at_load(getattr(node, part, []))


def _is_whole(value: ast.expr) -> bool:
    if isinstance(value, ast.Tuple | ast.List):
        return bool(value.elts) and all(_is_whole(item) for item in value.elts)
    if isinstance(value, ast.Call):
        return _called(value) == "range"
    return isinstance(value, ast.Constant) and type(value.value) is int


def lists_of(source: str, names: tuple[str, ...]) -> list[int]:
    """Lines on which exactly these names are written out, in whatever order, as a tuple, list, set or
    ``Literal``.
    """
    if not all(name in source for name in names):
        return []
    return [
        node.lineno
        for node in nodes(source)
        if isinstance(node, ast.Tuple | ast.List | ast.Set)
        and len(node.elts) == len(names)
        and {getattr(item, "value", None) for item in node.elts if isinstance(item, ast.Constant)}
        == set(names)
    ]


def fields_without_meaning(source: str) -> list[str]:
    """Fields of the records of a module on whose line no comment stands."""
    lines = source.splitlines()
    fields = [
        item
        for node in nodes(source)
        if isinstance(node, ast.Call)
        and _called(node) == "dtype"
        and node.args
        and isinstance(node.args[0], ast.List)
        for item in node.args[0].elts
    ]
    return [
        ast.literal_eval(field.elts[0])
        for field in fields
        if "#" not in lines[field.lineno - 1][field.end_col_offset :]
    ]
