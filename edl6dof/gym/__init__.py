"""Learning environments: parts of a flight in which a policy replaces a part of the flight software.
``import edl6dof.gym`` registers them with gymnasium.

>>> import gymnasium, edl6dof.gym
>>> env = gymnasium.make("edl6dof/PoweredDescent-v0")
>>> many = gymnasium.make_vec("edl6dof/PoweredDescent-v0", num_envs=16)

Needs the extra ``edl6dof[gym]``.
"""

from __future__ import annotations

try:
    import gymnasium
except ImportError:
    raise ImportError("edl6dof.gym needs gymnasium: pip install 'edl6dof[gym]'") from None

from edl6dof.gym.environments import TASKS, FlightEnv, FlightVectorEnv

__all__ = ["TASKS", "FlightEnv", "FlightVectorEnv"]

for _name in TASKS:
    gymnasium.register(
        f"edl6dof/{_name}-v0",
        entry_point="edl6dof.gym.environments:FlightEnv",
        vector_entry_point="edl6dof.gym.environments:FlightVectorEnv",
        kwargs={"task": _name},
    )
