"""The vehicle of a scenario: its picture in a file, and the authority of its thrusters on a terminal."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from textwrap import fill

from rich.console import Console

from edl6dof.api.functions import draw_vehicle, load
from edl6dof.design.thruster_authority import Configuration
from edl6dof.report.terminal import open_table
from edl6dof.report.vehicle_drawing import NOTE, authority_tables

_WIDTH = 80


def show_vehicle(name: str, sets: Sequence[str], out: Path, force: bool, as_json: bool) -> None:
    """Draw the vehicle of a scenario, and print the authority of its thrusters."""
    loaded = load(name, sets)
    states = draw_vehicle(loaded, out, force=force)
    if as_json:
        print(json.dumps([_plain(state) for state in states], indent=1))
        return
    console = Console(highlight=False, soft_wrap=True)
    for table in authority_tables(loaded.scenario.vehicle, states):
        shown = open_table(table.caption, *table.columns)
        for row in table.rows:
            shown.add_row(*map(str, row))
        console.print(shown)
    words = NOTE if states[0].groups else f"{loaded.scenario.vehicle.name} has no thrusters."
    console.print(fill(words, _WIDTH), style="dim", markup=False)
    console.print(out, markup=False)


def _plain(state: Configuration) -> dict[str, object]:
    """The configuration as JSON: forces (N) and torques (N m) along - and + of x, y, z."""
    groups = {
        group: {
            f"{kind}_{unit}": rows.tolist()
            for kind, values in (("pure", found.pure), ("total", found.total))
            for unit, rows in (("force_n", values[:3]), ("torque_nm", values[3:]))
        }
        for group, found in state.groups.items()
    }
    return {"configuration": state.name, "centre_m": state.centre_m.tolist(), "groups": groups}
