"""Identity of a campaign: the plan, the code that flies, and every file it reads.

Two programs with the same identity give the same table, bit for bit, on any processor and operating system.
Rows of programs with different identities are never combined in one table.  The identity leaves out
everything that cannot change a bit: Python's version, and the code that draws, prints, exports and checks.
It includes numpy for the order of its sums, numba for its code generation, and scipy for its Sobol numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy
import scipy

import edl6dof
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.store import Identity
from edl6dof.config.document.locate import PACKAGE, find_include
from edl6dof.config.document.source import INCLUDES, read_document
from edl6dof.config.model_paths import value_at
from edl6dof.config.plugin_files import VARIABLE
from edl6dof.environment.atmosphere_table import profile_path
from edl6dof.environment.terrain import MAP
from edl6dof.kernels.cache import received
from edl6dof.manifest import digest, sha256
from edl6dof.scenario.checks import PROFILES, TABLES

#: Folders of the package from which no row follows.
_ASIDE = {
    *("api", "calibration", "cli", "design", "export", "gym", "missions", "replay", "report"),
    *("runs", "serve", "studies", "verify"),
}

#: In place of a hash: there is no such file, or this process has not loaded the plugin.
_GONE, _NOT_LOADED = "gone", f"not loaded in this process: set {VARIABLE} to it"


def identity(plan: Plan) -> Identity:
    """Identity of a plan that this process flies."""
    libraries = ["numpy", "numba"]
    if plan.campaign is not None and plan.campaign.sampling.startswith("sobol"):
        libraries.append("scipy")
    files = (  # those of the package without the folder in which it is installed
        path.relative_to(PACKAGE.parent).as_posix() if path.is_relative_to(PACKAGE) else str(path)
        for path in input_files(plan)
    )
    return _present(plan.text, libraries, received, files)


def differences_from(recorded: Identity, plan_text: str) -> list[str]:
    """Items of ``recorded`` that differ in this process, each as ``item: was this, is that``."""
    plugins = [*recorded.plugins, *received]
    return compared(recorded, _present(plan_text, recorded.versions, plugins, recorded.files))


def compared(recorded: Identity, present: Identity) -> list[str]:
    """Return the items that differ between two identities, each as ``item: was this, is that``."""
    was, now = dict(recorded.items()), dict(present.items())
    changed = [name for name in {**was, **now} if was.get(name) != now.get(name)]
    return [f"{name}: was {_shown(was.get(name))}, is {_shown(now.get(name))}" for name in changed]


def changed_files(recorded: Identity) -> list[str]:
    """Tables, vehicle and planet files that have changed since ``recorded``."""
    return [name for name, value in recorded.files.items() if _hash(PACKAGE.parent / name) != value]


def _present(
    plan_text: str, libraries: Iterable[str], plugins: Iterable[str], files: Iterable[str]
) -> Identity:
    known = {library.__name__: library.__version__ for library in (edl6dof, numpy, numba, scipy)}
    return Identity(
        plan=sha256(plan_text.encode()),
        sources=source_hash(),
        versions={name: known[name] for name in ("edl6dof", *libraries) if name in known},
        plugins={name: _plugin_hash(name) for name in sorted(set(plugins))},
        files={name: _hash(PACKAGE.parent / name) for name in files},
    )


@cache
def source_hash() -> str:
    """Hash of every source file of the package that can change a row."""
    files = (file.relative_to(PACKAGE) for file in PACKAGE.rglob("*.py"))
    return digest({file.as_posix(): _hash(PACKAGE / file) for file in files if file.parts[0] not in _ASIDE})


def _plugin_hash(name: str) -> str:
    return _hash(Path(name)) if name in received or not Path(name).is_file() else _NOT_LOADED


def _hash(path: Path) -> str:
    try:
        return sha256(path.read_bytes())
    except OSError:
        return _GONE


def _shown(value: str | None) -> str:
    """Shorten a hash; return anything else as it is."""
    return "not there" if value is None else value[:12] if len(value) == 64 else value


def input_files(plan: Plan) -> list[Path]:
    """Every file that a case may read, sorted; cases that name missing files do not fly."""
    found = {MAP}
    files = plan.loaded.document.files
    folder = files[0].resolve().parent if files else Path.cwd()
    for model in (plan.loaded.scenario, plan.loaded.truth):
        found |= {path_of(value) for key, path_of in TABLES.items() if (value := value_at(model, key))}
        found |= set(_named(PROFILES, model.atmosphere.profiles, folder))
    exchanged = list(_exchanged(plan))
    for path, value in exchanged:
        found |= set(_named(path, value, folder))
    if exchanged:  # a new section may have a table of the package as default
        found |= set((PACKAGE / "data").rglob("*"))
    found |= {path.with_suffix(".yaml") for path in found if path.suffix == ".npy"}  # what a map is of
    return sorted(path.resolve() for path in found if path.is_file())


def _exchanged(plan: Plan) -> Iterator[tuple[str, Any]]:
    """Yield path and value of everything but numbers that a case puts in place of the scenario's value."""
    exchanges = list(plan.axes)
    for draw in plan.draws:
        exchanges += [(target, getattr(draw.distribution, "choices", ())) for target in draw.targets]
    for target, values in exchanges:
        yield from ((target.path, value) for value in values if isinstance(value, str | Mapping))


def _named(path: str, value: Any, folder: Path) -> Iterator[Path]:
    """Yield the files that a value at a dotted path names, directly or further inside."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _named(f"{path}.{key}", inner, folder)
    elif isinstance(value, str) and value and path in TABLES:
        yield TABLES[path](value)
    elif isinstance(value, str) and path.startswith(f"{PROFILES}."):
        yield profile_path(value)
    elif isinstance(value, str) and path in INCLUDES:
        included = find_include(value, INCLUDES[path], folder)[0]
        if included is not None:
            yield included
            yield from _named(path, read_document(included, {}).data, folder)
