"""Files and folders of results: each appears complete or not at all, and replaces an existing one only if
forced, or if nothing is lost.

The folder of a result remembers the SHA-256 of every file that was made from it: report, plots, pages,
pictures, films, exports, wherever they were written.  A file that is still one of these, byte for byte, can
be made from the result again; any other file is the user's.

Every command imports this module before it knows which plugins to load: it must import no family.
"""

from __future__ import annotations

import glob
import json
import os
import platform
import shutil
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from edl6dof.config.errors import UnknownName, refusal
from edl6dof.durable import put_in_place, write_atomic
from edl6dof.manifest import MADE, MANIFEST, Kind, Manifest, hash_of, seal

#: Greatest number of files remembered; the oldest are forgotten first, and then kept as the user's.
MOST = 1000
#: Age (s) from which a hidden folder of another host, whose processes cannot be seen, counts as left behind.
STALE_S = 86400.0
#: Command that makes a folder of each kind.
COMMANDS: dict[Kind, str] = {
    "flight": "fly",
    "study": "study",
    "validation": "validate",
    "calibration": "calibrate",
}


@contextmanager
def atomic_file(target: Path, force: bool, made_from: Path | None = None) -> Iterator[Path]:
    """Yield a hidden path next to ``target`` whose file takes its place when the block ends without an
    exception.

    Args:
        target: the file wanted.
        force: whether any file there may be replaced.
        made_from: folder of the result that the file is made from; a file made from this result before may be
            replaced.

    Raises:
        ConfigError: ``target`` exists and must not be replaced, or it cannot be written.
    """
    refuse_existing_file(target, force, made_from)
    # keep the suffix, from which writers choose the format
    partial = target.parent / f".{os.getpid()}.{target.name}"
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield partial
        refuse_existing_file(target, force, made_from)  # another program may have finished meanwhile
        if made_from is not None:
            remember(made_from, partial)
        put_in_place(partial, target)
    except OSError as error:
        raise refusal(target, f"cannot be written: {error.strerror or error}") from None
    finally:
        partial.unlink(missing_ok=True)


def refuse_existing_file(target: Path, force: bool, made_from: Path | None = None) -> None:
    """Raise :class:`ConfigError` when ``target`` must not be written; see :func:`atomic_file`."""
    if target.is_dir():
        raise refusal(target, "is a folder; name a file")
    if force or not os.path.lexists(target):
        return
    if made_from is None:
        raise refusal(target, "exists; name another file, or replace it with --force")
    known = _remembered(made_from)
    if not (known and target.is_file() and not target.is_symlink() and hash_of(target) in known):
        words = "exists, and is not, byte for byte, what was made of this result before"
        raise refusal(target, f"{words}; name another file, or replace it with --force")


def remember(result: Path, file: Path) -> None:
    """Remember that ``file`` was made from the result in a folder.

    Nothing is remembered if ``result`` is no folder or cannot be written: the file then counts as the user's.
    """
    if not result.is_dir():
        return
    digest = hash_of(file)
    known = [one for one in _remembered(result) if one != digest]
    with suppress(OSError):
        write_atomic(result / MADE, (json.dumps([*known, digest][-MOST:], indent=0) + "\n").encode())


def _remembered(result: Path) -> list[str]:
    """Digests of the files made from a result, the oldest first; empty if the list is missing or damaged."""
    path = result / MADE
    try:
        found = json.loads(path.read_bytes()) if path.stat().st_size < 100 * MOST else []
    except (OSError, ValueError, RecursionError):
        return []
    return [one for one in found if isinstance(one, str)] if isinstance(found, list) else []


@contextmanager
def needing_channels(*folders: Path) -> Iterator[None]:
    """Turn the error of a channel that the runs in the folders lack into one line of explanation.

    Raises:
        ConfigError: the runs lack a channel.
    """
    try:
        yield
    except UnknownName as error:
        words = f"no {error.kind} {error.name!r}, which is needed here; plot and export show what there is"
        raise refusal(", ".join(map(str, folders)), words) from None


def distinct_names(folders: Sequence[Path]) -> list[str]:
    """Return the names of folders; with their parents where two are the same, then numbered."""
    for depth in (1, 2):
        names = ["/".join(folder.resolve().parts[-depth:]) for folder in folders]
        if len(set(names)) == len(names):
            return names
    return [f"{name} ({number})" for number, name in enumerate(names, 1)]


def default_folder(name: str, force: bool) -> Path:
    """Return the folder of a result without ``--out``: ``runs/NAME``, or, if that is taken and ``force`` is
    not given, the first free one of ``runs/NAME-2``, ``runs/NAME-3``, ..., which is printed.
    """
    first = target = Path("runs") / name
    number = 1
    while not force and os.path.lexists(target) and not (target.is_dir() and not any(target.iterdir())):
        number += 1
        target = first.with_name(f"{first.name}-{number}")
    if target != first:
        print(f"{first} exists; this goes to {target}", file=sys.stderr)
    return target


@contextmanager
def atomic_folder(target: Path, kind: Kind, force: bool) -> Iterator[Path]:
    """Yield a hidden folder next to ``target`` that gets its manifest and takes its place when the block ends
    without an exception.

    A kill leaves at most the hidden folder; the next run into the same target removes it.  An exception
    leaves nothing, not even the parent folders made here.

    Args:
        target: the folder wanted.
        kind: kind of result, for its manifest: ``flight``, ``study``, ...
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
            # another run may have finished meanwhile, or a file been put there
            _refuse_existing(target, kind, force)
    except OSError as error:
        raise refusal(target, f"cannot be written: {error.strerror or error}") from None


@contextmanager
def _swapped(target: Path) -> Iterator[Path]:
    """A new folder that replaces ``target`` at the end; after any failure all is as it was."""
    made = [path for path in target.parents if not path.exists()]  # the deepest first
    target.parent.mkdir(parents=True, exist_ok=True)
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


def _sweep(target: Path) -> None:
    """Remove the hidden folders of killed runs with the same target; that of a process still alive is kept.

    If a run was killed between the two renames of a replacement, the former result is restored.
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
    if int(pid) == os.getpid():
        return True
    try:
        os.kill(int(pid), 0)
    except ProcessLookupError:
        return True
    except (PermissionError, OverflowError):
        return False
    return False


def _host() -> str:
    return platform.node().replace(".", "_").replace(os.sep, "_")
