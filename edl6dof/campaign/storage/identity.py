"""What the rows of a campaign follow from: the plan, the code that flies, and every file that it reads.

Two programs with the same identity give the same table, bit for bit, on any processor and operating system;
rows of two that differ never stand in one table.  What cannot move a bit is left out: Python's version, and
the code that draws, prints, exports and checks.  numpy stays for the order of its sums, numba for the code it
makes, scipy for Sobol numbers.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path

import numba
import numpy
import scipy

import edl6dof
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.storage.documents import Identity, digest
from edl6dof.campaign.storage.inputs import input_files
from edl6dof.config.plugin_scan import VARIABLE
from edl6dof.jit import outside_sources
from edl6dof.manifest import sha256

_PACKAGE = Path(edl6dof.__file__).resolve().parent
#: Folders of the package from which no row follows.
_ASIDE = frozenset(
    (
        *("api", "app", "calibration", "cli", "design", "export", "gym", "missions", "replay", "report"),
        *("runs", "serve", "studies", "verify"),
    )
)

#: In the place of a hash: there is no such file, or this process has not loaded the plugin.
_GONE, _NOT_LOADED = "gone", f"not loaded in this process: set {VARIABLE} to it"


def identity(plan: Plan) -> Identity:
    """Identity of a plan that this process flies."""
    libraries = ["numpy", "numba"]
    if plan.campaign is not None and plan.campaign.sampling.startswith("sobol"):
        libraries.append("scipy")
    return _present(plan.text, libraries, list(outside_sources), map(_label, input_files(plan)))


def differences(recorded: Identity, plan_text: str) -> list[str]:
    """Items in which this process and its files differ from those of ``recorded``, each as ``item: was this,
    is that``.
    """
    plugins = [*recorded.plugins, *outside_sources]
    return compared(recorded, _present(plan_text, recorded.versions, plugins, recorded.files))


def compared(recorded: Identity, present: Identity) -> list[str]:
    """As :func:`differences`, between two identities: a plan that is read again may find other files by the
    same names.
    """
    was, now = dict(recorded.items()), dict(present.items())
    changed = [name for name in {**was, **now} if was.get(name) != now.get(name)]
    return [f"{name}: was {_shown(was.get(name))}, is {_shown(now.get(name))}" for name in changed]


def changed_files(recorded: Identity) -> list[str]:
    """Tables, vehicle and planet files that are no longer those of ``recorded``."""
    return [name for name, value in recorded.files.items() if _hash(_PACKAGE.parent / name) != value]


def _present(
    plan_text: str, libraries: Iterable[str], plugins: Iterable[str], files: Iterable[str]
) -> Identity:
    known = {library.__name__: library.__version__ for library in (edl6dof, numpy, numba, scipy)}
    return Identity(
        plan=sha256(plan_text.encode()),
        sources=source_hash(),
        versions={name: known[name] for name in ("edl6dof", *libraries) if name in known},
        plugins={
            name: _hash(Path(name)) if name in outside_sources else _absent(name)
            for name in sorted(set(plugins))
        },
        files={name: _hash(_PACKAGE.parent / name) for name in files},
    )


@cache
def source_hash() -> str:
    """Hash of every source file of the package that a row can follow from."""
    files = (file.relative_to(_PACKAGE) for file in _PACKAGE.rglob("*.py"))
    return digest({file.as_posix(): _hash(_PACKAGE / file) for file in files if file.parts[0] not in _ASIDE})


def _absent(plugin: str) -> str:
    return _NOT_LOADED if Path(plugin).is_file() else _GONE


def _hash(path: Path) -> str:
    try:
        return sha256(path.read_bytes())
    except OSError:
        return _GONE


def _label(path: Path) -> str:
    """Name of a file in an identity: for those of the package without the place where it is installed."""
    return path.relative_to(_PACKAGE.parent).as_posix() if path.is_relative_to(_PACKAGE) else str(path)


def _shown(value: str | None) -> str:
    """A hash shortened, anything else as it is."""
    return "not there" if value is None else value[:12] if len(value) == 64 else value
