"""The disturbance estimators.

A member has one kernel, ``estimate(params, measured, dt, memory, out)``: it brings the estimate ``out``
(``DISTURBANCE``) up to the control cycle of ``dt`` seconds that the latest inertial measurement covers,
``measured`` (``MEASURED``).  ``out`` still holds the last estimate; ``params`` and ``memory`` are its own.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.config.base import group, param
from edl6dof.fsw.estimation.engine_shortfall import EngineShortfallParams
from edl6dof.fsw.estimation.estimators import first_order, unfiltered
from edl6dof.fsw.estimation.held_thrust import HeldThrustParams
from edl6dof.registry import Family

ESTIMATORS = Family("disturbance estimator", (first_order.MEMBER, unfiltered.MEMBER))

MEASURED = np.dtype(
    [
        ("inertia", "f8", (3,)),  # kg m2, B: believed principal moments about the axes of B
        ("mass", "f8"),  # kg: believed
        ("rate", "f8", (3,)),  # rad/s, B: at the end of the cycle
        ("last_rate", "f8", (3,)),  # rad/s, B: at its beginning
        ("velocity_gain", "f8", (3,)),  # m/s, B: integral of the specific force over the cycle
        ("applied", "f8", (6,)),  # N and N m, B: mean force and torque of the commanded thrusters
        ("unexplained", "f8", (6,)),  # N and N m, B: what was measured less what was applied
    ],
    align=True,
)

DISTURBANCE = np.dtype(
    [
        ("torque", "f8", (3,)),  # N m, B: on the vehicle, without the commanded thrusters
        ("force", "f8", (3,)),  # N, B: on the vehicle, without the commanded thrusters and gravity
        ("pole", "f8"),  # rad/s: convergence speed of the torque
        ("unexplained", "f8", (6,)),  # N and N m, B: what one cycle alone shows
    ],
    align=True,
)

_Estimators: Any = ESTIMATORS.params_model(
    "Estimators", "estimator", "first_order", "Disturbance estimation."
)


class EstimationParams(_Estimators):
    """Disturbance estimation: the estimator, and what all share."""

    valve_lag_s: float = param(
        0.006,
        "time by which thrust follows the valve, half its rise",
        status="estimate",
        source="rise and decay of 12 ms",
        ge=0.0,
        le=0.02,
    )
    engine_shortfall: EngineShortfallParams = group(EngineShortfallParams, "belief in a loss of thrust")
    held_thrust: HeldThrustParams = group(HeldThrustParams, "belief in a throttle that stands")
    force_angle_lag_s: float = param(
        1.0,
        "lag with which the angle of the unexplained force from the body axis is smoothed; outlasts a leak "
        "that diagnosis stops",
        status="design",
        gt=0.0,
    )


estimate = ESTIMATORS.role("estimate", "params", "measured", "dt", "memory", "out", own=("params", "memory"))
