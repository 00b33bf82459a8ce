"""The table of ``docs/tianwen1.md`` from flights made now: ``python tools/flight_table.py`` rewrites it in
place between its markers.
"""

from __future__ import annotations

import re
from pathlib import Path

import edl6dof
from edl6dof.campaign.neighbours import fly_neighbours, sample_means
from edl6dof.report.terminal import comparison

PAGE = Path(__file__).resolve().parents[1] / "docs" / "tianwen1.md"


def flight_table() -> str:
    """Mean and spread of neighbouring flights beside the published flight, as Markdown."""
    loaded = edl6dof.load("tianwen1")
    rows = fly_neighbours(loaded)
    found = sample_means(rows, loaded.scenario.published)
    means = {name: spread.mean for name, spread in found.items()}
    deviations = {name: spread.deviation for name, spread in found.items()}
    lines = [
        "| figure | unit | mean and spread | published | difference | sigma |",
        "|---|---|---:|---:|---:|---:|",
    ]
    lines += [
        "| " + " | ".join(row.cells).replace("+-", "±") + " |"
        for row in comparison(means, loaded.scenario.published, deviations)
    ]
    miss = found["landing_distance_m"]
    lines.append(
        f"\n{sum(row['success'] for row in rows)} of {len(rows)} flights landed within limits, "
        f"{miss.mean:.0f} ± {miss.deviation:.0f} m from the landing site."
    )
    return "\n".join(lines)


def put(text: str, marker: str, body: str) -> str:
    """``text`` with what stands between the markers replaced."""
    pattern = rf"(<!-- {marker}: -->\n).*?(\n<!-- /{marker} -->)"
    return re.sub(pattern, lambda match: match.group(1) + body + match.group(2), text, flags=re.DOTALL)


if __name__ == "__main__":
    PAGE.write_text(put(PAGE.read_text(encoding="utf-8"), "flight", flight_table()), encoding="utf-8")
