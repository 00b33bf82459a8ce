"""The models that each of ``vehicle.engines`` may name as its ``model``: how its thrust follows the command.

A member has three kernels.  ``goal(params, engine, t, step, command)`` gives what a ``command`` (N) makes the
thrust strive for over the ``step`` (s) that begins at time ``t`` (s), as a line: its mean (N) and slope (N/s;
:mod:`edl6dof.vehicle.propulsion.line_in_step`).  ``rate(params, engine, goal, thrust, starting)`` gives the
time derivative (N/s) of the thrust; ``starting`` says whether the engine starts or is cut off.
``specific_impulse(params, engine, thrust)`` gives it in s.  ``params`` are the member's own, ``engine`` what
all engines have.
"""

from __future__ import annotations

from edl6dof.registry import Family
from edl6dof.vehicle.propulsion.engine_models import pulsed, solid, throttled, thruster_set

ENGINE_MODELS = Family("engine model", (throttled.MEMBER, pulsed.MEMBER, thruster_set.MEMBER, solid.MEMBER))

#: Index of the member whose thrust is that of the axial thrusters.
BY_THRUSTERS = ENGINE_MODELS.names.index(thruster_set.NAME)

#: Index of the member that burns at full thrust from ignition on.
UNCOMMANDED = ENGINE_MODELS.names.index(solid.NAME)

EngineChoice = ENGINE_MODELS.params_model(
    "EngineChoice", "model", "throttled", "How the thrust of an engine follows its command."
)

goal_of_model = ENGINE_MODELS.switch("goal", "params", "engine", "t", "step", "command")
rate_of_model = ENGINE_MODELS.switch("rate", "params", "engine", "goal", "thrust", "starting")
specific_impulse_of_model = ENGINE_MODELS.switch("specific_impulse", "params", "engine", "thrust")
