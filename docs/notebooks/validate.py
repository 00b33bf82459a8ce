# %% [markdown]
# # Validate
#
# Two questions. *Are the equations solved rightly?* A check case holds a flight against something that
# needs no simulator; here the tumbling of a free body, which Jacobi's elliptic functions give exactly.

# %%
import matplotlib.pyplot as plt
import numpy as np

import edl6dof

FLIGHTS = 40
(report,) = edl6dof.verify("tumbling")
for result in report.results:
    print(f"{result.quantity}: off by {result.error:.1e}, allowed {result.tolerance:.0e} ({result.source})")

# %% [markdown]
# *Do they describe what flew?* The real flight is one draw of many, so it stands beside dispersed flights.
# Phoenix landed in 2008; nothing here was fitted to it.

# %%
published = edl6dof.load("phoenix").scenario.published
flown = edl6dof.campaign("phoenix_mc", cases=FLIGHTS)
print(flown)

# %% [markdown]
# Each dot is a flight and the diamond the real one, in standard deviations of a flight and of what is
# published of it together. A model that describes the flight leaves the diamonds among the dots. Where one
# lies outside, the page on [validation](../validation.md) says what is known of the cause.

# %%
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for row, (name, real) in enumerate(published.items()):
    values = flown[name]
    deviation = np.hypot(values.std(ddof=1), real.sigma)
    axes.plot(
        (values - values.mean()) / deviation, np.full(len(values), row), "o", color="0.6", ms=4, alpha=0.6
    )
    axes.plot((real.value - values.mean()) / deviation, row, "D", color="tab:red")
axes.set_yticks(range(len(published)), published, family="monospace")
axes.axvspan(-3, 3, color="tab:green", alpha=0.08)
axes.set(xlabel="standard deviations", xlim=(-5, 5), title="Phoenix: the real flight as one more draw")
axes.grid(axis="x", alpha=0.3)
plt.show()
