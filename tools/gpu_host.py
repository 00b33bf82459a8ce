"""What a case of a campaign costs on the processor beside its flight: the bound of a GPU, whatever its speed.

    python tools/gpu_host.py              # 40 cases of tianwen1_mc; half a minute of one core
    python tools/gpu_host.py -n 200

CPU milliseconds of a case, medians: preparing it, the records that it starts with, the flight itself on this
processor, its figures and row.  Cases a second: how many one core prepares, starts and makes rows of.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import CaseRunner, Ready
from edl6dof.campaign.rows import flown_row
from edl6dof.sim.flight import fly
from edl6dof.sim.underway import beginning, log_rows
from edl6dof.telemetry.channels import BRIEF


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-n", type=int, default=40, help="cases")
    plan = load_plan("tianwen1_mc", cases=parser.parse_args().n + 1)
    runner, taken = CaseRunner(plan.loaded), dict[str, list[float]]()
    log = np.zeros(log_rows(plan.loaded), BRIEF)

    def timed(what: str, work: Callable[[], Any]) -> Any:
        start = time.process_time()
        done = work()
        taken.setdefault(what, []).append(time.process_time() - start)
        return done

    for case in plan.cases():
        ready = timed("prepare", lambda case=case: runner.prepared(case))
        if not isinstance(ready, Ready):
            continue
        loaded, parts = ready.variant.loaded, ready.variant.parts
        timed("start", lambda loaded=loaded, parts=parts: beginning(loaded, parts.case, parts.onboard))
        flight = timed("flight", lambda loaded=loaded, parts=parts: fly(loaded, parts=parts, log=log))
        timed("row", lambda of=(case, ready.changes, flight, None): flown_row(*of))
    cost = {what: 1e3 * float(np.median(times[1:])) for what, times in taken.items()}
    for what, milliseconds in cost.items():
        print(f"{what:8} {milliseconds:7.2f} ms")
    print(f"at most  {1e3 / (sum(cost.values()) - cost['flight']):7.0f} cases a second of one core")


if __name__ == "__main__":
    main()
