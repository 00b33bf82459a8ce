"""The models that each of ``vehicle.engines`` may name as its ``model``: how its thrust follows the command.

A member has two kernels.  ``rate(params, engine, t, thrust, command, starting)`` gives the time derivative
(N/s) of the thrust at time ``t`` (s); ``starting`` says whether the engine starts or is cut off.
``specific_impulse(params, engine, thrust)`` gives it in s.  ``params`` are the member's own, ``engine`` what
all engines have.
"""

from __future__ import annotations

from edl6dof.registry import Family
from edl6dof.vehicle.propulsion.engine_models import pulsed, throttled

ENGINE_MODELS = Family("engine model", (throttled.MEMBER, pulsed.MEMBER))

EngineChoice = ENGINE_MODELS.params_model(
    "EngineChoice", "model", "throttled", "How the thrust of an engine follows its command.", bare=True
)

rate_of_model = ENGINE_MODELS.switch("rate", "params", "engine", "t", "thrust", "command", "starting")
specific_impulse_of_model = ENGINE_MODELS.switch("specific_impulse", "params", "engine", "thrust")
