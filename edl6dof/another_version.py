"""Results and scenarios of another version of the program: what is told where one cannot be used.

Looking at such a result works as long as it holds what is looked for; flying such a scenario again works as
long as it means the same.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from edl6dof import __version__

#: As ``written_by`` of a manifest, and the header of a resolved scenario, name the program.
_PROGRAM = r"edl6dof (?P<version>[\w.+-]{1,40})"
_HEADER = re.compile(rf"# resolved by {_PROGRAM}: ")
#: Bytes of a manifest, and of a scenario, that are looked at.
_LARGEST, _FIRST_LINE = 1_000_000, 200


def writer(manifest: Path) -> str:
    """Version of the program that wrote a manifest; empty for this one, and where the file does not say."""
    try:
        with manifest.open("rb") as file:
            written_by = json.loads(file.read(_LARGEST))["written_by"]
        found = re.fullmatch(_PROGRAM, written_by)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ""
    return _other(found)


def resolver(scenario: Path) -> str:
    """Version of the program that wrote the resolved scenario of a run; empty for this one, and for a
    scenario that nobody resolved.
    """
    try:
        with scenario.open("rb") as file:
            line = file.readline(_FIRST_LINE).decode("utf-8", "replace")
    except OSError:
        return ""
    return _other(_HEADER.match(line))


def told(version: str) -> str:
    """The two versions in words; empty where there is only one."""
    return f"written by edl6dof {version}, and this is edl6dof {__version__}" if version else ""


def _other(found: re.Match[str] | None) -> str:
    return "" if found is None or found["version"] == __version__ else found["version"]
