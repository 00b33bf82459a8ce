"""From the log record to named columns in the units of their names."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from edl6dof.sim.channels import CHANNELS
from edl6dof.vehicle.faults import THRUSTER_KINDS


def columns(log: np.ndarray, thrusters: Sequence[str]) -> dict[str, np.ndarray]:
    """``t_s``, every channel, ``rcs.<thruster>`` (mean duty of the last step, 0..1) and ``fault.<thruster>`` (0 for none).

    Columns are views of the log where no unit changes.
    """
    table = {"t_s": log["t"]}
    for channel in CHANNELS:
        values = log[channel.group][channel.field]
        table[channel.name] = values if channel.from_si == 1.0 else values * channel.from_si
    for index, name in enumerate(thrusters):
        table[f"rcs.{name}"] = log["duty"][:, index]
        table[f"fault.{name}"] = log["fault"][:, index]
    return table


def describe(name: str) -> tuple[str, str]:
    """Unit and meaning of a telemetry column."""
    if name == "t_s":
        return "s", "time since the initial state"
    if name.startswith("rcs."):
        return "", f"mean thrust fraction of thruster {name[4:]} over the last integration step"
    if name.startswith("fault."):
        codes = ", ".join(f"{number} {kind.replace('_', ' ')}" for number, kind in enumerate(THRUSTER_KINDS, 1))
        return "", f"true state of thruster {name[6:]}: 0 works, {codes}"
    channel = _BY_NAME[name]
    return channel.unit, channel.meaning


_BY_NAME = {channel.name: channel for channel in CHANNELS}
