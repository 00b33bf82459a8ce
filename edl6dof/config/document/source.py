"""Reading of a configuration document: YAML files, with the vehicle and planet files that they name, as plain
data with places.

>>> document = read_document(resolve_scenario("tianwen1"))
>>> document.data["vehicle"]["mass"]["entry_kg"], document.marks["vehicle", "mass", "entry_kg"].line
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from edl6dof.config.document.document import EXTENDS, Document, lay_over, refuse_replacing
from edl6dof.config.document.locate import (
    PACKAGE,
    find_include,
    find_shipped,
    near_names,
    resolve_scenario,
    shown,
    why_no_folder,
)
from edl6dof.config.document.regular import read_regular
from edl6dof.config.document.yamltree import Mark, parse_yaml
from edl6dof.config.errors import ConfigError, Problem, refusal
from edl6dof.config.plugin_files import LARGEST
from edl6dof.config.wording import got

__all__ = [
    "INCLUDES",
    "Mark",
    "find_shipped",
    "include",
    "parse_document",
    "read_document",
    "resolve_scenario",
]

#: Key of a scenario's name.
NAME = "name"
#: Scenarios that may extend one another.
LONGEST_CHAIN = 20

#: Keys of a scenario whose value may be the name or path of another file, and the kind of that file.
INCLUDES: dict[str, str] = {"vehicle": "vehicles", "planet": "planets"}


def read_document(path: str | Path, includes: Mapping[str, str] = INCLUDES) -> Document:
    """Read a YAML file, the files it includes, and the scenario it extends.

    An included file that cannot be read is noted in ``refused`` of the document, for the validation to report
    together with the mistakes of the other sections.

    Raises:
        ConfigError: the file itself, or one that it extends, cannot be read.
    """
    document = _read(Path(path), includes, ())
    if "planet" in includes and "atmosphere" not in document.data:
        _add_air(document)
    return document


def _add_air(document: Document) -> None:
    """Give a scenario without an atmosphere that of its planet, and its wind unless the scenario has one."""
    planets = [file for file in document.files if file.parent == PACKAGE / "data" / "planets"]
    air = PACKAGE / "data" / "air" / planets[-1].name if planets else None
    if air is None or not air.is_file():
        return
    part = parse_document(_read_text(air), shown(air))
    document.files += (air,)
    for section in (name for name in part.data if name not in document.data):
        document.data[section] = part.data[section]
        document.marks.update({path: mark for path, mark in part.marks.items() if path[:1] == (section,)})
        for claims, more in ((document.status, part.status), (document.sources, part.sources)):
            claims.update({path: text for path, text in more.items() if path.partition(".")[0] == section})


def _read(path: Path, includes: Mapping[str, str], extended_by: tuple[Path, ...]) -> Document:
    document = parse_document(_read_text(path), shown(path))
    document.files = (path,)
    base = _base(document, includes, (*extended_by, path.resolve())) if EXTENDS in document.data else None
    for key, kind in includes.items():
        value = document.data.get(key)
        if isinstance(value, str):
            if base is not None:
                base.data.pop(key, None)  # another vehicle or planet, not changes of the one there
            try:
                include(document, key, value, kind)
            except ConfigError as error:
                document.refused[key,] = error.problems
    if base is None:
        refuse_replacing(document, document.replacing)
        return document
    lay_over(base, document)
    _name_after(path, base, document)
    return base


def _name_after(path: Path, scenario: Document, top: Document) -> None:
    """Name a scenario that extends another and has no name of its own after its file."""
    if NAME in scenario.data and NAME not in top.data and why_no_folder(path.stem) is None:
        scenario.forget((NAME,))
        scenario.data[NAME] = path.stem


def _base(document: Document, includes: Mapping[str, str], chain: tuple[Path, ...]) -> Document:
    """The scenario that ``document`` extends."""
    name = document.data.pop(EXTENDS)
    if not isinstance(name, str):
        raise document.error((EXTENDS,), f"must be the name or path of a scenario (got {got(name)})")
    beside = chain[-1].parent / name
    try:
        found = resolve_scenario(beside if beside.is_file() else name)
    except ConfigError as error:
        raise document.error((EXTENDS,), error.problems[0].message) from None
    if len(chain) > LONGEST_CHAIN:
        message = f"is number {len(chain)} in a chain of scenarios; at most {LONGEST_CHAIN} are allowed"
        raise document.error((EXTENDS,), message)
    if found.resolve() in chain:
        raise document.error((EXTENDS,), f"leads back to {shown(found)}")
    return _read(found, includes, chain)


def parse_document(text: str, file: str) -> Document:
    """Read a document without includes from text; ``file`` is the name shown in messages."""
    return _parsed(text, file).copy()


@lru_cache(maxsize=16)
def _parsed(text: str, file: str) -> Document:
    """The document of a text, cached: many scenarios share a vehicle, many flights a scenario."""
    tree = parse_yaml(text, file)
    if tree.data is None:
        raise ConfigError([Problem(file, 1, 1, "", "the file is empty")])
    if not isinstance(tree.data, dict):
        words = "must be a mapping of keys (lines of the form 'key: value')"
        raise ConfigError([Problem(file, 1, 1, "", words)])
    return Document(tree.data, tree.marks, tree.status, tree.sources, replacing=tree.replacing)


def include(document: Document, key: str, value: str, kind: str) -> None:
    """Load the file named ``value`` (a name or path of this ``kind``) into ``document.data[key]``, with the
    places of its values in that file.
    """
    folder = document.files[0].resolve().parent if document.files else Path.cwd()
    found, places = find_include(value, kind, folder)
    if found is None:
        looked = ", ".join(shown(place) for place in places)
        near = near_names(value, kind, [folder, folder.parent / kind])
        hint = f"; did you mean {' or '.join(near)}?" if near else ""
        message = f"no such file{hint} (got {value[:100]!r}; looked for {looked[:2000]})"
        raise document.error((key,), message)
    part = parse_document(_read_text(found), shown(found))
    refuse_replacing(part, part.replacing)
    document.files += (found,)
    document.forget((key,))
    document.data[key] = part.data
    document.marks.update({(key, *path): mark for path, mark in part.marks.items()})
    document.status.update({f"{key}.{path}": status for path, status in part.status.items()})
    document.sources.update({f"{key}.{path}": source for path, source in part.sources.items()})


def _read_text(path: Path) -> str:
    file = shown(path)
    try:
        content = read_regular(path, LARGEST)
    except FileNotFoundError:
        raise refusal(file, "no such file") from None
    except IsADirectoryError:
        raise refusal(file, "is a folder, not a file") from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise refusal(file, f"cannot be read: {reason}") from None
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        column = error.start - content.rfind(b"\n", 0, error.start)
        raise ConfigError([Problem(file, line, column, "", "is not UTF-8 text")]) from None
