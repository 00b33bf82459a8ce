"""What a case of a campaign costs on the processor beside its flight: the bound of a GPU, whatever its speed.

    python tools/gpu_host.py              # 40 cases of tianwen1_mc; half a minute of one core
    python tools/gpu_host.py -n 200
    python tools/gpu_host.py --helpers 2  # and how many cases helpers prepare and make rows of, by the clock

CPU milliseconds of a case, medians: preparing it, the flight itself on this processor, its figures and row
from what a GPU hands back.  Cases a second: how many one core prepares and makes rows of.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import Plan, load_plan
from edl6dof.campaign.executor import CaseRunner
from edl6dof.campaign.gpu.crew import Helpers
from edl6dof.campaign.gpu.host import Host, Left
from edl6dof.campaign.gpu.layouts import LEAN
from edl6dof.metrics.telling_rows import keep_telling
from edl6dof.sim.figures import telling_of
from edl6dof.sim.underway import Underway, log_rows
from edl6dof.telemetry.channels import BRIEF

#: Cases in a portion of helpers, and portions that they do for the clock.
TOGETHER, PORTIONS = 64, 4


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-n", type=int, default=40, help="cases")
    parser.add_argument("--helpers", type=int, default=0, help="processes")
    options = parser.parse_args()
    plan = load_plan("tianwen1_mc", cases=max(options.n + 1, TOGETHER * PORTIONS * max(options.helpers, 1)))
    cases = list(plan.cases(0, options.n + 1))
    one = alone(plan, cases)
    if options.helpers:
        together(plan, options.helpers, one)


def alone(plan: Plan, cases: list[Case]) -> Left:
    """Print what cases cost in this process; returns what one of them has left."""
    runner, taken = CaseRunner(plan.loaded), dict[str, list[float]]()
    host, log = Host(runner), np.zeros(log_rows(plan.loaded), BRIEF)

    def timed(what: str, work: Callable[[], Any]) -> Any:
        start = time.process_time()
        done = work()
        taken.setdefault(what, []).append(time.process_time() - start)
        return done

    for case in cases:
        ready = runner.prepared(case)
        (start,) = timed("prepare", lambda case=case: host.prepare([case]))
        if isinstance(ready, str) or start is None:
            continue
        flight = Underway(ready.variant.loaded, parts=ready.variant.parts, log=log)
        timed("flight", lambda flight=flight: flight.advance(flight.last_cycle + 1))
        left = as_of_a_gpu(flight)
        timed("row", lambda case=case, left=left: host.rows([case], [left]))
    cost = {what: 1e3 * float(np.median(times[1:])) for what, times in taken.items()}
    for what, milliseconds in cost.items():
        print(f"{what:8} {milliseconds:7.2f} ms")
    print(f"at most  {1e3 / (cost['prepare'] + cost['row']):7.0f} cases a second of one core")
    return left


def as_of_a_gpu(flight: Underway) -> Left:
    """What a GPU hands back of a flight."""
    needs = telling_of(flight.loaded.scenario)
    assert needs is not None
    rows = keep_telling(needs[0], flight.plant[0], flight.log, flight.rows, np.zeros(flight.rows, np.int8))
    own = {}
    for name in ("plant", "outputs", "peaks", "work", "sensors", "fsw"):
        record = np.zeros(1, LEAN.own[name])
        take(getattr(flight, name), record)
        own[name] = record.tobytes()
    return Left(own, flight.log[:rows].tobytes(), flight.code, flight.cycle)


def take(source: np.ndarray, target: np.ndarray) -> None:
    """Copy the fields of a record that another layout has in the same shape."""
    for name in target.dtype.names or ():
        if target.dtype[name].base.names is not None and source[name].shape == target[name].shape:
            take(source[name], target[name])
        elif source[name].shape == target[name].shape:
            target[name] = source[name]


def together(plan: Plan, count: int, left: Left) -> None:
    """Print how many cases a second helpers prepare and make rows of; each hands back the same."""
    helpers = Helpers(plan, count)
    portions = [list(plan.cases(k * TOGETHER, (k + 1) * TOGETHER)) for k in range(PORTIONS * count)]
    for future in [helpers.prepare(k, portion[:1]) for k, portion in enumerate(portions[:count])]:
        future.result()  # they have begun
    start = time.perf_counter()
    begun = [helpers.prepare(k, portion) for k, portion in enumerate(portions)]
    done = [
        helpers.rows(k, portion, [left if one else None for one in future.result()])
        for k, (portion, future) in enumerate(zip(portions, begun, strict=True))
    ]
    flown = sum(len(future.result()) for future in done)
    print(f"{count} helpers {flown / (time.perf_counter() - start):7.0f} cases a second")
    helpers.close()


if __name__ == "__main__":
    main()
