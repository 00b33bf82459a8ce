"""What the extras of pyproject.toml ask for, without versions: for an environment of the newest releases.

    pip install --upgrade -e . $(python tools/newest_requirements.py test docs)

The bounds of the package itself hold: it is installed without its extras.
"""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def extras() -> dict[str, list[str]]:
    """Requirements of each extra."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return dict(project["optional-dependencies"])


def unpinned(requirement: str) -> str:
    """A requirement of any version: its name, with the extras that it names in brackets."""
    found = re.match(r"[\w.-]+(?:\[[^]]*\])?", requirement)
    if found is None:
        raise ValueError(f"{requirement!r} is no requirement")
    return found[0]


def main(names: list[str]) -> int:
    there = extras()
    unknown = sorted(set(names) - set(there))
    if unknown or not names:
        print(f"name extras of pyproject.toml: {', '.join(there)}", file=sys.stderr)
        return 2
    print("\n".join(sorted({unpinned(requirement) for name in names for requirement in there[name]})))
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
