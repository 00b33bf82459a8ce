# %% [markdown]
# # Disperse
#
# One flight is one draw of many. Here the angle of entry and the density are known only within a spread,
# and the flight computer does not know the draw. Where does the parachute open, and why there?

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import edl6dof

CASES = 60
Path("spread.yaml").write_text("""
extends: tianwen1
name: spread
mission: {goal: deployment}
campaign:
  seed: 7
  truth:
    initial.flight_path_angle_deg: {kind: normal, three_sigma: 0.2}
    atmosphere.density_factor: {kind: normal, three_sigma: 0.2}
""")
result = edl6dof.campaign("spread.yaml", cases=CASES)
print(result)

# %% [markdown]
# A quantile comes with its bounds at 95 %, or not at all where the flights are too few: no 60 flights tell
# 99 %.

# %%
print("median:", result.quantile("parachute_miss_m", 0.5))
print("99 %:  ", result.quantile("parachute_miss_m", 0.99))

# %% [markdown]
# Columns of the table are what was drawn and what came of it; `edl6dof.refly(result, 12)` flies case 12
# again, with all its telemetry. How high the parachute opens is the air's doing; guidance takes the angle
# of entry out of it, and most of the miss too.

# %%
angle = result["truth.initial.flight_path_angle_deg"]
density = result["truth.atmosphere.density_factor"]
down, across = result["parachute_downrange_m"] / 1e3, result["parachute_crossrange_m"] / 1e3
figure, (footprint, driver) = plt.subplots(1, 2, figsize=(8, 4), layout="constrained")
dots = footprint.scatter(across, down, c=angle, cmap="coolwarm", edgecolor="0.3", lw=0.4)
footprint.plot(0, 0, "k+", ms=14)
footprint.set(xlabel="crossrange (km)", ylabel="downrange (km)", title="Where the parachute opens")
driver.scatter(density, result["parachute_height_m"] / 1e3, c=angle, cmap="coolwarm", edgecolor="0.3", lw=0.4)
correlation = np.corrcoef(density, result["parachute_height_m"])[0, 1]
driver.set(xlabel="density, of the expected", ylabel="height above the ground (km)")
driver.set_title(f"How high: correlation {correlation:+.2f}")
figure.colorbar(dots, label="flight-path angle at entry (deg)")
for axes in (footprint, driver):
    axes.grid(alpha=0.3)
plt.show()
