# %% [markdown]
# # First flight
#
# This notebook flies Tianwen-1 from the entry interface at 125 km to the ground, which takes less than a
# second. The first flight on a machine also compiles the simulator, which takes about a minute.

# %%
import matplotlib.pyplot as plt

import edl6dof

flight = edl6dof.fly("tianwen1")
print(flight)  # outcome, end time and number of telemetry rows

# %% [markdown]
# As the last line of a cell, `flight` is shown with outcome, timeline and limits. Figures of merit
# (`flight.figures`) are numbers; channels of telemetry (`flight[name]`) are numpy arrays.

# %%
mach, load = flight.figures["parachute_mach"], flight.figures["peak_load_g0"]
print(f"parachute at Mach {mach:.2f}, {load:.1f} g at most")
print(flight.unit("truth.heat_flux_w_cm2"), flight.meaning("truth.heat_flux_w_cm2"))

# %% [markdown]
# The vehicle loses nearly all of its speed to drag between 50 and 20 km, before the parachute opens. When the
# engine ignites, the speed is about 60 m/s.

# %%
speed, height = flight["truth.speed_m_s"], flight["truth.height_m"] / 1e3
figure, axes = plt.subplots(figsize=(7, 4.5))
for phase in [event for event in flight.events if "phase" in event and event["height_m"] > 500]:
    part = flight["t_s"] >= phase["t_s"]
    axes.plot(speed[part], height[part], lw=2.5, label=phase["phase"].replace("_", " "))
axes.set(xscale="log", yscale="log", xlim=(20, 6000), ylim=(0.5, 150))
axes.set(xlabel="speed (m/s)", ylabel="height above the ground (km)", title="Tianwen-1: height and speed")
axes.legend(title="phase", frameon=False)
axes.grid(alpha=0.3, which="both")
plt.show()
