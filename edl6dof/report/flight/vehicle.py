"""The vehicle of a run: its drawing, and the authority of its thrusters."""

from __future__ import annotations

import json
from collections.abc import Iterator

from pydantic import ValidationError

from edl6dof.design.thruster_authority import configurations
from edl6dof.report.document import Block, Text
from edl6dof.report.vehicle_drawing import NOTE, authority_tables, vehicle_figure
from edl6dof.runs.run import Run
from edl6dof.vehicle.vehicle import VehicleParams


def vehicle_section(run: Run) -> Iterator[Block]:
    """Draw the vehicle and tabulate its authority; nothing of a point mass."""
    if run.scenario["dynamics"] == "point_mass":
        return
    try:
        vehicle = VehicleParams.model_validate_json(json.dumps(run.scenario["vehicle"]))
    except ValidationError:
        yield Text("Not drawn: the vehicle has parameters of a plugin, which a report does not load.")
        return
    states = configurations(vehicle)
    yield vehicle_figure(vehicle, states)
    if tables := authority_tables(vehicle, states):
        yield from tables
        yield Text(NOTE)
