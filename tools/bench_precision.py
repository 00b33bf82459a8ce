"""A section of bench.py: speed at equal error, of free entries of 250 s (work-precision diagram).

Each program flies its own entry without control (``tools/peers_*.py`` say what it has and lacks) with several
steps.  The error is the distance from its own solution with the finest step, which is not shown.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.report.matplotlib_figure import write_figure
from edl6dof.report.palette import SERIES

SECONDS = 250.0
#: Errors of position at which the programs are compared, m.
LEVELS_M = (1.0, 0.1, 0.01)
#: Parameters of our free entry: the vehicle without mission and with sensors that know the state, as the
#: peers have neither instruments nor navigation.
FREE_ENTRY = (
    "mission.phases=[]",
    "sensors.set=perfect",
    f"simulation.time_limit_s={SECONDS:g}",
    "simulation.log_every=1000",
)


@dataclass
class End:
    """Cost of an entry, and where it ended: position (m), attitude as any coordinates whose small differences
    are angles (rad).
    """

    cpu_s: float
    position: np.ndarray
    attitude: np.ndarray


@dataclass
class Point:
    """A point of the diagram: simulated seconds per CPU second, errors in m and deg."""

    step_s: float
    speed: float
    position_m: float
    attitude_deg: float


def ours(step_s: float) -> End:
    """An entry of edl6dof; base cycle and step are the same down to 20 ms, where the cycle stays."""
    from edl6dof.scenario.loading import load_scenario
    from edl6dof.sim.flight import fly
    from edl6dof.vehicle.plant import ATTITUDE, POSITION

    rate = min(50, round(1.0 / step_s))
    steps = (f"simulation.step_s={step_s:g}", f"flight_software.rates.base_hz={rate}")
    scenario = load_scenario("tianwen1", [*FREE_ENTRY, *steps])
    cpu = time.process_time()
    y = fly(scenario).plant["y"][0]
    cpu = time.process_time() - cpu
    # twice the vector part of a quaternion near unity is an angle; the difference of two has the same length
    return End(cpu, y[POSITION : POSITION + 3].copy(), 2.0 * y[ATTITUDE : ATTITUDE + 4])


def jsbsim(step_s: float) -> End:
    """An entry of JSBSim."""
    import peers_jsbsim as peer

    _, cpu, end = peer.run_with(step_s)
    position = peer.FOOT * np.array([end[name] for name in peer.POSITION])
    return End(cpu, position, np.array([end[name] for name in peer.ATTITUDE]))


def basilisk(step_s: float) -> End:
    """An entry of Basilisk without thrusters and control."""
    import peers_basilisk as peer

    _, cpu, position, _, parameters, _ = peer.run_with(step_s, SECONDS, controlled=False)
    return End(cpu, np.array(position), 4.0 * np.array(parameters))


#: Programs and their steps (s), the finest first.
PROGRAMS: dict[str, tuple[Callable[[float], End], tuple[float, ...]]] = {
    "edl6dof": (ours, (0.001, 0.0025, 0.005, 0.01, 0.02, 0.04, 0.05, 0.1)),
    "JSBSim": (jsbsim, (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05)),
    "Basilisk": (basilisk, (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1)),
}


@dataclass
class Precision:
    """Points of each program, and simulated seconds per CPU second of the whole flight on instruments, whose
    step is ``WHOLE_STEP_S``.
    """

    programs: dict[str, list[Point]]
    whole_flight: float


#: Step of the whole flight, s; its error is that of the free entry with this step.
WHOLE_STEP_S = 0.02


def whole_flight() -> float:
    """Simulated seconds per CPU second of the nominal flight on instruments, from entry to rest."""
    from edl6dof.scenario.loading import load_scenario
    from edl6dof.sim.flight import fly

    scenario = load_scenario("tianwen1", ["simulation.log_every=1000"])
    assert scenario.scenario.simulation.step_s == WHOLE_STEP_S
    cpu = time.process_time()
    flight = fly(scenario)
    return float(flight.telemetry["t_s"][-1]) / (time.process_time() - cpu)


def measure_precision(repeats: int) -> Precision:
    """Points of each program that is installed; the steps of all programs in turn, ``repeats`` times."""
    ends: dict[str, list[list[End]]] = {}
    whole = []
    for _ in range(repeats + 1):
        whole.append(whole_flight())
        for name, (run, steps) in PROGRAMS.items():
            try:
                ends.setdefault(name, []).append([run(step) for step in steps])
            except ImportError:
                ends.pop(name, None)
    programs = {name: _points(PROGRAMS[name][1], rounds[1:]) for name, rounds in ends.items()}
    return Precision(programs, statistics.median(whole[1:]))


def _points(steps: Sequence[float], rounds: list[list[End]]) -> list[Point]:
    exact = rounds[0][0]
    return [
        Point(
            step,
            SECONDS / statistics.median(ends[i].cpu_s for ends in rounds),
            float(np.linalg.norm(rounds[0][i].position - exact.position)),
            math.degrees(float(np.linalg.norm(rounds[0][i].attitude - exact.attitude))),
        )
        for i, step in enumerate(steps)
        if i > 0
    ]


def speed_at(points: list[Point], error_m: float) -> float | None:
    """Simulated seconds per CPU second at an error of position, between the two points around it on
    logarithmic axes; ``None`` if there are no such points.
    """
    for fine, coarse in zip(points, points[1:], strict=False):
        if fine.position_m <= error_m <= coarse.position_m:
            share = math.log(error_m / fine.position_m) / math.log(coarse.position_m / fine.position_m)
            return fine.speed * (coarse.speed / fine.speed) ** share
    return None


def draw_precision(programs: dict[str, list[Point]], path: Path) -> None:
    """Draw the diagram: error of position and of attitude against speed."""
    panels = []
    for title, name in (
        ("position", "position_m"),
        ("attitude", "attitude_deg"),
    ):
        traces = []
        for (program, points), symbol, colour in zip(
            programs.items(), ("circle", "square", "diamond"), SERIES, strict=False
        ):
            errors = np.array([getattr(point, name) for point in points])
            speeds = np.array([point.speed for point in points])
            traces.append(Trace(errors, speeds, program, colour=colour))
            traces.append(
                Trace(errors, speeds, program, "points", colour, symbol=symbol, width=3.0, legend=False)
            )
        speed = Axis("simulated seconds per CPU second (1)", log=True)
        panels.append(
            Panel(Axis(f"error of {title} after 250 s ({name.rpartition('_')[2]})", log=True), speed, traces)
        )
    title = "Speed at equal error of free entries"
    write_figure(Figure("precision", title, panels, columns=2, height=400), path)
