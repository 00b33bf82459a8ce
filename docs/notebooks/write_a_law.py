# %% [markdown]
# # Write a law
#
# An entry guidance law is one Python file in the folder of a scenario. It contains parameters with their
# bounds and a kernel, which is compiled like the rest of the flight software. This law commands the constant
# drag that reduces the speed to its final value over the range to go. In a notebook, fly the scenario with
# the plugin first, because a plugin must be present before the simulator is loaded. A plugin runs with your
# rights, and only after you have accepted it: `edl6dof trust` shows its content and records your consent.

# %%
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt

import edl6dof

Path("constant_drag.py").write_text('''
from edl6dof.config.base import Params, param
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.spatial.elementary import acos
from edl6dof.spatial.vector import clamp


class ConstantDragParams(Params):
    """Constant drag to the aim point."""

    level_cosine: float = param(0.5, "cosine of the bank angle on the profile", ge=-1.0, le=1.0)
    gain: float = param(2.0, "change of that cosine per relative drag error", ge=0.0, le=20.0)


@kernel
def guide(params, plan, onboard, nav, memory, out):
    """Commanded bank angle (rad)."""
    p, final = params, onboard.guidance.entry.final_speed
    out.reference_drag = (nav.speed**2 - final**2) / (2.0 * max(out.range_to_go, 1e3))
    error = nav.drag / max(out.reference_drag, 0.1) - 1.0
    return acos(clamp(p.level_cosine + p.gain * error, -1.0, 1.0))


FAMILY = "entry_law"
MEMBER = Member("constant_drag", ConstantDragParams, {"guide": guide}, "Harpold & Graves 1979")
''')
Path("mine.yaml").write_text("""
extends: tianwen1
name: mine
plugins: [constant_drag.py]
flight_software: {guidance: {entry: {law: constant_drag}}}
""")
subprocess.run([sys.executable, "-m", "edl6dof", "trust", "--yes", "constant_drag.py"], check=True)
mine, shipped = edl6dof.fly("mine.yaml"), edl6dof.fly("tianwen1")
for flight in (mine, shipped):
    miss_km = flight.figures["parachute_miss_m"] / 1e3
    print(f"{flight.name:9} {flight.outcome}, parachute {miss_km:.1f} km from the aim point")

# %% [markdown]
# Without further code, the parameters of the law are checked, and can be set in the scenario
# (`flight_software.guidance.entry.constant_drag.gain`), by `--set` and in campaigns. The telemetry shows the
# weakness of the law: the lift points down until the drag reaches its reference. The drag then exceeds the
# reference, and even the smallest bank angle (15 deg) does not reduce it enough. A law needs a reference that
# the vehicle can follow, such as the planned drag of `drag_tracking`.

# %%
figure, (top, bottom) = plt.subplots(2, figsize=(7, 5.5), sharex=True, layout="constrained")
for flight, colour in ((shipped, "0.6"), (mine, "tab:red")):
    entry = (flight["t_s"] > 68) & (flight["truth.mach"] > 2.9)
    speed = flight["truth.speed_m_s"][entry] / 1e3
    top.plot(speed, flight["nav.drag_m_s2"][entry], color=colour, label=f"{flight.name}: measured")
    top.plot(speed, flight["guide.reference_drag_m_s2"][entry], ":", color=colour, label="reference")
    bottom.plot(speed, abs(flight["guide.bank_deg"][entry]), color=colour)
top.set(ylabel="drag (m/s²)", title="New law and law of the package", ylim=(0, 80))
bottom.set(ylabel="bank angle commanded (deg)", xlabel="speed (km/s)")
bottom.invert_xaxis()
top.legend(frameon=False, ncols=2)
for panel in (top, bottom):
    panel.grid(alpha=0.3)
plt.show()
