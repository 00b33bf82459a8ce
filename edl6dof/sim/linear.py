"""Linear model of the plant at a moment of a flight, by central differences of its equations of motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from edl6dof.config.dtype import duplicate
from edl6dof.sim.flight_state import RunningFlight
from edl6dof.sim.loop import look
from edl6dof.spatial.quaternion import about_axis, multiply
from edl6dof.vehicle.plant import ATTITUDE, POSITION, RATE, VELOCITY

if TYPE_CHECKING:
    from control import StateSpace

#: Deviations of the state, in the order of the matrices: position and inertial velocity in I; small rotation
#: and rate in B.
STATES = (
    *("r_x_m", "r_y_m", "r_z_m", "v_x_m_s", "v_y_m_s", "v_z_m_s"),
    *("theta_x_rad", "theta_y_rad", "theta_z_rad", "w_x_rad_s", "w_y_rad_s", "w_z_rad_s"),
)
#: Inputs: torque and force of the thrusters, in B.
INPUTS = ("torque_x_nm", "torque_y_nm", "torque_z_nm", "force_x_n", "force_y_n", "force_z_n")
#: Steps of the differences: of states and inputs in the order above, three each.
_STATE_STEPS, _INPUT_STEPS = np.repeat([1.0, 1e-2, 1e-5, 1e-5], 3), np.repeat([1.0, 1.0], 3)
_R, _V, _TH, _W = (slice(3 * k, 3 * k + 3) for k in range(4))


@dataclass(frozen=True, repr=False)
class LinearModel:
    """``x' = a x + b u``, ``y = c x + d u`` of deviations from a moment of a flight.

    Attributes:
        t_s: time of the moment, s.
        a, b, c, d: matrices.
        states, inputs, outputs: names in their order, with units.
    """

    t_s: float
    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    d: np.ndarray
    states: tuple[str, ...] = STATES
    inputs: tuple[str, ...] = INPUTS
    outputs: tuple[str, ...] = STATES

    def __repr__(self) -> str:
        return f"<LinearModel at t = {self.t_s:.2f} s: {len(self.states)} states, {len(self.inputs)} inputs>"

    def poles(self) -> np.ndarray:
        """Eigenvalues of ``a``, 1/s."""
        return np.linalg.eigvals(self.a)

    def to_control(self) -> StateSpace:
        """The model as a ``StateSpace`` of python-control.

        Raises:
            ImportError: python-control is not installed.
        """
        try:
            import control
        except ImportError:
            raise ImportError("to_control needs python-control: pip install control") from None
        names = {"states": self.states, "inputs": self.inputs, "outputs": self.outputs}
        return control.ss(self.a, self.b, self.c, self.d, **{key: list(names[key]) for key in names})


def linear_plant(flight: RunningFlight) -> LinearModel:
    """Linearise the plant of a flight at its present state, which is not changed."""
    plant, outputs, work = (duplicate(record) for record in (flight.plant, flight.outputs, flight.work))

    before = plant.tobytes()

    def accelerations(deviate: Callable[[np.void, int, float], None], j: int, step: float) -> np.ndarray:
        """Derivatives of velocity (I) and rate (B) with the plant deviated by a step."""
        plant.view(np.uint8)[:] = np.frombuffer(before, np.uint8)
        deviate(plant[0], j, step)
        look(flight.case, flight.tables, plant, outputs, work)
        k = work["k"][0, 0]
        return np.concatenate([k[VELOCITY : VELOCITY + 3], k[RATE : RATE + 3]])

    a, b = np.zeros((12, 12)), np.zeros((12, 6))
    a[_R, _V] = a[_TH, _W] = np.eye(3)
    a[_TH, _TH] = np.cross(plant["y"][0, RATE : RATE + 3], np.eye(3))
    for matrix, deviate, steps in ((a, _deviate, _STATE_STEPS), (b, _add_input, _INPUT_STEPS)):
        for j, step in enumerate(steps):
            up, down = (accelerations(deviate, j, sign * step) for sign in (1.0, -1.0))
            matrix[_V, j], matrix[_W, j] = np.split((up - down) / (2.0 * step), 2)
    return LinearModel(float(plant["t"][0]), a, b, np.eye(12), np.zeros((12, 6)))


def _deviate(plant: np.void, j: int, step: float) -> None:
    """Move state ``j`` of :data:`STATES` by a step."""
    y = plant["y"]
    if j < 6:
        y[(POSITION if j < 3 else VELOCITY) + j % 3] += step
    elif j < 9:
        y[ATTITUDE : ATTITUDE + 4] = turned(y[ATTITUDE : ATTITUDE + 4], j - 6, step)
    else:
        y[RATE + j - 9] += step


def _add_input(plant: np.void, j: int, step: float) -> None:
    """Add a step to input ``j`` of :data:`INPUTS`."""
    plant["inputs"]["rcs_moment" if j < 3 else "rcs_force"][j % 3] += step


def turned(q_I2B: np.ndarray, axis: int, angle: float) -> np.ndarray:
    """An attitude turned by an angle (rad) about an axis of B: the product with that rotation."""
    return np.array(multiply(tuple(q_I2B), about_axis(tuple(np.eye(3)[axis]), angle)))
