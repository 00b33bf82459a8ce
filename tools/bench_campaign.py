"""Speed of campaigns: dispersed flights per second and core, cost of everything around the flights, size of a
row; beside JSBSim.

    python tools/bench_campaign.py                    # 1,000 flights; a minute and a half on two idle cores
    python tools/bench_campaign.py -n 100 --json bench_campaign.json

Rounds of the shipped campaign are flown alternately by one thread and by one thread for each core, and in
every round JSBSim flies its own nearest case (``tools/peers_jsbsim.py``, which says what that contains and
lacks), so that all share the machine's good and bad moments.  CPU seconds repeat on a machine with other
work, wall seconds do not; the machine's load is printed with them.

outside      CPU seconds of a case outside the compiled loop, over those inside it: all that follows
campaign's   what the campaign adds to a flight, over the same: drawing, validating, building records, reading
back, row; not the figures
             of the flight, which a flight flown alone forms too
efficiency   flights per CPU second with all threads over those with one thread
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from threading import Lock

import peers_jsbsim
from rich.console import Console
from rich.table import Table

from edl6dof.campaign import run
from edl6dof.campaign.design.plan import Plan, load_plan
from edl6dof.campaign.engines import Threads
from edl6dof.campaign.executor import CaseRunner, available_cores
from edl6dof.campaign.store import Store
from edl6dof.sim import flight, flight_state

CAMPAIGN = "tianwen1_mc"
ROUNDS = 5


@dataclass
class Cost:
    """What some flights cost."""

    flights: int = 0
    wall_s: float = 0.0
    cpu_s: float = 0.0
    loop_s: float = 0.0
    figures_s: float = 0.0
    steps: int = 0

    @property
    def per_cpu_second(self) -> float:
        """Flights per CPU second: flights per second and core of a machine without other work."""
        return self.flights / self.cpu_s

    @property
    def outside(self) -> float:
        """CPU time outside the compiled loop over that inside."""
        return self.cpu_s / self.loop_s - 1.0

    @property
    def overhead(self) -> float:
        """CPU time neither in the compiled loop nor for the figures of the flight, over that in the loop."""
        return (self.cpu_s - self.figures_s) / self.loop_s - 1.0

    @property
    def ns_per_step(self) -> float:
        """CPU nanoseconds of the compiled loop for each integration step."""
        return 1e9 * self.loop_s / self.steps


class LoopClock:
    """Adds up the CPU time of the compiled loop over all threads."""

    def __init__(self, compiled: Callable[..., tuple[int, int, int]]):
        self.compiled, self.cpu_s, self.steps, self.lock = compiled, 0.0, 0, Lock()

    def __call__(self, *arguments: object) -> tuple[int, int, int]:
        """Call the loop; its argument 12 is the number of integration steps in a cycle, and it returns how
        many cycles it flew.
        """
        began = time.thread_time()
        result = self.compiled(*arguments)
        with self.lock:
            self.cpu_s += time.thread_time() - began
            self.steps += result[1] * arguments[13]
        return result


class FigureClock:
    """Adds up the CPU time in which the figures of flights are formed, over all threads."""

    def __init__(self, form: Callable[[flight.Flight], dict[str, float]]):
        self.form, self.cpu_s, self.lock = form, 0.0, Lock()

    def __call__(self, flown: flight.Flight) -> dict[str, float]:
        """Form them."""
        began = time.thread_time()
        result = self.form(flown)
        with self.lock:
            self.cpu_s += time.thread_time() - began
        return result


def fly(
    plan: Plan,
    runner: CaseRunner,
    first: int,
    last: int,
    workers: int,
    cost: Cost,
    clock: LoopClock,
    figures: FigureClock,
) -> None:
    """Fly some cases and add what they cost."""
    wall, cpu, loop, steps, formed = (
        time.perf_counter(),
        time.process_time(),
        clock.cpu_s,
        clock.steps,
        figures.cpu_s,
    )
    flown = sum(1 for _ in runner.rows(plan.cases(first, last), workers))
    cost.flights += flown
    cost.wall_s += time.perf_counter() - wall
    cost.cpu_s += time.process_time() - cpu
    cost.loop_s += clock.cpu_s - loop
    cost.steps += clock.steps - steps
    cost.figures_s += figures.cpu_s - formed


def fly_jsbsim(cost: Cost) -> None:
    """One entry of JSBSim."""
    wall, cpu, _ = peers_jsbsim.run()
    cost.flights, cost.wall_s, cost.cpu_s, cost.loop_s = (
        cost.flights + 1,
        cost.wall_s + wall,
        cost.cpu_s + cpu,
        cost.loop_s + cpu,
    )
    cost.steps += peers_jsbsim.STEPS


def bytes_per_case(cases: int) -> float:
    """Size of the finished table."""
    with tempfile.TemporaryDirectory() as folder:
        plan, store = load_plan(CAMPAIGN, cases=cases), Store(Path(folder) / "out")
        run.begin(plan, store, None)
        run.fly(plan, store, Threads())
        return (store.folder / "cases.parquet").stat().st_size / cases


def has_jsbsim() -> bool:
    """Whether JSBSim is installed."""
    try:
        peers_jsbsim.version()
    except ImportError:
        return False
    return True


def measure(cases: int, console: Console) -> dict[str, Cost]:
    """Fly everything in rounds."""
    plan, cores = load_plan(CAMPAIGN, cases=cases), available_cores()
    clock = LoopClock(flight_state.fly_cycles)
    flight_state.fly_cycles = clock
    figures = FigureClock(flight.Flight.figures.func)
    flight.Flight.figures.func = figures
    one, every = "1 thread", f"{cores} threads"
    costs = {one: Cost(), every: Cost()}
    runner = CaseRunner(plan.loaded)
    fly(plan, runner, 0, 2, 1, Cost(), clock, figures)  # compile
    share = max(cases // (2 * ROUNDS), 1)
    peer = has_jsbsim()
    if not peer:
        console.print('JSBSim is not installed: pip install "edl6dof\\[bench]"')
    for index in range(ROUNDS):
        first = 2 * share * index
        fly(plan, runner, first, first + share, 1, costs[one], clock, figures)
        fly(plan, runner, first + share, first + 2 * share, cores, costs[every], clock, figures)
        if peer:
            fly_jsbsim(costs.setdefault(f"JSBSim {peers_jsbsim.version()}", Cost()))
    flight_state.fly_cycles, flight.Flight.figures.func = clock.compiled, figures.form
    return costs


def show(console: Console, costs: dict[str, Cost]) -> None:
    """Print the table."""
    table = Table(title="Dispersed flights")
    for column in (
        "",
        "flights",
        "wall s",
        "flights/s",
        "flights per CPU second",
        "ns/step",
        "outside",
        "campaign's",
    ):
        table.add_column(column, justify="left" if not column else "right")
    for name, cost in costs.items():
        outside = ("", "") if name.startswith("JSBSim") else (f"{cost.outside:.1%}", f"{cost.overhead:.1%}")
        numbers = (
            f"{cost.wall_s:.1f}",
            f"{cost.flights / cost.wall_s:.1f}",
            f"{cost.per_cpu_second:.1f}",
            f"{cost.ns_per_step:,.0f}",
        )
        table.add_row(name, str(cost.flights), *numbers, *outside)
    console.print(table)
    one, every, *peer = costs.values()
    console.print(f"efficiency of the threads, by CPU time: {every.per_cpu_second / one.per_cpu_second:.1%}")
    if peer:
        ratio = one.per_cpu_second / peer[0].per_cpu_second
        console.print(
            f"flights per CPU second, whole flight of edl6dof / ballistic entry of JSBSim: {ratio:.2f}"
        )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-n", type=int, default=1000, help="flights")
    parser.add_argument("--json", type=Path, help="write all numbers")
    options = parser.parse_args()
    console = Console(highlight=False)
    load = os.getloadavg()[0]
    console.print(
        f"{platform.processor() or platform.machine()}, {available_cores()} cores, Python "
        f"{platform.python_version()}, load {load:.1f}"
    )
    costs = measure(options.n, console)
    show(console, costs)
    size = bytes_per_case(min(options.n, 200))
    console.print(f"{size:.0f} bytes of table per case; load at the end {os.getloadavg()[0]:.1f}")
    if options.json is not None:
        data = {name: asdict(cost) for name, cost in costs.items()}
        options.json.write_text(
            json.dumps({"costs": data, "bytes_per_case": size, "load": load}, indent=1) + "\n",
            encoding="utf-8",
        )


if __name__ == "__main__":
    main()
