"""Print what the fault tolerance promises, measured: ``python tools/fault_figures.py [-n 400] [--seed 1]
[--set PATH=VALUE ...]``.

1. n dispersed flights (``tianwen1_mc``) in which one of the eight horizontal thrusters stops working at a
random time in the first
   seconds of hazard avoidance: how often the right one is named, how fast, and how many land.
2. The same with one of the sixteen 250 N thrusters whose valve stays open.
3. n dispersed flights without a fault: how many thrusters are wrongly isolated.

Each flight also gets its own direction to the safe spot.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import Plan, load_plan
from edl6dof.campaign.executor import Row, fly_rows
from edl6dof.campaign.fault_response import fault_response
from edl6dof.interface.roles import HAZARD_AVOIDANCE
from edl6dof.sim.flight import Flight

HORIZONTAL = [f"D{i}" for i in range(1, 9)]
STRONG = HORIZONTAL + [f"{group}{i}" for group in "AP" for i in range(1, 5)]
LATEST_S = 8.0
SPOT_M = 18.0
TERMINAL = "flight_software.guidance.powered.terminal"


def dispersed(
    plan: Plan, seed: int, kind: str | None, thrusters: Sequence[str] = HORIZONTAL
) -> Iterator[Case]:
    """Cases of the plan, each with its own safe spot and, if wanted, a fault of one of the ``thrusters``."""
    rng = np.random.default_rng(seed)
    scenario = plan.loaded.scenario
    phase = scenario.phase_names[scenario.phase_roles.index(HAZARD_AVOIDANCE)]
    for case in plan.cases():
        direction = rng.uniform(0.0, 2.0 * np.pi)
        thruster, after = str(rng.choice(thrusters)), float(rng.uniform(0.0, LATEST_S))
        spot = {
            f"{TERMINAL}.safe_spot_north_m": SPOT_M * float(np.cos(direction)),
            f"{TERMINAL}.safe_spot_east_m": SPOT_M * float(np.sin(direction)),
        }
        fault = (
            {"faults": [{"thruster": thruster, "kind": kind, "at": {"phase": phase, "plus_s": after}}]}
            if kind
            else {}
        )
        label = {"thruster": thruster} if kind else {}
        yield replace(case, truth={**case.truth, **fault}, belief={**case.belief, **spot}, label=label)


def isolated(flight: Flight) -> Mapping[str, Any]:
    """Who was named, and what the fault did if there was one."""
    names = ", ".join(f"{one.thruster} {one.kind} at {one.t_s:.1f} s" for one in flight.isolated_faults)
    return {"isolated": names, **(fault_response(flight) if flight.loaded.truth.faults else {})}


def single_faults(title: str, rows: list[Row]) -> str:
    """Figures of the flights with one fault that began."""
    begun = [row for row in rows if row.get("fault_s") is not None]
    right = [row for row in begun if row["kind_right"]]
    times = np.array([row["isolation_s"] for row in right])
    lines = [
        (f"{title}: {len(rows)} flights, in {len(begun)} hazard avoidance was reached and the fault began"),
        f"  right thruster and kind named {len(right)} = {100.0 * len(right) / len(begun):.2f} %, flights "
        f"with a wrong isolation {sum(row['wrongly_named'] is not None for row in begun)}",
        (
            f"  time to isolation: median {np.median(times):.2f} s, 95 % {np.percentile(times, 95):.2f} s, "
            f"largest {times.max():.2f} s"
        ),
        f"  landed within limits {sum(row['success'] for row in begun)}",
    ]
    missed = [
        f"  case {row['case']}: {row['thruster']} failed, isolated: {row['isolated'] or 'none'}"
        for row in begun
        if row not in right
    ]
    return "\n".join(lines + missed + lost(begun))


def healthy(rows: list[Row]) -> str:
    """Figures of the flights without a fault."""
    wrong = [row for row in rows if row.get("false_alarms", 0.0) > 0.0]
    lines = [
        (
            f"no fault: {len(rows)} flights, {len(wrong)} with a false alarm, landed within limits "
            f"{sum(row['success'] for row in rows)}"
        )
    ]
    return "\n".join(lines + [f"  case {row['case']}: {row['isolated']}" for row in wrong] + lost(rows))


def lost(rows: list[Row]) -> list[str]:
    """A line for each flight that did not land within limits."""
    return [
        f"  case {row['case']} {row.get('thruster', '')}: {row['outcome']}"
        for row in rows
        if not row["success"]
    ]


def main() -> None:
    """Fly and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-n", type=int, default=400, help="flights with a fault, and as many without")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", help="as edl6dof fly --set"
    )
    options = parser.parse_args()
    start = time.perf_counter()
    plan = load_plan("tianwen1_mc", tuple(options.set), cases=options.n)
    for title, kind, thrusters in (
        ("horizontal thruster dead", "stuck_off", HORIZONTAL),
        ("250 N thruster stuck on", "stuck_on", STRONG),
    ):
        cases = dispersed(plan, options.seed, kind, thrusters)
        print(single_faults(title, list(fly_rows(plan.loaded, cases, collect=isolated))), flush=True)
    print(
        healthy(list(fly_rows(plan.loaded, dispersed(plan, options.seed, None), collect=isolated))),
        flush=True,
    )
    print(f"{time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
