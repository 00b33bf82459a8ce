"""Pulse-width modulation, duty against delivered impulse: the tables and the picture of docs/modulation.md.

    python tools/modulation.py                      # ten seconds: the law, and the nominal flight
    python tools/modulation.py --figure modulation.png
    python tools/modulation.py -n 100               # also the figures of 100 dispersed flights

The law is measured on the kernels themselves: steady duties go through modulator and valve.  In the flight
every control cycle is looked at: the duty that allocation asks for and the valve intervals that come of it.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from plain_python import LAYOUT, Setting, setting

import edl6dof
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import fly_rows
from edl6dof.fsw.modulation import MODULATION, modulate
from edl6dof.report.figure import Axis, Figure, Panel, Trace
from edl6dof.report.matplotlib_figure import write_figure
from edl6dof.report.palette import GREY
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.sim.flight import Flight, fly
from edl6dof.sim.functions import functions_of
from edl6dof.sim.loop import fly as fly_cycles
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.propulsion.rcs import linear_level

#: Thrusters whose law is shown: one of 250 N, one of 25 N.
SHOWN = ("D1", "F1")
DUTIES = (0.02, 0.03, 0.04, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.96, 0.98, 1.0)
STEADY_CYCLES = 4000  # for which a duty is held
FIGURES = (
    *("propellant_used_kg", "max_attitude_error_powered_deg", "max_roll_error_powered_deg"),
    *("max_rate_powered_deg_s", "max_yaw_rate_lift_deg_s", "touchdown_rate_deg_s", "touchdown_tilt_deg"),
    "touchdown_horizontal_m_s",
)


class Steady(NamedTuple):
    """What a steady duty gives: impulse over that of full thrust, mean width and spacing of pulses (s)."""

    impulse: float
    width: float
    spacing: float


def widths(opens: np.ndarray, closes: np.ndarray) -> np.ndarray:
    """Widths (s) of the pulses that the valve intervals of successive control cycles make, shape
    (pulses,).
    """
    fired = closes > opens
    opens, closes = opens[fired], closes[fired]
    first = np.append(True, opens[1:] > closes[:-1] + 1e-9)[: len(opens)]
    last = np.append(first[1:], True)[: len(opens)]
    return closes[last] - opens[first]


def steady(start: Setting, thruster: int, duty: float, cycle: float) -> Steady:
    """Hold a duty of one thruster through modulator and valve."""
    onboard, rcs = start.arrays["onboard"][0], start.arrays["case"][0]["vehicle"]["rcs"]
    memory, jet = np.zeros(1, MODULATION)[0], rcs["thrusters"][thruster]
    duties = np.zeros(len(memory["residual"]))
    duties[thruster] = duty
    intervals, level, on = np.zeros((2, STEADY_CYCLES)), 0.0, 0.0
    for k in range(STEADY_CYCLES):
        t = k * cycle
        modulate(onboard["modulation"], onboard["vehicle"], duties, t, cycle, memory)
        intervals[:, k] = memory["open_time"][thruster], memory["close_time"][thruster]
        mean, _, level = linear_level(level, jet["rise"], jet["decay"], t, cycle, *intervals[:, k])
        on += mean * cycle
    pulses, time = widths(*intervals), STEADY_CYCLES * cycle
    return (
        Steady(on / time, float(pulses.mean()), time / len(pulses))
        if len(pulses)
        else Steady(0.0, 0.0, np.inf)
    )


def flown(start: Setting, control_cycles: int) -> np.ndarray:
    """Duty, opening and closing (s) of each valve in every control cycle of a flight, shape (3, control
    cycles, thrusters).
    """
    arrays = {name: start.arrays[name].copy() for name in LAYOUT}
    onboard, fsw = arrays["onboard"][0], arrays["fsw"][0]
    every, count = int(onboard["rates"]["control_every"]), int(onboard["vehicle"]["n_thrusters"])
    log, brief = np.zeros(every + 1, TICK), np.zeros(0, BRIEF)
    seen = np.zeros((3, control_cycles, count))
    functions = functions_of(arrays["case"], arrays["onboard"][0])
    for k in range(control_cycles):
        fly_cycles(functions, *arrays.values(), k * every, (k + 1) * every, 0, start.steps, log, brief, 0)
        command = fsw["command"]
        seen[:, k] = (
            fsw["allocation"]["duty"][:count],
            command["valve_open_time"][:count],
            command["valve_close_time"][:count],
        )
    return seen


def law_table(laws: dict[str, list[Steady]]) -> Iterator[str]:
    """The law of the shown thrusters, row by row, as Markdown."""
    yield "| duty | " + " | ".join(f"{name}: impulse | width, ms | every, ms" for name in laws) + " |"
    yield "|---:|" + "---:|---:|---:|" * len(laws)
    for duty, *row in zip(DUTIES, *laws.values(), strict=True):
        cells = (f"{one.impulse:.3f} | {1e3 * one.width:.0f} | {1e3 * one.spacing:.0f}" for one in row)
        yield f"| {duty:g} | " + " | ".join(cells) + " |"


def flight_table(names: list[str], seen: np.ndarray, cycle: float) -> Iterator[str]:
    """Pulses of each group of thrusters in a flight, row by row, as Markdown."""
    sizes = "smallest, median, largest width, ms | wider than the smallest, %"
    yield f"| group | pulses | {sizes} | demanded, s | open, s |"
    yield "|---|---:|---:|---:|---:|---:|"
    for letter in sorted({name[0] for name in names}):
        own = [i for i, name in enumerate(names) if name[0] == letter]
        pulses = np.concatenate([widths(seen[1, :, i], seen[2, :, i]) for i in own])
        asked, least = cycle * seen[0][:, own].sum(), pulses.min()
        sizes = ", ".join(f"{1e3 * size:.0f}" for size in (least, np.median(pulses), pulses.max()))
        wider = 100.0 * np.mean(pulses > least + 1e-6)
        yield f"| {letter} | {len(pulses)} | {sizes} | {wider:.0f} | {asked:.1f} | {pulses.sum():.1f} |"


def openings(flight: Flight) -> dict[str, int]:
    """How often the valves of each group open, from telemetry: a commanded pulse opens a valve that was not
    open to the end of the control cycle before.
    """
    table, every = flight.telemetry, flight.scenario.flight_software.rates.control_every
    cycles, found = (len(table["t_s"]) - 1) // every, {}
    for name in flight.scenario.thruster_names:
        fired = table[f"valve.{name}"][: cycles * every : every] == 1
        open_at_end = fired & (table[f"rcs.{name}"][every : cycles * every + 1 : every] > 0.999)
        key = f"pulses_{name[0]}"
        found[key] = found.get(key, 0) + int(np.sum(fired[1:] & ~open_at_end[:-1]) + fired[0])
    return found


def dispersed_table(count: int) -> Iterator[str]:
    """Figures of dispersed flights, row by row, as Markdown."""
    plan = load_plan("tianwen1_mc")
    rows = list(fly_rows(plan.loaded, plan.cases(0, count), collect=openings))
    yield f"| {count} flights | mean | 95 % |"
    yield "|---|---:|---:|"
    for name in (*(key for key in rows[0] if key.startswith("pulses_")), *FIGURES):
        values = np.array([row[name] for row in rows if row.get(name) is not None], float)
        yield f"| {name} | {values.mean():.4g} | {np.percentile(values, 95):.4g} |"


def draw(laws: dict[str, list[Steady]], seen: np.ndarray, names: list[str], file: Path) -> None:
    """Duty against delivered impulse, duty against width, and the widths in a flight."""
    impulse = [Trace(np.array([0.0, 1.0]), np.array([0.0, 1.0]), colour=GREY, dash="dash")]
    impulse += [
        Trace(np.array(DUTIES), np.array([of.impulse for of in one]), name) for name, one in laws.items()
    ]
    width = [
        Trace(np.array(DUTIES), np.array([1e3 * of.width for of in one]), name) for name, one in laws.items()
    ]
    flight = []
    edges = np.arange(0.0, 401.0, 8.0)
    for letter in sorted({name[0] for name in names}):
        own = [i for i, name in enumerate(names) if name[0] == letter]
        pulses = np.concatenate([widths(seen[1, :, i], seen[2, :, i]) for i in own])
        count = np.histogram(1e3 * pulses, edges)[0].astype(float)
        flight.append(
            Trace(edges[:-1], np.where(count > 0.0, count, np.nan), f"{letter}1 to {len(own)}", "steps")
        )
    panels = [
        Panel(Axis("duty (1)"), Axis("impulse (1 at full thrust)"), impulse),
        Panel(Axis("duty (1)"), Axis("mean width of a pulse (ms)", (0.0, 600.0)), width),
        Panel(Axis("width of a pulse in the nominal flight (ms)"), Axis("pulses", log=True), flight),
    ]
    write_figure(Figure("modulation", "Pulses", panels, columns=3, height=380), file)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-n", type=int, default=0, help="dispersed flights; none")
    parser.add_argument("--figure", type=Path, help="where to draw the picture")
    options = parser.parse_args()
    loaded: LoadedScenario = edl6dof.load("tianwen1")
    names, rates = loaded.scenario.thruster_names, loaded.scenario.flight_software.rates
    cycle = rates.control_every / rates.base_hz
    flight = fly(loaded, save_at_s=0.0)
    assert flight.saved is not None
    start = setting(loaded, flight.saved)
    laws = {name: [steady(start, names.index(name), duty, cycle) for duty in DUTIES] for name in SHOWN}
    seen = flown(start, int(flight.time_s / cycle))
    print(*law_table(laws), "", *flight_table(names, seen, cycle), sep="\n", flush=True)
    if options.figure:
        draw(laws, seen, names, options.figure)
    if options.n:
        print("", *dispersed_table(options.n), sep="\n")


if __name__ == "__main__":
    main()
