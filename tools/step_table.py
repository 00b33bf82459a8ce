"""How far an integration step errs, regime by regime: the table of docs/step.md.

    python tools/step_table.py                    # a minute or two
    python tools/step_table.py --valves shut     # the same without thrusters

From moments of the nominal flight the plant flies on in an open loop: every base cycle it gets the commands
that the flight software gave in that cycle of the flight itself, whatever comes of them, so that nothing is
corrected and all steps get the same.  The end state of each is compared with that of steps of 1/32 of the
base cycle: position in m, attitude in rad.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from plain_python import LAYOUT, Setting, setting

import edl6dof
from edl6dof.interface.roles import HOVER_IMAGING, SLOW_DESCENT, begun
from edl6dof.kernels import kernel
from edl6dof.sim.flight import fly
from edl6dof.sim.functions import functions_of
from edl6dof.sim.loop import fly as fly_cycles
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.actuate import actuate
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate, survey
from edl6dof.vehicle.plant import ATTITUDE, POSITION

#: Steps, in base cycles of 20 ms: 40, 20, 10, 5, 2.5 ms, and what they are compared with.
STEPS = (2.0, 1.0, 1 / 2, 1 / 4, 1 / 8)
REFERENCE = 1 / 32
#: The loop is open for this long, s, unless the regime ends before.
WINDOW_S = 100.0


class Window(NamedTuple):
    """A stretch of the flight that is flown again: its regime, when it begins and how long it lasts, s."""

    regime: str
    begin: float
    length: float


def windows(times: dict[str, float], end: float) -> Iterator[Window]:
    """Windows of all regimes, from when each event of the flight came, s."""
    mortar, stretched = times["mortar"], times["line_stretch"]
    ignition, down = times["ignition"], times["touchdown"]
    for begin in (0.0, 60.0, 100.0, 150.0, mortar - 100.0):
        yield Window("entry", begin, WINDOW_S)
    for begin in (mortar - 0.5, stretched - 0.2, stretched + 0.3):
        yield Window("parachute opens", begin, stretched + 3.0 - begin)
    for begin in (stretched + 3.0, stretched + 40.0, ignition - WINDOW_S - 1.0):
        yield Window("under the parachute", begin, WINDOW_S)
    for begin in (ignition - 0.5, ignition + 10.0, times[begun(HOVER_IMAGING)], times[begun(SLOW_DESCENT)]):
        yield Window("under power", begin, min(20.0, down - 0.5 - begin))
    for begin in (down - 0.5, down - 0.1, down + 0.1):
        yield Window("on the ground", begin, end - begin)


def record_commands(start: Setting, cycles: int) -> np.ndarray:
    """What the flight software commands in each of the cycles after ``start``, in the closed loop."""
    arrays = [start.arrays[name].copy() for name in LAYOUT]
    fsw, log, brief = arrays[-1], np.zeros(2, TICK), np.zeros(0, BRIEF)
    commands = np.zeros(cycles, fsw.dtype["command"])
    functions = functions_of(start.arrays["case"], start.arrays["onboard"][0])
    for k in range(cycles):
        fly_cycles(functions, *arrays, start.cycle + k, start.cycle + k + 1, 0, start.steps, log, brief, 0)
        commands[k] = fsw["command"][0]
    return commands


@kernel
def fly_open_loop(kinds, case, tables, plant, outputs, work, commands, cycle, first, cycles, steps):
    """Fly on from cycle ``first`` with these commands, ``cycles`` of ``cycle`` s in ``steps`` steps."""
    evaluate(case, tables, plant, outputs, work)
    for k in range(0, len(commands), cycles):
        survey(case, tables, plant, outputs)
        actuate(kinds, case, commands[k], plant)
        for j in range(steps):
            t_end = cycle * (first + k + cycles * (j + 1) / steps)
            advance(case, tables, plant, outputs, work, t_end)


def open_loop(start: Setting, commands: np.ndarray, share: float, cycle: float) -> np.ndarray:
    """State at the end of the commands, flown in steps of ``share`` base cycles of ``cycle`` s."""
    plant, cases = start.arrays["plant"].copy(), start.arrays["case"].copy()
    for kind in ("canopy_step", "contact_step"):
        cases["simulation"][kind] = share * cycle
    records = {**start.arrays, "plant": plant, "case": cases}
    flown = [records[name][0] for name in ("case", "tables", "plant", "outputs", "work")]
    cycles, steps = max(round(share), 1), max(round(1.0 / share), 1)
    _, _, _, kinds = functions_of(cases, start.arrays["onboard"][0])
    fly_open_loop(kinds, *flown, commands, cycle, start.cycle, cycles, steps)
    return plant["y"][0]


def errors(end: np.ndarray, true: np.ndarray) -> tuple[float, float]:
    """Differences of two states in position (m) and attitude (rad)."""
    place = slice(POSITION, POSITION + 3)
    turn = slice(ATTITUDE, ATTITUDE + 4)
    return float(np.linalg.norm(end[place] - true[place])), 2.0 * float(
        np.linalg.norm(end[turn] - true[turn])
    )


def table(valves: str) -> Iterator[str]:
    """The table, row by row, as Markdown."""
    loaded = edl6dof.load("tianwen1")
    nominal = fly(loaded)
    times = {event["key"]: float(event["t_s"]) for event in nominal.events}
    times |= {begun(event["role"]): float(event["t_s"]) for event in nominal.events if "role" in event}
    cycle = 1.0 / loaded.scenario.flight_software.rates.base_hz
    steps = " | ".join(f"{1e3 * cycle * share:g} ms" for share in STEPS)
    yield f"| part of the flight | start, s | length, s | {steps} |"
    yield "|---|---:|---:|" + "---:|" * len(STEPS)
    for window in windows(times, float(nominal.log["t"][-1])):
        # control acts in every other cycle
        state = fly(loaded, save_at_s=2 * cycle * round(window.begin / cycle / 2)).saved
        assert state is not None
        start = setting(loaded, state)
        commands = record_commands(start, 2 * int(window.length / cycle / 2))
        if valves == "shut":
            start.arrays["plant"]["valves"]["level"] = 0.0
            commands["close_time"] = commands["open_time"]
        true = open_loop(start, commands, REFERENCE, cycle)
        gaps = (errors(open_loop(start, commands, share, cycle), true) for share in STEPS)
        cells = " | ".join(f"{metres:.0e} m, {radians:.0e}" for metres, radians in gaps)
        yield f"| {window.regime} | {window.begin:.1f} | {window.length:.1f} | {cells} |"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--valves", choices=("recorded", "shut"), default="recorded")
    for row in table(parser.parse_args().valves):
        print(row, flush=True)


if __name__ == "__main__":
    main()
