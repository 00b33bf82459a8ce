# %% [markdown]
# # Break a thruster
#
# D7, one of eight thrusters that turn the hovering lander, dies 2 s after it has set out for the spot it
# has chosen. The flight computer is told nothing: it feels that it turns otherwise than it has commanded,
# and has to find out why.

# %%
import matplotlib.pyplot as plt
import numpy as np

import edl6dof

fault = {"thruster": "D7", "kind": "stuck_off", "at": {"phase": "hazard_avoidance", "plus_s": 2}}
sound = edl6dof.fly("tianwen1")
broken = edl6dof.fly("tianwen1", {"faults": [fault]})
print(broken.outcome)  # landed within limits

# %% [markdown]
# The timeline has both the fault and the isolation of the flight computer.

# %%
found = {event["key"]: event for event in broken.events if event["key"] in ("fault", "diagnosis")}
for event in found.values():
    print(f"{event['t_s']:.2f} s  {event['name']}")

# %% [markdown]
# What the estimator takes for a disturbance is the torque that D7 does not give. Once D7 is named, its work
# goes to the others, and the estimate is what it was before.

# %%
start = found["fault"]["t_s"]
figure, panels = plt.subplots(2, figsize=(7, 5), sharex=True, layout="constrained")
for flight, name, colour in ((sound, "sound", "0.6"), (broken, "D7 dead", "tab:red")):
    part = np.abs(flight["t_s"] - start - 4) < 6
    t = flight["t_s"][part] - start
    torque = np.linalg.norm([flight[f"estimate.torque_{axis}_nm"][part] for axis in "xyz"], axis=0)
    error = np.linalg.norm(
        [flight[f"control.error_{axis}_deg"][part] for axis in ("roll", "pitch", "yaw")], axis=0
    )
    panels[0].plot(t, torque, color=colour, label=name)
    panels[1].plot(t, error, color=colour)
panels[0].set(ylabel="estimated disturbance (N m)", title="A dead thruster, named and flown around")
panels[1].set(ylabel="attitude error (deg)", xlabel="time since the fault (s)")
for panel in panels:
    panel.axvline(0, color="k", ls=":")
    panel.axvline(found["diagnosis"]["t_s"] - start, color="tab:green")
    panel.grid(alpha=0.3)
panels[0].legend(frameon=False)
panels[0].text(found["diagnosis"]["t_s"] - start + 0.2, 100, "D7 named", color="tab:green")
plt.show()
