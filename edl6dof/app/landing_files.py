"""The designed landing as a table of states and as a figure."""

from __future__ import annotations

from math import degrees
from pathlib import Path

import numpy as np

from edl6dof.design.landing.rigid_body import RigidLanding, tilt_of
from edl6dof.report.figure import GREY, Axis, Figure, Mark, Panel, Trace

#: Time (s), states, controls, and angles of the thrust axis from the vertical.
COLUMNS = (
    *("t_s", "mass_kg", "east_m", "north_m", "up_m", "v_east_m_s", "v_north_m_s", "v_up_m_s"),
    *("q_S2L_w", "q_S2L_x", "q_S2L_y", "q_S2L_z", "rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s"),
    *("thrust_n", "torque_x_nm", "torque_y_nm", "torque_z_nm", "tilt_deg"),
)


def write_states(path: Path, t: np.ndarray, x: np.ndarray, u: np.ndarray) -> None:
    """Write states and controls as CSV; axes of rates and torques are S (:mod:`...landing.rigid_body`)."""
    rows = np.column_stack([t, x[:, :11], np.degrees(x[:, 11:]), u, np.degrees(tilt_of(x))])
    np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=",".join(COLUMNS), comments="")


def landing_figure(
    name: str,
    landing: RigidLanding,
    designed: tuple[np.ndarray, np.ndarray, np.ndarray],
    law: str,
    own: tuple[np.ndarray, np.ndarray],
) -> Figure:
    """Path, thrust, tilt and rate of the designed landing (times, states, controls), beside those that the
    scenario's law flew (times, states).
    """
    t, x, u = designed

    def both(panel: str, unit: str, of: tuple[np.ndarray, np.ndarray], limit: float) -> Panel:
        traces = [Trace(t, of[0], "designed"), Trace(own[0], of[1], law)]
        return Panel(
            Axis("time from ignition (s)"),
            Axis(f"{panel} ({unit})"),
            traces,
            marks=[Mark("y", limit, "limit")],
        )

    rates = tuple(np.degrees(np.linalg.norm(states[:, 11:], axis=1)) for states in (x, own[1]))
    tilts = tuple(np.degrees(tilt_of(states)) for states in (x, own[1]))
    panels = [
        _path(landing, x, law, own[1]),
        Panel(
            Axis("time from ignition (s)"),
            Axis("thrust (N)"),
            [Trace(t, u[:, 0], "designed")],
            marks=[Mark("y", level, "", GREY) for level in landing.thrust],
        ),
        both("tilt", "deg", (tilts[0], tilts[1]), degrees(landing.tilt)),
        both("body rate", "deg/s", (rates[0], rates[1]), degrees(landing.rate)),
    ]
    return Figure("landing", f"{name}: powered landing", panels, columns=2, height=360)


def _path(landing: RigidLanding, x: np.ndarray, law: str, own: np.ndarray) -> Panel:
    """Height over the distance from the target, positive on the side of the start."""
    start = landing.start[1:3] / max(float(np.linalg.norm(landing.start[1:3])), 1e-9)
    traces = [
        Trace(states[:, 1:3] @ start, states[:, 3], who) for states, who in ((x, "designed"), (own, law))
    ]
    return Panel(Axis("towards the start (m)"), Axis("height over the target (m)"), traces, equal=True)
