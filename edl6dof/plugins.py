"""A user's own members of a family: Python files named in the scenario, which are added before the flight
software is built.

A plugin file has the form of a member's file in the package, with one more line, the name of its family:

    FAMILY = "entry_law"                         # or reversal, powered_law, controller, estimator, ...
    MEMBER = Member("my_law", MyLawParams, {"guide": guide}, "where it comes from")

The families, their records and the compiled loop are made once in a process, so plugins are read first: the
commands that fly and ``edl6dof.load`` do that for their scenario; other programs call :func:`activate`, or
name files in ``EDL6DOF_PLUGINS``.

A plugin runs with all rights of the user.  So it runs only if the user has accepted exactly its content
(``edl6dof trust``), or it was installed with the package; where the file lies, and what names it, does not
matter.  The bytes that were checked are the bytes that run.
"""

from __future__ import annotations

import ast
import hashlib
import inspect
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from edl6dof.config.document.document import Document
from edl6dof.config.document.locate import shipped_folders, shown
from edl6dof.config.document.regular import read_regular
from edl6dof.config.document.source import parse_document
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.config.plugin_files import (
    LARGEST,
    VARIABLE,
    files_from_environment,
    files_naming_plugins,
    is_accepted,
)
from edl6dof.kernels.cache import receive
from edl6dof.registry import Member, is_built, join


class Place(NamedTuple):
    """A family that a plugin may join: its title, and for each role of a member its kernel's arguments."""

    title: str
    roles: dict[str, tuple[str, ...]]


def _place(title: str, **roles: str) -> Place:
    return Place(title, {role: tuple(arguments.split()) for role, arguments in roles.items()})


#: Names that FAMILY may have.
FAMILIES: dict[str, Place] = {
    "entry_law": _place("entry guidance law", guide="params plan onboard nav memory out"),
    "reversal": _place("bank-reversal logic", side="params onboard nav memory out wanted sign"),
    "powered_law": _place("powered guidance law", guide="params vehicle state nav target memory out"),
    "controller": _place("attitude controller", control="params nav goal inputs dt memory"),
    "allocator": _place(
        "thruster allocation",
        share_out="params shared vehicle healthy effectiveness demand memory duty unallocated",
    ),
    "estimator": _place("disturbance estimator", estimate="params measured dt memory out"),
    "hazard_detector": _place(
        "hazard detection", classify="params elevation_map footprint radius deviation out"
    ),
    "navigation_filter": _place(
        "navigation filter",
        start="params onboard sensed solution memory",
        correct="params onboard health sensed motion solution memory",
    ),
    "sensor": _place("sensor", measure="params unit case tables plant outputs memory sensed"),
    "fault_kind": _place("fault kind", inflict="fault case since command plant"),
    "atmosphere": _place("atmosphere", air="atm gas table alt"),
    "wind": _place("mean wind", mean="wind table alt"),
    "engine_model": _place(
        "engine model",
        goal="params engine t step command",
        rate="params engine goal thrust starting",
        specific_impulse="params engine thrust",
    ),
    "parachute_model": _place(
        "parachute model",
        inflation="params chute since_line_stretch",
        efficiency="params chute mach",
    ),
    "distribution": _place("distribution"),
}

#: Families whose members are compiled with the loop.
IN_LOOP = frozenset(("atmosphere", "engine_model", "parachute_model", "wind"))

#: Plugins of this process by absolute path: key of the family, and the member.
ACTIVE: dict[Path, tuple[str, Member]] = {}


class _Plugin(NamedTuple):
    """Content of a plugin file, read once: the same bytes are checked and run."""

    path: Path
    content: bytes
    document: Document | None  #: the scenario that names it; ``None`` for the environment
    installed: bool  #: came with the package


def activate(scenarios: Iterable[str | Path]) -> None:
    """Load the plugins that the scenarios (files, names, campaign folders) and the environment name.

    Raises:
        ConfigError: plugins cannot be used, come too late, or were not accepted by the user; all of them are
            named, and none has run.
    """
    named: dict[Path, Document | None] = {
        path: document for operand in scenarios for path, document in named_by(operand).items()
    }
    everywhere = {**named, **dict.fromkeys(files_from_environment())}
    new = [_read(path, document) for path, document in everywhere.items() if path not in ACTIVE]
    if refused := [plugin for plugin in new if not (plugin.installed or is_accepted(plugin.content))]:
        raise ConfigError([problem for plugin in refused for problem in _not_accepted(plugin).problems])
    for plugin in new:
        if (family := said_family(plugin.content)) in FAMILIES:
            receive(plugin.path, plugin.content, in_loop=family in IN_LOOP)
    for plugin in new:
        _load(plugin)


def named_by(operand: str | Path) -> dict[Path, Document]:
    """Absolute paths of the plugins that an operand names, each with the document that names it."""
    found: dict[Path, Document] = {}
    for file in files_naming_plugins(operand):
        document = parse_document(file.read_text(encoding="utf-8-sig", errors="replace"), shown(file))
        document.files = (file,)
        found |= dict.fromkeys(named_plugins(document), document)
    return found


def _read(path: Path, document: Document | None) -> _Plugin:
    if not path.is_file():
        raise _problem(path, document, "is no such file")
    if path.suffix != ".py":
        raise _problem(path, document, "must be a Python file (.py)")
    real = path.resolve()
    installed = any(real.is_relative_to(folder.resolve()) for folder in shipped_folders("scenarios"))
    content = plugin_content(real, lambda message: _problem(path, document, message))
    return _Plugin(path, content, document, installed)


def plugin_content(path: Path, error_of: Callable[[str], ConfigError]) -> bytes:
    """Content of a plugin file; ``error_of`` makes the error of a message.

    Raises:
        ConfigError: the file cannot be read, is no regular file, is too large for a source, or is not UTF-8.
    """
    try:
        content = read_regular(path, LARGEST)
        source_text(content)
    except UnicodeDecodeError as error:
        raise error_of("is not text in UTF-8") from error
    except OSError as error:
        raise error_of(f"cannot be read: {error.strerror or error}") from error
    return content


def source_text(content: bytes) -> str:
    """Source of a plugin as it is shown and as it runs: always UTF-8.  In a coding that the file declares,
    such as UTF-7, comments that the user reads could be code.

    Raises:
        UnicodeDecodeError: the content is not UTF-8.
    """
    return content.decode("utf-8-sig")


def _not_accepted(plugin: _Plugin) -> ConfigError:
    how = f"read and accept it: edl6dof trust {shown(plugin.path)}"
    return _problem(plugin.path, plugin.document, f"is code that would run with your rights; {how}")


def require(document: Document) -> None:
    """Check that the plugins a document names are active, and write them into it by their whole paths.

    Raises:
        ConfigError: a plugin cannot be used, or this process made its families without it.
    """
    paths = named_plugins(document)
    for path in paths:
        if path not in ACTIVE:
            message = (
                "comes too late: this process has built its flight software without it; load this scenario "
                f"first (edl6dof.load), or set {VARIABLE} to the file before Python starts"
            )
            raise _problem(path, document, message)
    if paths:
        document.data["plugins"] = [str(path) for path in paths]


def named_plugins(document: Document) -> list[Path]:
    """Absolute paths of the plugins that a document names, in the folder of the file or of one it extends;
    validation reports wrong types.
    """
    names = document.data.get("plugins") or []
    folders = [file.resolve().parent for file in document.files] or [Path.cwd()]

    def found(name: str) -> Path:
        return next((folder / name for folder in folders if (folder / name).is_file()), folders[0] / name)

    return [found(name) for name in names if isinstance(name, str)] if isinstance(names, list) else []


def _problem(path: Path, document: Document | None, message: str) -> ConfigError:
    """The error of a plugin, at the place of the scenario that names it."""
    if document is None:
        return ConfigError([Problem(VARIABLE, 0, 0, "", f"plugin {shown(path)} {message}")])
    index = named_plugins(document).index(path)
    return ConfigError([document.problem(("plugins", index), f"plugin {shown(path)} {message}")])


def _load(plugin: _Plugin) -> None:
    """Run one plugin file and let its member join its family."""
    path, document = plugin.path, plugin.document
    module = _run(plugin)
    key, member = said_family(plugin.content), module.get("MEMBER")
    if key not in FAMILIES:
        raise _problem(path, document, f"must say FAMILY = one of {', '.join(FAMILIES)} (got {key!r})")
    if not isinstance(member, Member):
        raise _problem(path, document, f"must define MEMBER = Member(...) (got {type(member).__name__})")
    title, roles = FAMILIES[key]
    if complaint := _complaint(member, roles):
        raise _problem(path, document, complaint)
    if is_built(title):
        words = f"the family of {title}s was built before it, perhaps by what it imports itself"
        raise _problem(path, document, f"comes too late: {words}")
    if any(title == FAMILIES[other].title and member.name == one.name for other, one in ACTIVE.values()):
        raise _problem(path, document, f"brings a second {title} called {member.name!r}")
    join(title, member)
    ACTIVE[path] = (key, member)


def said_family(content: bytes) -> str:
    """FAMILY of a plugin, read from its source before any of it runs; empty for none."""
    try:
        statements = ast.parse(source_text(content)).body
    except (SyntaxError, ValueError):
        return ""
    for statement in statements:
        match statement:
            case ast.Assign(targets=[ast.Name(id="FAMILY")], value=ast.Constant(value=str(said))):
                return said
    return ""


def _run(plugin: _Plugin) -> dict[str, Any]:
    """Run the checked bytes as a module, without any other file such as a ``.pyc``."""
    path = plugin.path
    # machine code contains the module's name: a moved or copied plugin keeps its name, and its code
    name = f"edl6dof_plugin_{path.stem}_{hashlib.sha256(plugin.content).hexdigest()[:8]}"
    module = ModuleType(name)
    module.__file__ = str(path)
    sys.modules[name] = module  # compiled code finds its globals by this name
    try:
        exec(compile(source_text(plugin.content), str(path), "exec"), module.__dict__)
    except Exception as error:  # report any error of the user's code in one line
        del sys.modules[name]
        message = f"cannot be imported: {type(error).__name__}: {error}{_line(error, path)}"
        raise _problem(path, plugin.document, message) from error
    return module.__dict__


def _line(error: BaseException, path: Path) -> str:
    """Line of the plugin that raised an exception, in words."""
    if isinstance(error, SyntaxError):
        return ""
    lines, trace = [], error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == str(path):
            lines.append(trace.tb_lineno)
        trace = trace.tb_next
    return f" (line {lines[-1]})" if lines else ""


def _complaint(member: Member, roles: dict[str, tuple[str, ...]]) -> str:
    """Return the problem of a member, or an empty text."""
    if not member.name.isidentifier() or member.name != member.name.lower():
        return f"has a member whose name is no lower-case identifier (got {member.name!r})"
    if not (member.params.__doc__ or "").strip():
        return "must say in a docstring what its parameters are"
    if set(member.kernels) != set(roles):
        return (
            f"must give the kernel{'s' if len(roles) > 1 else ''} {', '.join(roles)} (got "
            f"{', '.join(member.kernels) or 'none'})"
        )
    for role, arguments in roles.items():
        function = getattr(member.kernels[role], "py_func", None)
        if function is None:
            return f"must compile {role!r} with @kernel"
        if len(given := inspect.signature(function).parameters) != len(arguments):
            return f"must define {role}({', '.join(arguments)}) (got {function.__name__}({', '.join(given)}))"
    return ""
