# %% [markdown]
# # Train
#
# The powered descent is a learning environment. Five times a second, the policy chooses an acceleration from
# the height, velocity, attitude and mass that the flight computer estimates. The reward of a step is its
# progress towards rest on the ground; a landing within limits gives 1 in addition. `baseline()` is the action
# that the flight software would choose, for comparison.

# %%
import gymnasium
import matplotlib.pyplot as plt
import numpy as np

import edl6dof.gym  # noqa: F401  registers the environments

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
# Any library for gymnasium environments can train a policy. If stable-baselines3 is installed
# (`pip install stable-baselines3`), this cell trains one by proximal policy optimisation (PPO) for some
# minutes; otherwise the notebook compares only the policies above. The return of an episode, the sum of its
# rewards, rises from -5.0 to -0.3, which is not yet a landing. `tools/train.py` trains for longer, with many
# descents at a time.

# %%
try:
    from stable_baselines3 import PPO
except ImportError:
    print("stable-baselines3 is not installed: no policy is trained")
else:
    practice = gymnasium.wrappers.RecordEpisodeStatistics(env, buffer_length=10_000)
    settings = {"n_steps": 2048, "batch_size": 512, "gamma": 0.999, "seed": 1, "device": "cpu"}
    model = PPO("MlpPolicy", practice, **settings).learn(STEPS)
    learnt = list(practice.return_queue)
    first, last = np.mean(learnt[:10]), np.mean(learnt[-10:])
    print(f"mean return of the first ten episodes {first:.1f}, of the last ten {last:.1f}")
    policies[f"PPO after {STEPS:,} steps"] = lambda seen: model.predict(seen, deterministic=True)[0]

# %% [markdown]
# Each policy flies the cases that follow those of the training.


# %%
def descend(policy, case):
    """Sum of the rewards after each step of an episode, and its success."""
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
