"""Linear models of a flight at a moment: the plant, attitude control, and the margins of the loop of both.

The plant is linearised by central differences of its equations of motion, attitude control by central
differences of the law that flies.  A law without a derivative at that moment (a phase plane, a limit, a step)
has no linear model: margins mean something for laws that are linear about the state, such as
``thrust_vector``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from edl6dof.config.dtype import duplicate
from edl6dof.fsw.control.registry import attitude_control
from edl6dof.fsw.navigation.derived import derive
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
#: Frequencies (rad/s) at which margins are evaluated.
_FREQUENCIES = np.geomspace(1e-3, 300.0, 20_000)


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


class Margins(NamedTuple):
    """Margins of the loop of an axis, broken at its torque, others closed; infinite without a crossover."""

    gain_db: float
    phase_deg: float
    delay_s: float
    crossover_rad_s: float


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


def control_gain(flight: RunningFlight) -> np.ndarray:
    """Decrease of the torque (N m, B) of the law of the present phase per deviation of rotation (rad) and
    rate (rad/s), shape (3, 6), with constant integrators.
    """
    fsw, onboard = duplicate(flight.fsw), flight.onboard[0]
    estimate, nav = fsw["navigation"]["estimate"][0], fsw["nav"][0]
    phase = onboard["mission"]["phases"][int(fsw["mission"]["phase"][0])]
    rates, law = onboard["rates"], fsw["control"]["law"]
    remembered = law.tobytes()
    q, w = estimate["q_I2B"].copy(), estimate["w_B"].copy()
    believed = onboard["planet"], onboard["atmosphere"], onboard["vehicle"], onboard["site"]["frame"]

    def torque(axis: int, angle: float, rate: float) -> np.ndarray:
        estimate["q_I2B"], estimate["w_B"] = turned(q, axis, angle), w
        estimate["w_B"][axis] += rate
        derive(*believed, estimate, nav)
        law[:] = np.frombuffer(remembered, law.dtype)
        given = fsw["guide"][0], fsw["control"]["inputs"][0], float(rates["control_every"] / rates["base"])
        return np.array(attitude_control(phase["control"], onboard["control"], nav, *given, law[0])[0])

    gain = np.zeros((3, 6))
    for axis in range(3):
        for column, (angle, rate) in ((axis, (1e-4, 0.0)), (axis + 3, (0.0, 1e-4))):
            gain[:, column] = -(torque(axis, angle, rate) - torque(axis, -angle, -rate)) / 2e-4
    return gain


def margins(plant: LinearModel, gain: np.ndarray, delay_s: float) -> dict[str, Margins]:
    """Margins of each axis of the attitude loop.

    Args:
        plant: from :func:`linear_plant`.
        gain: from :func:`control_gain`, shape (3, 6).
        delay_s: from the measured attitude to the torque; half a control cycle accounts for the hold of the
            torque.
    """
    a, b = plant.a[6:, 6:], plant.b[6:, :3]
    found = {}
    for axis, name in enumerate("xyz"):
        others = [k for k in range(3) if k != axis]
        closed = a - b[:, others] @ gain[others]
        found[name] = _margins(closed, b[:, axis], gain[axis], delay_s)
    return found


def _margins(a: np.ndarray, b: np.ndarray, k: np.ndarray, delay_s: float) -> Margins:
    """Margins of the loop ``k (s - a)^-1 b exp(-s delay)``."""
    s = 1j * _FREQUENCIES
    matrices = s[:, None, None] * np.eye(len(a)) - a
    loop = np.linalg.solve(matrices, np.broadcast_to(b[:, None], (len(s), len(b), 1)))[..., 0] @ k
    size, phase = np.abs(loop), np.unwrap(np.angle(loop)) - _FREQUENCIES * delay_s
    phase -= 2.0 * np.pi * np.round((phase[0] + 0.5 * np.pi) / (2.0 * np.pi))
    crossovers = np.flatnonzero((size[:-1] >= 1.0) & (size[1:] < 1.0))
    turns = np.flatnonzero(np.diff(np.floor((phase + np.pi) / (2.0 * np.pi))) != 0)
    with np.errstate(divide="ignore"):  # a loop that is open has no end to its margin
        gain_db = min((abs(20.0 * float(np.log10(size[k]))) for k in turns), default=np.inf)
    if not len(crossovers):
        return Margins(gain_db, np.inf, np.inf, np.nan)
    at = crossovers[-1]
    left = phase[at] + np.pi
    return Margins(gain_db, float(np.degrees(left)), float(left / _FREQUENCIES[at]), float(_FREQUENCIES[at]))
