"""Plugin files: those that scenarios name, found without slow imports, and those that the user has accepted.

A plugin runs only if the user has accepted its content (``edl6dof trust``), until the content changes.
Accepted plugins are listed in a text file of the user, a line ``SHA-256  path`` for each, which may be edited
or deleted at will.  The hash alone counts: an accepted plugin may move, and another plugin in its place is
not accepted.  Paths are escaped, since a path with a line break could accept another content.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from hashlib import sha256
from os.path import isfile, join
from pathlib import Path

from platformdirs import user_config_path

from edl6dof.config.document.locate import find_shipped
from edl6dof.durable import write_atomic

#: Environment variable that names plugin files, separated as in PATH.
VARIABLE = "EDL6DOF_PLUGINS"
#: Size, in bytes, of the largest file that is read as a scenario; a page with a printed scenario is larger.
LARGEST = 2_000_000

#: A resolved file without plugins says ``plugins: []``.
_NAMES_PLUGINS = re.compile(rb"^plugins[ \t]*:(?![ \t]*\[[ \t]*\])", re.MULTILINE)
_EXTENDS = re.compile(rb"^extends[ \t]*:[ \t]*[\"']?([^\s\"'#]+)", re.MULTILINE)


def files_from_environment() -> list[Path]:
    """Plugin files that the environment names."""
    return [Path(text).absolute() for text in os.environ.get(VARIABLE, "").split(os.pathsep) if text]


def files_naming_plugins(operand: str | Path) -> Iterator[Path]:
    """Files with a ``plugins`` key among the operand of a command (a file, the name of a scenario, the folder
    of a campaign) and the files that it extends.
    """
    seen: set[Path] = set()
    file = _scenario(str(operand), Path())
    while file is not None and file not in seen:
        seen.add(file)
        content = _content(file)
        if _NAMES_PLUGINS.search(content):
            yield file
        base = _EXTENDS.search(content)
        file = _scenario(base.group(1).decode(errors="replace"), file.parent) if base else None


def _scenario(text: str, folder: Path) -> Path | None:
    """The file that an operand, or the text after ``extends``, means; ``None`` if it is no scenario."""
    if "\0" in text:
        return None
    here = join(folder, text)
    places = (here, f"{here}.yaml", join(here, "campaign.yaml"))
    found = next((Path(place) for place in places if isfile(place)), None)
    return found or find_shipped("scenarios", text.removeprefix("scenarios/"))


def _content(file: Path) -> bytes:
    try:
        return file.read_bytes() if file.stat().st_size <= LARGEST else b""
    except OSError:  # reported where the scenario is read
        return b""


def accepted_file() -> Path:
    """The list of accepted plugins."""
    return user_config_path("edl6dof") / "accepted-plugins.txt"


def is_accepted(content: bytes) -> bool:
    """Return whether the user has accepted a plugin with this content."""
    return sha256(content).hexdigest() in (line.split(" ", 1)[0] for line in _lines())


def accept(path: Path, content: bytes) -> None:
    """Remember that the user accepts this content.

    Raises:
        OSError: the list cannot be written.
    """
    place = str(path.resolve()).encode("unicode_escape").decode()
    lines = {*_lines(), f"{sha256(content).hexdigest()}  {place}"}
    accepted_file().parent.mkdir(parents=True, exist_ok=True)
    write_atomic(accepted_file(), "".join(f"{line}\n" for line in sorted(lines)).encode())


def _lines() -> list[str]:
    with suppress(OSError, UnicodeDecodeError):
        return accepted_file().read_text(encoding="utf-8").splitlines()
    return []
