"""Allocation called with the records of a flight."""

from as_flown import as_flown

from edl6dof.fsw.allocation.update import allocate

#: Shares the demand out by the method of the parameters.
share_out = as_flown(
    allocate,
    "params, vehicle, health, effectiveness, demand, memory",
    "params, vehicle, health.thruster, effectiveness, demand, memory",
)
