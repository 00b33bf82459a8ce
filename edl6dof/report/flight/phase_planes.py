"""Phase planes: attitude error against rate, with the zones of the active controller.

Borders of the zones follow from the gains of the scenario.  Error is goal minus actual and rate is actual
minus goal, so that a controlled vehicle moves through the first and third quadrants towards the origin.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from edl6dof.report.figure import Axis, Figure, Mark, Panel, Trace
from edl6dof.report.flight.common import has_signal
from edl6dof.report.palette import AXIS, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from edl6dof.runs.run import Run
from edl6dof.spatial import rotations

AIMED_FOR, FIRING = "rate aimed for", "firing begins"
AXES = ("roll", "pitch", "yaw")
RATES = ("p", "q", "r")
COLOURS = (BLUE, VERMILION, PURPLE, ORANGE, SKY)
TITLES = {
    "phase_plane": "trim angle of attack (three-axis phase plane)",
    "bank_to_steer": "lift control (bank to steer)",
    "rate_damping": "under the parachute (rate damping)",
    "thrust_vector": "powered descent (thrust vector)",
}
#: Meaning of the green lines by their name, for the caption.
_GREEN = {AIMED_FOR: "the rate that it aims for", FIRING: "where it begins to fire"}


def figures(run: Run) -> Iterator[Figure]:
    """Draw one figure for each controller that was active; none for a point mass."""
    if not has_signal(run, *(f"truth.rate_{axis}_deg_s" for axis in RATES)):
        return
    phases = run.scenario["mission"]["phases"]
    flown = run["guide.phase"].astype(int) if phases else np.zeros(len(run.t), int)
    for name in dict.fromkeys(phase["control"] for phase in phases):
        indices = [i for i, phase in enumerate(phases) if phase["control"] == name and np.any(flown == i)]
        if indices and name != "off":
            yield phase_plane(run, name, [(phases[i]["name"], flown == i) for i in indices])


def phase_plane(run: Run, control: str, phases: Sequence[tuple[str, np.ndarray]]) -> Figure:
    """Draw roll, pitch and yaw planes of one controller, one colour for each of its phases."""
    gains = run.scenario["flight_software"]["control"].get(control, {})
    rates, cycles = control_rates(run, control), control_cycles(run)
    panels = []
    for axis, name in enumerate(AXES):
        error = run[f"control.error_{name}_deg"]
        if axis > 0 and not any(np.median(np.abs(error[rows])) > 0.0 for _, rows in phases):
            continue  # only damped: its rate is in the plane of rates below
        ways = _ways(error, rates[axis], [(phase, rows & cycles) for phase, rows in phases])
        word = "bank" if control == "bank_to_steer" and axis == 0 else name
        lines, marks = borders(gains, axis)
        panel = _plane(f"{word} error (deg)", f"{word} rate (deg/s)", ways, marks)
        zero = [Mark(across, 0.0, colour=AXIS, dash="solid") for across in ("x", "y")]
        panels.append(replace(panel, traces=[*lines, *ways], marks=[*zero, *marks]))
    if len(panels) == 1:  # add the plane of yaw rate over pitch rate
        marks = [Mark(axis, mark.at, colour=GREY) for mark in borders(gains, 1)[1] for axis in ("x", "y")]
        ways = _ways(rates[1], rates[2], phases)
        panels.append(_plane("pitch rate (deg/s)", "yaw rate (deg/s)", ways, marks))
    caption = "Axes are cut to the flown part and the nearest borders, which are drawn for the gains at "
    caption = f"{_meanings(panels)}{caption}bandwidth 1."
    title = f"Phase planes, {TITLES.get(control, control.replace('_', ' '))}"
    return Figure(f"phase_plane_{control}", title, panels, caption, len(panels), height=330)


def _ways(x: np.ndarray, y: np.ndarray, phases: Sequence[tuple[str, np.ndarray]]) -> list[Trace]:
    """Curves of the path in a plane, one colour for each phase."""
    return [
        Trace(x[rows], y[rows], phase.replace("_", " "), colour=COLOURS[k % len(COLOURS)])
        for k, (phase, rows) in enumerate(phases)
    ]


def _plane(across: str, up: str, ways: list[Trace], marks: list[Mark]) -> Panel:
    """A plane with axes symmetric about zero, from the flown part to the nearest border."""

    def span(axis: str) -> tuple[float, float]:
        flown = np.concatenate([getattr(way, axis) for way in ways])
        size = float(np.nanmax(np.abs(flown), initial=0.1))
        beyond = [abs(mark.at) for mark in marks if mark.axis == axis and size < abs(mark.at) < 3.0 * size]
        reach = 1.12 * max(size, min(beyond, default=0.0))
        return -reach, reach

    return Panel(Axis(across, span("x")), Axis(up, span("y")), ways, marks=marks)


def _meanings(panels: Sequence[Panel]) -> str:
    """A sentence about the colours of the lines that are drawn."""
    grey = any(mark.colour != AXIS for panel in panels for mark in panel.marks)
    names = {trace.name for panel in panels for trace in panel.traces}
    found = ["grey: zone borders of the controller"] * grey
    found += [f"green: {words}" for name, words in _GREEN.items() if name in names]
    return f"{'; '.join(found).capitalize()}. " if found else ""


def control_cycles(run: Run) -> np.ndarray:
    """Return the rows (bool) in which the controller has just run; other rows repeat its previous error."""
    errors = np.stack([run[f"control.error_{axis}_deg"] for axis in AXES])
    return np.append(False, np.any(np.diff(errors) != 0.0, axis=0))


def control_rates(run: Run, control: str) -> list[np.ndarray]:
    """Return the rates (deg/s, three of shape (rows,)) that a controller compares with the attitude error.

    In the atmosphere the commanded attitude turns with the velocity, whose turning rate is therefore
    subtracted. For bank to steer the rest is split into the rate about the velocity and the rates about y and
    z of B that change the angles of attack and sideslip.
    """
    body = np.stack([run[f"truth.rate_{axis}_deg_s"] for axis in RATES])
    if control not in ("phase_plane", "bank_to_steer"):
        return list(body)
    rate = body - path_rate(run)
    if control == "phase_plane":
        return list(rate)
    alpha, beta = (np.radians(run[f"truth.{angle}_deg"]) for angle in ("alpha", "beta"))
    along = np.stack([np.cos(alpha) * np.cos(beta), np.sin(beta), np.sin(alpha) * np.cos(beta)])
    bank = np.sum(rate * along, axis=0)
    swing = rate - bank * along
    return [bank, swing[1], swing[2]]


@np.errstate(over="ignore", invalid="ignore")  # numbers of a flight that diverged
def path_rate(run: Run) -> np.ndarray:
    """Return the rate (deg/s in B) at which the planet-relative velocity turns, shape (3, rows)."""
    spin = float(run.scenario["planet"]["rotation_rate_rad_s"])
    position, velocity = (
        np.stack([run[f"truth.{name}_I_{axis}_{unit}"] for axis in "xyz"], 1)
        for name, unit in (("r", "m"), ("v", "m_s"))
    )
    velocity = velocity - np.cross([0.0, 0.0, spin], position)
    # a flight that ended in its first cycle has one row, and no differences
    acceleration = np.gradient(velocity, run.t, axis=0) if len(run.t) > 1 else np.zeros_like(velocity)
    turning = np.cross(velocity, acceleration) / np.maximum(np.sum(velocity**2, axis=1), 1.0)[:, None]
    to_body = np.stack([run["truth.q_I2B_w"], *(-run[f"truth.q_I2B_{c}"] for c in "xyz")], 1)
    return np.degrees(rotations.rotate(to_body, turning)).T


def borders(gains: Mapping[str, Any], axis: int) -> tuple[list[Trace], list[Mark]]:
    """Return the zone borders of one axis of a controller as lines and marks."""
    zones = zones_of(gains, axis)
    x, y = (np.concatenate([-half[::-1], [np.nan], half]) for half in (zones.error, zones.rate))
    lines = [Trace(x, y, zones.name, colour=GREEN, width=2.0, border=True)] if zones.name else []
    marks = [Mark("x", sign * at, colour=GREY) for at in zones.errors for sign in (-1.0, 1.0)]
    return lines, marks + [Mark("y", sign * at, colour=GREY) for at in zones.rates for sign in (-1.0, 1.0)]


class Zones(NamedTuple):
    """Zone borders of one axis; each one also exists reflected through the origin.

    Attributes:
        name: name of the curved border; empty if there is none.
        error, rate: points of the curved border, deg and deg/s, shape (n,).
        errors, rates: positions of the straight borders, deg and deg/s, positive.
    """

    name: str = ""
    error: np.ndarray = np.empty(0)
    rate: np.ndarray = np.empty(0)
    errors: tuple[float, ...] = ()
    rates: tuple[float, ...] = ()


def zones_of(gains: Mapping[str, Any], axis: int) -> Zones:
    """Return the borders of a controller for axis 0 roll, 1 pitch, 2 yaw; empty for unknown gains."""
    zone = gains.get("roll" if axis == 0 else "pitch_yaw") or (gains.get("bank") if axis == 0 else None)
    try:
        if "deadband_deg" in gains:
            limit = gains["rate_limit_deg_s"]
            rate = np.linspace(-1.1 * limit, limit, 169)
            return Zones(FIRING, firing_error(gains, rate), rate, (gains["deadband_deg"],), (limit,))
        if zone:
            near, far = zone["near_deg"], zone["far_deg"]
            error = np.concatenate([np.linspace(near, far, 60), [far * 1.0001, 180.0]])
            return Zones(AIMED_FOR, error, aimed_rate(zone, error), (near, far), (1.15 * zone["rate_deg_s"],))
    except KeyError:  # unknown gains under known names: no borders
        return Zones()
    found = ([gains[name]] if name in gains else [] for name in ("angle_limit_deg", "rate_deadband_deg_s"))
    return Zones("", np.empty(0), np.empty(0), *map(tuple, found))


def aimed_rate(zone: Mapping[str, Any], error: np.ndarray) -> np.ndarray:
    """Return the rate (deg/s) that the controller aims for at errors (deg, positive) outside the PID zone.

    The rate starts with that of the PID law at the border of its zone, and grows along a parabola of constant
    deceleration.  Source: Hu et al. 2022, section 4.1.
    """
    inner = zone["proportional"] / max(zone["derivative"], 1e-9) * zone["near_deg"]
    parabola = np.sqrt(inner**2 + 2.0 * zone["deceleration_deg_s2"] * (error - zone["near_deg"]))
    return np.minimum(np.where(error > zone["far_deg"], zone["rate_deg_s"], parabola), zone["rate_deg_s"])


def firing_error(gains: Mapping[str, Any], rate: np.ndarray) -> np.ndarray:
    """Return the least error (deg) at which the phase-plane law fires towards growing angle, by rate (deg/s).

    Source: Hu et al. 2022, section 3.
    """
    bend = rate * np.abs(rate) / (2.0 * gains["acceleration_deg_s2"])
    return gains["deadband_deg"] + bend + gains["lead_s"] * rate
