"""Places of scenarios, vehicles and planets, and names that are valid for folders."""

from __future__ import annotations

import difflib
import re

# unlike pathlib's, these take names that the system cannot look up
from os.path import exists, isdir, isfile, normpath
from pathlib import Path

from edl6dof.config.errors import ConfigError, Problem

PACKAGE = Path(__file__).resolve().parents[2]
KINDS = ("scenarios", "vehicles", "planets")
SUFFIX = ".yaml"

_FOLDER_NAME = re.compile(r"[\w+-]([\w .+-]*[\w+-])?")
#: Bytes: file systems allow 255, and programs append the number of a case, an ending and other marks.
_LONGEST_NAME = 150


def shipped_folders(kind: str) -> list[Path]:
    """Possible folders of the shipped files of one kind, existing or not."""
    if kind not in KINDS:
        raise ValueError(f"unknown kind {kind!r}: {', '.join(KINDS)}")
    repository = PACKAGE.parent
    # A folder called "scenarios" next to an installed package belongs to somebody else.
    beside = [repository / kind] if (repository / "pyproject.toml").is_file() else []
    return [*beside, PACKAGE / "share" / kind, PACKAGE / "data" / kind]


def shipped_names(kind: str) -> list[str]:
    """Names of all shipped files of one kind, sorted; ``folder/name`` for a file in a subfolder."""
    found = ((folder, file) for folder in shipped_folders(kind) for file in folder.rglob("*" + SUFFIX))
    return sorted({file.relative_to(folder).with_suffix("").as_posix() for folder, file in found})


def find_shipped(kind: str, name: str) -> Path | None:
    """The shipped file of a name such as ``mars``, with or without ``.yaml``, or ``None``."""
    stem = name.removesuffix(SUFFIX)
    if not stem or Path(stem).is_absolute() or Path(stem).as_posix() != stem or ".." in Path(stem).parts:
        return None
    candidates = (folder / (stem + SUFFIX) for folder in shipped_folders(kind))
    return next((path for path in candidates if isfile(path)), None)


def extends_name(scenario: str) -> str:
    """Value of ``extends`` for a scenario: the whole path of a file, or the name of a shipped one."""
    file = Path(scenario)
    return str(file.resolve()) if file.is_file() else scenario


def find_include(value: str, kind: str, folder: Path) -> tuple[Path | None, list[Path]]:
    """Find the file that an include key names; return it, or ``None``, and the places searched.

    A bare name is searched among the files of its kind first, so that scenario and vehicle may share a name.

    Args:
        value: name or path as written in the YAML file.
        kind: ``vehicles`` or ``planets``.
        folder: folder of the including file.
    """
    stem = value.removesuffix(SUFFIX)
    of_kind = [
        folder.parent / kind / (stem + SUFFIX),
        *(shipped / (stem + SUFFIX) for shipped in shipped_folders(kind)),
    ]
    beside = [folder / value, folder / (stem + SUFFIX)]
    is_path = value.endswith(SUFFIX) or Path(value).name != value
    places = list(dict.fromkeys([*beside, *of_kind] if is_path else [*of_kind, *beside]))
    return next((path for path in places if isfile(path)), None), places


def near_names(value: str, kind: str, folders: list[Path]) -> list[str]:
    """Names of existing files of one kind that are similar to ``value``."""
    names = set(shipped_names(kind))
    for folder in folders:
        names.update(file.stem for file in folder.glob("*" + SUFFIX))
    return difflib.get_close_matches(Path(value).stem, sorted(names), n=3, cutoff=0.5)


def resolve_scenario(name_or_path: str | Path) -> Path:
    """The scenario file of a path, of ``scenarios/NAME.yaml`` from any directory, or of a shipped name.

    Raises:
        ConfigError: no such file; the message has the names of similar shipped scenarios.
    """
    text = str(name_or_path)
    path = Path(text)
    for candidate in (path, Path(text + SUFFIX)):
        if text and isfile(candidate):
            return candidate
    name = path.relative_to("scenarios") if path.parts[:1] == ("scenarios",) else path
    if shipped := find_shipped("scenarios", str(name)):
        return shipped
    raise ConfigError([Problem(text or "(no name)", 0, 0, "", _no_scenario(path))])


def _no_scenario(path: Path) -> str:
    if isdir(path) and str(path) != ".":
        inside = path / "scenario.yaml"
        return "is a folder" + (f"; did you mean {inside}?" if isfile(inside) else ", not a scenario file")
    if exists(path) and not isdir(path):
        return "is not a regular file"
    names = shipped_names("scenarios")
    near = near_names(str(path), "scenarios", [])
    hint = f"; did you mean {' or '.join(near)}?" if near else ""
    return f"no such scenario file{hint} (shipped scenarios: {', '.join(names) or 'none'})"


def shown(path: Path) -> str:
    """A path for messages: relative if it is below the current directory."""
    try:
        return str(path.resolve().relative_to(Path.cwd()))
    except (ValueError, OSError):
        return normpath(path)


def why_no_folder(name: str) -> str | None:
    """Reason why a name is not valid for a folder, or ``None``."""
    if not _FOLDER_NAME.fullmatch(name):
        return (
            "must do as a folder name: letters, digits, blanks and . _ + -, no dot or blank at the "
            f"ends (got {name!r})"
        )
    if (length := len(name.encode())) > _LONGEST_NAME:
        return f"must do as a folder name: at most {_LONGEST_NAME} bytes (got {length})"
    return None
