# %% [markdown]
# # Train
#
# The powered descent as a learning environment: five times a second the policy says how to accelerate, from
# what the flight computer knows of height, velocity, attitude and mass. The reward is what a step brings
# towards rest on the ground, and 1 for a landing within limits. `baseline()` is what the flight software
# itself would do: the mark to reach.

# %%
import gymnasium
import matplotlib.pyplot as plt
import numpy as np

import edl6dof.gym  # noqa: F401  makes the environments known

STEPS, EPISODES = 150_000, 3
TRAINED = 4  # dispersed descents to train on: cases 0 to 3
env = gymnasium.make("edl6dof/PoweredDescent-v0", pool=TRAINED)
rng = np.random.default_rng(1)
policies = {
    "at random": lambda seen: rng.uniform(-1.0, 1.0, 3).astype(np.float32),
    "thrust = weight": lambda seen: np.zeros(3, np.float32),
    "flight software": lambda seen: env.unwrapped.baseline(),
}

# %% [markdown]
# Any library that knows gymnasium's environments can train. With `pip install stable-baselines3` this
# trains by proximal policy optimisation, from nothing, for some minutes; without it, this notebook shows the
# policies above alone. The return of an episode rises from -5.0 to -0.3, and that is a beginning, no landing:
# `tools/train.py` flies many descents at a time, for longer.

# %%
try:
    from stable_baselines3 import PPO
except ImportError:
    print("stable-baselines3 is not installed: nothing is trained")
else:
    practice = gymnasium.wrappers.RecordEpisodeStatistics(env, buffer_length=10_000)
    settings = {"n_steps": 2048, "batch_size": 512, "gamma": 0.999, "seed": 1, "device": "cpu"}
    model = PPO("MlpPolicy", practice, **settings).learn(STEPS)
    learnt = list(practice.return_queue)
    first, last = np.mean(learnt[:10]), np.mean(learnt[-10:])
    print(f"mean return of the first ten episodes {first:.1f}, of the last ten {last:.1f}")
    policies[f"PPO after {STEPS:,} steps"] = lambda seen: model.predict(seen, deterministic=True)[0]

# %% [markdown]
# Each policy flies the cases after those that it was trained on.


# %%
def descend(policy, case):
    """Return so far after each step of an episode, and whether it ended well."""
    seen, _ = env.reset(options={"case": case})
    rewards, over = [], False
    while not over:
        seen, reward, lost_or_done, cut_off, found = env.step(policy(seen))
        rewards.append(reward)
        over = lost_or_done or cut_off
    return np.cumsum(rewards), found["is_success"]


figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for number, (name, policy) in enumerate(policies.items()):
    flown = [descend(policy, TRAINED + k) for k in range(EPISODES)]
    print(f"{name}: {sum(done for _, done in flown)} of {EPISODES} land within limits")
    for sofar, _ in flown:
        axes.plot(0.2 * np.arange(1, len(sofar) + 1), sofar, color=f"C{number}", alpha=0.8, label=name)
        name = None
axes.set(xlabel="time since ignition (s)", ylabel="return so far")
axes.set_title(f"Powered descent by {len(policies)} policies")
axes.legend(frameon=False)
axes.grid(alpha=0.3)
plt.show()
