"""Phase planes: attitude error against rate, with the zones of the controller that flew.

The borders of the zones follow from the gains of the scenario.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from edl6dof.report.figure import (
    AXIS,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    Axis,
    Figure,
    Mark,
    Panel,
    Trace,
)
from edl6dof.report.flight.parts import has_signal
from edl6dof.report.zones import AIMED_FOR, FIRING, zones_of
from edl6dof.runs.run import Run
from edl6dof.spatial import rotations

AXES = ("roll", "pitch", "yaw")
RATES = ("p", "q", "r")
COLOURS = (BLUE, VERMILION, PURPLE, ORANGE, SKY)
TITLES = {
    "phase_plane": "trim angle of attack (three-axis phase plane)",
    "bank_to_steer": "lift control (bank to steer)",
    "rate_damping": "under the parachute (rate damping)",
    "thrust_vector": "powered descent (thrust vector)",
}

#: What green lines of a name are.
_GREEN = {AIMED_FOR: "the rate that it aims for", FIRING: "where it begins to fire"}


def figures(run: Run) -> Iterator[Figure]:
    """One figure for each controller that flew; a point mass has none."""
    if not any(has_signal(run, f"truth.rate_{axis}_deg_s") for axis in RATES):
        return
    phases = run.scenario["mission"]["phases"]
    flown = run["guide.phase"].astype(int) if phases else np.zeros(len(run.t), int)
    for name in dict.fromkeys(phase["control"] for phase in phases):
        indices = [i for i, phase in enumerate(phases) if phase["control"] == name and np.any(flown == i)]
        if indices and name != "off":
            yield phase_plane(run, name, [(phases[i]["name"], flown == i) for i in indices])


def phase_plane(run: Run, control: str, phases: Sequence[tuple[str, np.ndarray]]) -> Figure:
    """Roll, pitch and yaw planes of one controller, one colour for each of its phases."""
    gains = run.scenario["flight_software"]["control"].get(control, {})
    rates, cycles = control_rates(run, control), control_cycles(run)
    panels = []
    for axis, name in enumerate(AXES):
        if axis > 0 and not any(
            np.median(np.abs(run[f"control.error_{name}_deg"][rows])) > 0.0 for _, rows in phases
        ):
            continue  # damped only: shown in the plane of the two rates below
        traces = [
            Trace(
                run[f"control.error_{name}_deg"][rows & cycles],
                rates[axis][rows & cycles],
                phase.replace("_", " "),
                colour=COLOURS[k % len(COLOURS)],
            )
            for k, (phase, rows) in enumerate(phases)
        ]
        word = "bank" if control == "bank_to_steer" and axis == 0 else name
        panels.append(_panel(word, traces, *borders(gains, axis)))
    if len(panels) == 1:
        panels.append(_damped(gains, rates, phases))
    caption = (
        f"{_lines(panels)}Axes are cut to the flown part and the nearest borders, which are drawn for the "
        "gains at bandwidth 1."
    )
    title = f"Phase planes, {TITLES.get(control, control.replace('_', ' '))}"
    return Figure(f"phase_plane_{control}", title, panels, caption, len(panels), height=330)


def _lines(panels: Sequence[Panel]) -> str:
    """What the colours of the lines mean that are drawn, as a sentence."""
    grey = any(mark.colour != AXIS for panel in panels for mark in panel.marks)
    names = {trace.name for panel in panels for trace in panel.traces}
    said = ["grey: zone borders of the controller"] * grey
    said += [f"green: {words}" for name, words in _GREEN.items() if name in names]
    words = "; ".join(said)
    return f"{words[0].upper()}{words[1:]}. " if words else ""


def _damped(
    gains: Mapping[str, Any], rates: Sequence[np.ndarray], phases: Sequence[tuple[str, np.ndarray]]
) -> Panel:
    """Yaw against pitch rate of a controller that damps them and follows no angle, with the rates that it
    leaves alone.
    """
    traces = [
        Trace(rates[1][rows], rates[2][rows], phase.replace("_", " "), colour=COLOURS[k % len(COLOURS)])
        for k, (phase, rows) in enumerate(phases)
    ]
    marks = [Mark(axis, mark.at, colour=GREY) for mark in borders(gains, 1)[1] for axis in ("x", "y")]
    x, y = (_span(np.concatenate([getattr(trace, axis) for trace in traces]), axis, marks) for axis in "xy")
    return Panel(Axis("pitch rate (deg/s)", x), Axis("yaw rate (deg/s)", y), traces, marks=marks)


def _panel(word: str, traces: list[Trace], lines: list[Trace], marks: list[Mark]) -> Panel:
    spans = [_span(np.concatenate([getattr(trace, axis) for trace in traces]), axis, marks) for axis in "xy"]
    x, y = Axis(f"{word} error (deg)", spans[0]), Axis(f"{word} rate (deg/s)", spans[1])
    zero = [Mark(axis, 0.0, colour=AXIS, dash="solid") for axis in ("x", "y")]
    return Panel(x, y, [*lines, *traces], marks=[*zero, *marks])


def _span(values: np.ndarray, axis: str, marks: Sequence[Mark]) -> tuple[float, float]:
    """A symmetric range over what was flown and the nearest border beyond it."""
    size = float(np.nanmax(np.abs(values), initial=0.1))
    beyond = [abs(mark.at) for mark in marks if mark.axis == axis and size < abs(mark.at) < 3.0 * size]
    reach = 1.12 * max(size, min(beyond, default=0.0))
    return -reach, reach


def control_cycles(run: Run) -> np.ndarray:
    """Rows (bool) in which the controller has just run: in others the error of telemetry is an old one, which
    beside the present rate would draw steps that were not flown.
    """
    errors = np.stack([run[f"control.error_{axis}_deg"] for axis in AXES])
    return np.append(False, np.any(np.diff(errors) != 0.0, axis=0))


def control_rates(run: Run, control: str) -> list[np.ndarray]:
    """The rates (deg/s, three of shape (rows,)) that a controller compares with the attitude error.

    In the air the goal turns with the velocity, so its turning is taken off; bank to steer splits the rest
    into that about the velocity and the swing of the air angles.
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
    """Rate at which the planet-relative velocity turns, deg/s in B, shape (3, rows), by differences of the
    telemetry.
    """
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
    """Zone borders of one axis of a controller as lines and marks."""
    zones = zones_of(gains, axis)
    x, y = (np.concatenate([-half[::-1], [np.nan], half]) for half in (zones.error, zones.rate))
    lines = [Trace(x, y, zones.name, colour=GREEN, width=2.0, border=True)] if zones.name else []
    marks = [Mark("x", sign * at, colour=GREY) for at in zones.errors for sign in (-1.0, 1.0)]
    return lines, marks + [Mark("y", sign * at, colour=GREY) for at in zones.rates for sign in (-1.0, 1.0)]
