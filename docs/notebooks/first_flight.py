# %% [markdown]
# # First flight
#
# From the entry interface at 125 km to the ground, in a tenth of a second of computing. The first flight on
# a machine compiles the simulator, about a minute.

# %%
import matplotlib.pyplot as plt

import edl6dof

flight = edl6dof.fly("tianwen1")
print(flight)  # <Flight tianwen1: landed within limits at t = 541.9 s, 27097 rows of telemetry>

# %% [markdown]
# A notebook shows `flight` as a page: outcome, timeline, limits. Figures of merit are numbers, channels
# numpy arrays.

# %%
mach, load = flight.figures["parachute_mach"], flight.figures["peak_load_g0"]
print(f"parachute at Mach {mach:.2f}, {load:.1f} g at most")
print(flight.unit("truth.heat_flux_w_cm2"), flight.meaning("truth.heat_flux_w_cm2"))

# %% [markdown]
# Where the speed goes: nearly all of it is lost between 50 and 20 km, before the parachute opens; the
# engine has 58 m/s to take.

# %%
speed, height = flight["truth.speed_m_s"], flight["truth.height_m"] / 1e3
figure, axes = plt.subplots(figsize=(7, 4.5))
for phase in [event for event in flight.events if "phase" in event and event["height_m"] > 500]:
    part = flight["t_s"] >= phase["t_s"]
    axes.plot(speed[part], height[part], lw=2.5, label=phase["phase"].replace("_", " "))
axes.set(xscale="log", yscale="log", xlim=(20, 6000), ylim=(0.5, 150))
axes.set(xlabel="speed (m/s)", ylabel="height above the ground (km)", title="Tianwen-1: where the speed goes")
axes.legend(title="phase", frameon=False)
axes.grid(alpha=0.3, which="both")
plt.show()
