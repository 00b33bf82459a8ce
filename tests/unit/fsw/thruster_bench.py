"""Modulation, activity and test pulses called with the records of a flight, shape (1,)."""

from as_flown import as_flown
from numba import types

from edl6dof.fsw.diagnosis import exercise
from edl6dof.fsw.estimation import activity
from edl6dof.fsw.modulation import modulate as modulate_kernel
from edl6dof.fsw.modulation import open_for_test as open_kernel

VALVES = "fsw[0].modulation"
MATRIX = "fsw[0].effectiveness.matrix"

modulate = as_flown(
    modulate_kernel,
    "params, vehicle, t, dt, fsw",
    f"params[0], vehicle, fsw[0].allocation.duty, t, dt, {VALVES}",
)
open_for_test = as_flown(open_kernel, "i, vehicle, t, dt, fsw", f"i, vehicle, t, dt, {VALVES}")
remember = as_flown(activity.remember, "count, fsw", f"{VALVES}, count, fsw[0].estimation.activity")
expect = as_flown(
    activity.expect,
    "count, begin, end, lag, fsw",
    f"{MATRIX}, count, begin, end, lag, fsw[0].estimation.activity",
)
opposite = as_flown(exercise.opposite, "count, i, fsw", f"{MATRIX}, count, i", types.int64)
pair_to_test = as_flown(
    exercise.pair_to_test,
    "params, vehicle, sideways, axial, start, t, dt, fsw",
    f"params[0], vehicle, {MATRIX}, fsw[0].health.thruster, fsw[0].diagnosis, "
    f"{VALVES}, sideways, axial, start, t, dt, fsw[0].diagnosis.exercise",
    types.UniTuple(types.int64, 2),
)
