"""Print the tables of the README from a flight made now: ``python tools/readme.py`` rewrites them in place
between their markers.

The speed table comes from ``tools/bench.py`` and is pasted by hand, with the machine it was measured on.
"""

from __future__ import annotations

import re
from pathlib import Path

import edl6dof
from edl6dof.report.terminal import comparison

README = Path(__file__).resolve().parents[1] / "README.md"


def flight_table() -> str:
    """This flight beside the published one, as Markdown."""
    flight = edl6dof.fly("tianwen1")
    lines = ["| figure | unit | this flight | published | difference |", "|---|---|---:|---:|---:|"]
    lines += [
        "| " + " | ".join(row.cells) + " |" for row in comparison(flight.metrics, flight.scenario.published)
    ]
    lines.append(
        f"\nOutcome: **{flight.outcome}**, {flight.metrics['landing_distance_m']:.0f} m from the landing "
        "site."
    )
    return "\n".join(lines)


def put(text: str, marker: str, body: str) -> str:
    """``text`` with what stands between the markers replaced."""
    pattern = rf"(<!-- {marker}: -->\n).*?(\n<!-- /{marker} -->)"
    return re.sub(pattern, lambda match: match.group(1) + body + match.group(2), text, flags=re.DOTALL)


if __name__ == "__main__":
    README.write_text(put(README.read_text(encoding="utf-8"), "flight", flight_table()), encoding="utf-8")
