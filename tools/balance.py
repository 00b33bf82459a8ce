"""Errors of the balance sheet in dispersed flights of every mission, as a table in Markdown.

    python tools/balance.py 1000                  # flights of each mission that is validated
    python tools/balance.py 100 phoenix_mc        # of one

Flights that end within limits and flights that do not have separate rows: a vehicle that tumbles under thrust
turns too fast for the integration step.  Each cell is the largest error of its row.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa

import edl6dof
from edl6dof.metrics.figures import BALANCES
from edl6dof.missions.mission import shipped_missions

LIMITS = {figure.name: figure.allowed for figure in BALANCES}
COLUMNS = ("mission", "end", "flights", "beyond a limit", *LIMITS)


def rows(name: str, table: pa.Table) -> list[str]:
    """Rows of one mission; none for an end that no flight has."""
    success = table["success"].to_numpy()
    errors = np.stack([np.abs(table[column].to_numpy()) for column in LIMITS])
    beyond = (errors > np.array(list(LIMITS.values()))[:, None]).any(axis=0)
    lines = []
    for end, chosen in (("within limits", success), ("otherwise", ~success)):
        if chosen.any():
            worst = " | ".join(f"{error:.1e}" for error in errors[:, chosen].max(axis=1))
            lines.append(f"| `{name}` | {end} | {chosen.sum()} | {beyond[chosen].sum()} | {worst} |")
    return lines


def main() -> None:
    """Fly, and print the table."""
    parser = argparse.ArgumentParser(description="Balance errors of dispersed flights.")
    parser.add_argument("flights", type=int)
    parser.add_argument("missions", nargs="*")
    options = parser.parse_args()
    print("| " + " | ".join(COLUMNS) + " |\n" + "|---" * len(COLUMNS) + "|")
    for name in options.missions or shipped_missions():
        with TemporaryDirectory() as folder:
            table = edl6dof.campaign(name, cases=options.flights, out=Path(folder) / "out").table
            print("\n".join(rows(name, table)), flush=True)


if __name__ == "__main__":
    main()
