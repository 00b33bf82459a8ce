# %% [markdown]
# # Disperse
#
# One flight is one sample of many possible flights. In this campaign, the flight-path angle at entry and the
# density of the air have random errors, which the flight computer does not know. The plots show where the
# parachute opens, and which input causes the scatter.

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
# A quantile has bounds with a confidence of 95 %. For the 99 % quantile, 60 flights are too few: the result
# gives the number of flights that it requires.

# %%
print("median:", result.quantile("parachute_miss_m", 0.5))
print("99 %:  ", result.quantile("parachute_miss_m", 0.99))

# %% [markdown]
# The table contains the sampled inputs and the results of each case; `edl6dof.refly(result, 12)` flies case
# 12 again, with all telemetry. The height at which the parachute opens depends on the density. Guidance
# compensates for the error of the flight-path angle, and for most of the miss distance.

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
driver.set(xlabel="density / expected density", ylabel="height above the ground (km)")
driver.set_title(f"Height: correlation {correlation:+.2f}")
figure.colorbar(dots, label="flight-path angle at entry (deg)")
for axes in (footprint, driver):
    axes.grid(alpha=0.3)
plt.show()
