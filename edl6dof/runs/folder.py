"""A run folder that appears complete or not at all."""

from __future__ import annotations

import glob
import os
import platform
import shutil
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from edl6dof.config.errors import refusal
from edl6dof.durable import put_in_place
from edl6dof.manifest import MANIFEST, Kind, Manifest, seal

#: Age in seconds from which a hidden folder of another host, whose processes cannot be seen from here, counts
#: as left behind.
STALE_S = 86400.0

#: Command that makes a folder of each kind.
COMMANDS: dict[Kind, str] = {
    "flight": "fly",
    "study": "study",
    "validation": "validate",
    "calibration": "calibrate",
}


def distinct_names(folders: Sequence[Path]) -> list[str]:
    """Names of folders; with their parents where two are the same, then numbered."""
    for depth in (1, 2):
        names = ["/".join(folder.resolve().parts[-depth:]) for folder in folders]
        if len(set(names)) == len(names):
            return names
    return [f"{name} ({number})" for number, name in enumerate(names, 1)]


def default_folder(name: str, force: bool) -> Path:
    """Where a result goes for which no ``--out`` names a folder: ``runs/NAME``, or, where that is taken and
    ``force`` is not wanted, the first free one of ``runs/NAME-2``, ``runs/NAME-3``, ..., which is said.
    """
    first = target = Path("runs") / name
    number = 1
    while not force and _is_taken(target):
        number += 1
        target = first.with_name(f"{first.name}-{number}")
    if target != first:
        print(f"{first} exists; this goes to {target}", file=sys.stderr)
    return target


def _is_taken(target: Path) -> bool:
    return os.path.lexists(target) and not (target.is_dir() and not any(target.iterdir()))


@contextmanager
def atomic_folder(target: Path, kind: Kind, force: bool) -> Iterator[Path]:
    """Yield a hidden folder beside ``target`` that gets its manifest and takes its place when the block ends
    without an exception.

    A kill leaves at most the hidden folder; the next run into the same target removes it.  An exception
    leaves nothing, not even the parent folders made here.

    Args:
        target: the folder wanted.
        kind: what it is a result of, as its manifest says: ``flight``, ``study``, ...
        force: whether a result of the same kind may be replaced.

    Raises:
        ConfigError: ``target`` exists and must not be replaced, or it cannot be written.
    """
    try:
        _refuse_existing(target, kind, force)
        # the swap must move a folder, not a link to one
        with _swapped(Path(os.path.realpath(target))) as folder:
            yield folder
            seal(folder, kind)
            # another run may have finished meanwhile, or something been put there
            _refuse_existing(target, kind, force)
    except OSError as error:
        raise refusal(target, f"cannot be written: {error.strerror or error}") from None


@contextmanager
def _swapped(target: Path) -> Iterator[Path]:
    """A new folder that replaces ``target`` at the end; after any failure all is as it was."""
    made = _make_folders(target.parent)
    _sweep(target)
    owner = f"{os.getpid()}-{_host()}"
    partial, old = (target.parent / f".{target.name}.{owner}.{kind}" for kind in ("part", "old"))
    try:
        partial.mkdir()
        yield partial
        try:
            if target.exists():
                target.rename(old)
            put_in_place(partial, target)
        except BaseException:
            if old.exists() and not target.exists():
                old.rename(target)
            raise
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        for folder in made:
            with suppress(OSError):
                folder.rmdir()
        raise
    shutil.rmtree(old, ignore_errors=True)


def _refuse_existing(target: Path, kind: Kind, force: bool) -> None:
    """Refuse to replace ``target`` unless forced, and then unless it is a whole result of the same kind."""
    if target.exists() and not target.is_dir():
        raise refusal(target, "is a file, not a folder; choose another folder with --out")
    if not target.is_dir() or not any(target.iterdir()):
        return
    if not force:
        raise refusal(target, "exists; choose another folder with --out, or replace it with --force")
    never = "it is not replaced, even with --force"
    if not (target / MANIFEST).is_file():
        raise refusal(target, f"is no result of 'edl6dof {COMMANDS[kind]}' (it has no {MANIFEST}); {never}")
    found = Manifest.of(target)
    if found.kind != kind:
        raise refusal(target, f"is a result of 'edl6dof {COMMANDS[found.kind]}'; {never}")
    if stranger := found.stranger():
        raise refusal(target, f"holds {stranger}; {never}")


def _make_folders(folder: Path) -> list[Path]:
    """Make a folder and its parents; returns those that were missing, the deepest first."""
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return missing


def _sweep(target: Path) -> None:
    """Remove what killed runs into the same target left behind; a folder whose process still lives is kept.

    A run killed between the two renames of a replacement has put the former result aside: it comes back.
    """
    for left in target.parent.glob(f".{glob.escape(target.name)}.*.*"):
        owner, kind = left.name.rsplit(".", 2)[1:]
        if kind not in ("part", "old") or not _abandoned(left, owner):
            continue
        if kind == "old" and not target.exists():
            left.rename(target)
        else:
            shutil.rmtree(left, ignore_errors=True)


def _abandoned(left: Path, owner: str) -> bool:
    pid, _, host = owner.partition("-")
    if not pid.isdigit():
        return False
    if host != _host():
        return time.time() - left.stat().st_mtime > STALE_S
    return int(pid) == os.getpid() or not _alive(int(pid))


def _host() -> str:
    return platform.node().replace(".", "_").replace(os.sep, "_")


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    return True
