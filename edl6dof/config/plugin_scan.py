"""Which command-line arguments are scenarios that name plugins: found without importing anything heavy."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from os.path import isfile, join
from pathlib import Path

#: Environment variable that names plugin files, separated as in PATH.
VARIABLE = "EDL6DOF_PLUGINS"

#: Size, in bytes, of the largest file that is read as a scenario; a page with a scenario printed in it is none.
LARGEST = 2_000_000

_NAMES_PLUGINS = re.compile(rb"^plugins[ \t]*:", re.MULTILINE)


def files_from_environment() -> list[Path]:
    """Plugin files that the environment names."""
    return [Path(text).absolute() for text in os.environ.get(VARIABLE, "").split(os.pathsep) if text]


def scenarios_naming_plugins(arguments: Iterable[str | Path]) -> Iterator[Path]:
    """Files among the arguments (a file, its name without .yaml, or a run folder) with a ``plugins`` key; no shipped scenario has one."""
    for text in map(str, arguments):
        places = (text, f"{text}.yaml", join(text, "scenario.yaml"))
        file = next((Path(place) for place in places if "\0" not in place and isfile(place)), None)
        if file is None:
            continue
        try:
            if file.stat().st_size <= LARGEST and _NAMES_PLUGINS.search(file.read_bytes()):
                yield file
        except OSError:  # whoever reads it in earnest says so
            continue
