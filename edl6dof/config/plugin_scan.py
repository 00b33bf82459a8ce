"""Which files name plugins, among a scenario and those it extends: found without importing anything heavy."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from os.path import isfile, join
from pathlib import Path

from edl6dof.config.document.locate import find_shipped

#: Environment variable that names plugin files, separated as in PATH.
VARIABLE = "EDL6DOF_PLUGINS"

#: Size, in bytes, of the largest file that is read as a scenario; a page with a scenario printed in it is
#: none.
LARGEST = 2_000_000

#: A resolved file without plugins says ``plugins: []``.
_NAMES_PLUGINS = re.compile(rb"^plugins[ \t]*:(?![ \t]*\[[ \t]*\])", re.MULTILINE)
_EXTENDS = re.compile(rb"^extends[ \t]*:[ \t]*[\"']?([^\s\"'#]+)", re.MULTILINE)


def files_from_environment() -> list[Path]:
    """Plugin files that the environment names."""
    return [Path(text).absolute() for text in os.environ.get(VARIABLE, "").split(os.pathsep) if text]


def files_naming_plugins(operand: str | Path) -> Iterator[Path]:
    """Files with a ``plugins`` key among what a command was given to fly (a file, a scenario's name, a
    campaign's folder) and its bases.
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
    """The file that an operand, or what stands after ``extends``, means; ``None`` when it is no scenario."""
    if "\0" in text:
        return None
    here = join(folder, text)
    places = (here, f"{here}.yaml", join(here, "campaign.yaml"))
    found = next((Path(place) for place in places if isfile(place)), None)
    return found or find_shipped("scenarios", text.removeprefix("scenarios/"))


def _content(file: Path) -> bytes:
    try:
        return file.read_bytes() if file.stat().st_size <= LARGEST else b""
    except OSError:  # whoever reads it in earnest says so
        return b""
