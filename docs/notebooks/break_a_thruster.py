# %% [markdown]
# # Break a thruster
#
# Thruster D7, one of eight that rotate the hovering lander, fails 2 s after hazard avoidance has begun. The
# flight computer has no direct information about the failure. It detects that the lander does not rotate as
# commanded, and isolates the thruster that causes the difference.

# %%
import matplotlib.pyplot as plt
import numpy as np

import edl6dof

fault = {"thruster": "D7", "kind": "stuck_off", "at": {"phase": "hazard_avoidance", "plus_s": 2}}
sound = edl6dof.fly("tianwen1")
broken = edl6dof.fly("tianwen1", {"faults": [fault]})
print(broken.outcome)  # landed within limits

# %% [markdown]
# The list of events contains both the fault and its isolation by the flight computer.

# %%
found = {event["key"]: event for event in broken.events if event["key"] in ("fault", "diagnosis")}
for event in found.values():
    print(f"{event['t_s']:.2f} s  {event['name']}")

# %% [markdown]
# After the fault, the estimated disturbance is the torque that D7 does not produce. After the isolation
# (green line), the flight computer uses the other thrusters instead of D7, and the estimate returns to its
# earlier level.

# %%
start = found["fault"]["t_s"]
figure, panels = plt.subplots(2, figsize=(7, 5), sharex=True, layout="constrained")
for flight, name, colour in ((sound, "no fault", "0.6"), (broken, "D7 failed", "tab:red")):
    part = np.abs(flight["t_s"] - start - 4) < 6
    t = flight["t_s"][part] - start
    torque = np.linalg.norm([flight[f"estimate.torque_{axis}_nm"][part] for axis in "xyz"], axis=0)
    error = np.linalg.norm(
        [flight[f"control.error_{axis}_deg"][part] for axis in ("roll", "pitch", "yaw")], axis=0
    )
    panels[0].plot(t, torque, color=colour, label=name)
    panels[1].plot(t, error, color=colour)
panels[0].set(ylabel="estimated disturbance (N m)", title="Failure and isolation of a thruster")
panels[1].set(ylabel="attitude error (deg)", xlabel="time since the fault (s)")
for panel in panels:
    panel.axvline(0, color="k", ls=":")
    panel.axvline(found["diagnosis"]["t_s"] - start, color="tab:green")
    panel.grid(alpha=0.3)
panels[0].legend(frameon=False)
upper = panels[0].get_xaxis_transform()  # x in seconds, y as a share of the panel
panels[0].text(
    found["diagnosis"]["t_s"] - start + 0.2, 0.85, "D7 isolated", color="tab:green", transform=upper
)
plt.show()
