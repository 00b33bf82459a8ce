# %% [markdown]
# # Validate
#
# Evidence answers two questions. The first is: *are the equations solved correctly?* A check case compares
# the simulation with a solution that is independent of it. Here this is the tumbling of a free body, for
# which Jacobi's elliptic functions give the exact solution.

# %%
import matplotlib.pyplot as plt
import numpy as np

import edl6dof

FLIGHTS = 40
(report,) = edl6dof.verify("tumbling")
for result in report.results:
    print(f"{result.quantity}: error {result.error:.1e}, allowed {result.tolerance:.0e} ({result.source})")

# %% [markdown]
# The second question is: *do the equations describe the real flight?* The real flight is one sample of many
# possible flights, so it is compared with dispersed flights. Phoenix landed in 2008; no parameter of the
# scenario was fitted to its flight.

# %%
published = edl6dof.load("phoenix").scenario.published
flown = edl6dof.campaign("phoenix_mc", cases=FLIGHTS)
print(flown)

# %% [markdown]
# Each dot is a simulated flight, and the diamond is the published value. The unit is the combined standard
# deviation of simulated flights and published value. If the model describes the flight, the diamonds lie
# among the dots. If one lies outside, the page on [validation](../validation.md) gives the cause, if known.

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
axes.set(xlabel="standard deviations", xlim=(-5, 5), title="Phoenix: real flight and dispersed flights")
axes.grid(axis="x", alpha=0.3)
plt.show()
