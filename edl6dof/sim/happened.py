"""What befell a flight beside the events of its mission: the trim wing at its end, faults, and what the
flight computer found of them.
"""

from __future__ import annotations

import numpy as np

from edl6dof.sim.flight_records import FlightRecords
from edl6dof.telemetry.timeline import Moment, moment
from edl6dof.vehicle.plant import NOT_BEGUN


def happened(flight: FlightRecords) -> list[Moment]:
    """Moments for the timeline of a flight."""
    return [*_wing(flight), *_faults(flight), *_found(flight)]


def _wing(flight: FlightRecords) -> list[Moment]:
    """The trim wing at the end of its way, of several the last, unless a fault stopped one before."""
    truth, plant = flight.loaded.truth, flight.plant[0]
    starts = zip(truth.vehicle.surfaces, plant["wing_start"], strict=False)
    ends = {one.name: float(t) + one.deploy_time_s for one, t in starts if t < NOT_BEGUN}
    opened = max(ends.values(), default=np.inf)
    stopped = any(
        fault.component == "surface" and since < ends.get(fault.acts_on(truth.components), -np.inf)
        for fault, since in zip(truth.faults, plant["fault_since"], strict=False)
    )
    return [] if stopped or opened > flight.time_s else [moment(opened, "trim_wing_open", "trim wing open")]


def _faults(flight: FlightRecords) -> list[Moment]:
    """Faults that began."""
    truth = flight.loaded.truth
    return [
        moment(since, "fault", f"fault: {fault.label(truth.components)}")
        for fault, since in zip(truth.faults, flight.plant["fault_since"][0], strict=False)
        if since != NOT_BEGUN
    ]


def _found(flight: FlightRecords) -> list[Moment]:
    """Thrusters and instruments that the flight computer took out of use."""
    found = [
        moment(one.t_s, "diagnosis", f"diagnosis: {one.label}", thruster=one.thruster, isolated=one.label)
        for one in flight.isolated_faults
    ]
    found += [
        moment(one.t_s, "exclusion", one.label, component=one.component, instrument=one.instrument,
               back=one.back)
        for one in flight.exclusions
    ]  # fmt: skip
    return found
