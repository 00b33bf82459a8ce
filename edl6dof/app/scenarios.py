"""``edl6dof scenarios``: what is shipped, and the text of one to begin with."""

from __future__ import annotations

import sys

from rich.console import Console
from rich.text import Text

from edl6dof.config.document.locate import find_shipped, resolve_scenario, shipped_names
from edl6dof.config.document.source import parse_document
from edl6dof.report.terminal import open_table


def run_scenarios(name: str | None) -> int:
    """Print the shipped scenarios, or the file of one as it is.

    Raises:
        ConfigError: there is no such scenario.
    """
    if name is not None:
        sys.stdout.write(resolve_scenario(name).read_text(encoding="utf-8"))
        return 0
    console = Console(highlight=False)
    table = open_table("", "scenario", "what it is")
    for shipped in shipped_names("scenarios"):
        table.add_row(shipped, Text(_description(shipped)))
    console.print(table)
    console.print("A file of your own: edl6dof scenarios tianwen1 > mine.yaml", style="dim")
    return 0


def _description(name: str) -> str:
    path = find_shipped("scenarios", name)
    data = parse_document(path.read_text(encoding="utf-8"), name).data if path else {}
    return str(data.get("description") or "")
