"""Modulation, activity and test pulses called with the records of a flight, shape (1,)."""

from as_flown import as_flown

from edl6dof.fsw.diagnosis import exercise
from edl6dof.fsw.diagnosis.exercise import ExerciseSignals
from edl6dof.fsw.estimation import registry as estimation
from edl6dof.fsw.modulation import close_for_test as close_kernel
from edl6dof.fsw.modulation import modulate as modulate_kernel
from edl6dof.fsw.modulation import open_for_test as open_kernel
from edl6dof.kernels import kernel

VALVES = "fsw[0].modulation"
MATRIX = "fsw[0].effectiveness.matrix"

modulate = as_flown(
    modulate_kernel,
    "params, vehicle, t, dt, fsw",
    f"params[0], vehicle, fsw[0].allocation.duty, t, dt, {VALVES}",
)
open_for_test = as_flown(open_kernel, "i, vehicle, t, dt, fsw", f"i, vehicle, t, dt, {VALVES}")
close_for_test = as_flown(close_kernel, "i, fsw", f"i, {VALVES}")
remember = as_flown(estimation.remember_valves, "count, fsw", f"{VALVES}, count, fsw[0].estimation.activity")
expect = as_flown(
    estimation.expect,
    "count, begin, end, lag, fsw",
    f"{MATRIX}, count, begin, end, lag, fsw[0].estimation.activity",
)
opposite = as_flown(exercise.opposite, "count, i, fsw", f"{MATRIX}, count, i")


@kernel
def pair_to_test(params, vehicle, sideways, axial, start, t, dt, fsw):
    """The pair that the exercise fires next."""
    signals = ExerciseSignals(
        vehicle=vehicle,
        effectiveness=fsw[0].effectiveness.matrix,
        healthy=fsw[0].health.thruster,
        diagnosis=fsw[0].diagnosis,
        valves=fsw[0].modulation,
        sideways=sideways,
        axial=axial,
        start=start,
        t=t,
        dt=dt,
    )
    return exercise.pair_to_test(params[0], signals, fsw[0].diagnosis.exercise)


@kernel
def thruster_to_close(params, vehicle, t, dt, fsw):
    """The thruster that the exercise closes next."""
    signals = ExerciseSignals(
        vehicle=vehicle,
        effectiveness=fsw[0].effectiveness.matrix,
        healthy=fsw[0].health.thruster,
        diagnosis=fsw[0].diagnosis,
        valves=fsw[0].modulation,
        sideways=False,
        axial=0.0,
        start=0.0,
        t=t,
        dt=dt,
    )
    return exercise.thruster_to_close(params[0], signals)
