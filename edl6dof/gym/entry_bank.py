"""Bank angle of the entry, from lift control to the mortar, as near to the aim point as possible."""

from __future__ import annotations

from math import inf, pi

import numpy as np

from edl6dof.gym.task import Feature, StepResult, Task, guide, nav
from edl6dof.interface.roles import LIFT

#: Miss of the aim point at the mortar that counts as done, m.
NEAR_M = 10_000.0


class EntryBank(Task):
    """Action: bank angle over 105 deg.  Reward: at the end 1 less the miss over 20 km, or -1 where the
    parachute may not open there.
    """

    title = "bank angle of the entry"
    size = 1
    role = LIFT
    interval_s, longest_s = 1.0, 300.0
    features = (
        Feature("altitude", 50e3, nav("altitude")),
        Feature("speed", 5000.0, nav("speed")),
        Feature("flight_path_angle", 0.3, nav("flight_path_angle")),
        Feature("drag", 60.0, nav("drag")),
        Feature("bank", pi, nav("bank")),
        Feature("range_to_go", 300e3, guide("range_to_go")),
        Feature("crossrange", 20e3, guide("crossrange")),
        Feature("downrange_to_go", 300e3, guide("downrange_to_go")),
        Feature("drag_ratio", 2.0, guide("drag_ratio")),
        Feature("lift_ratio", 2.0, guide("lift_ratio")),
    )

    @property
    def _largest(self) -> float:
        return np.radians(self.loaded.scenario.flight_software.guidance.entry.bank_max_deg)

    def command(self, actions: np.ndarray) -> None:
        """Command the bank angle."""
        external = self.fleet.memories["external"]
        external["given"]["bank"] = 1
        external["bank"] = actions[:, 0] * self._largest

    def baseline(self) -> np.ndarray:
        """Bank angle of entry guidance."""
        bank = self.fleet.memories["own"]["bank"] / self._largest
        return np.clip(bank, -1.0, 1.0)[:, None].astype(np.float32)

    def result(self) -> StepResult:
        """Over when the mortar fires, or the flight ends before."""
        lost = self.ended()
        over = lost | ~self.in_roles(LIFT)
        limits, navigated = self.loaded.scenario.limits, self.fleet.memories["nav"]
        may_open = (
            ~lost
            & (navigated["mach"] <= (limits.parachute_mach_max or inf))
            & (navigated["dynamic_pressure"] <= (limits.parachute_dynamic_pressure_pa or inf))
        )
        miss = np.abs(self.fleet.memories["guide"]["range_to_go"])
        last = np.where(may_open, np.maximum(1.0 - miss / (2.0 * NEAR_M), -1.0), -1.0)
        return StepResult(np.where(over, last, 0.0), over, over & may_open & (miss <= NEAR_M))
