"""Whether a change kept the bits: hashes of what the code computes, written before the change and compared
after it.

    python tools/same_bits.py record before.json   # on the code before
    python tools/same_bits.py compare before.json  # on the code after: status 1 and all that differs

Flown are the nominal, perturbed and faulty flights, the MSL class, the papers' scenarios, the NESC check
cases, and fifty cases of the campaign.  Each channel of telemetry and each figure has a hash of its own, by
name, so that channels may come and go and what is left is still compared.  The mathematics library of another
machine may round differently: record and compare on one.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
from collections.abc import Iterator

import numpy as np

import edl6dof

GUST = ("wind.gust.enabled=true", "atmosphere.perturbation.enabled=true")


def fault(thruster: str, kind: str, phase: str) -> str:
    """Override that breaks a thruster two seconds into a phase."""
    return f"faults=[{{thruster: {thruster}, kind: {kind}, at: {{phase: {phase}, plus_s: 2}}}}]"


#: Name, scenario, overrides.
FLIGHTS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("nominal", "tianwen1", ()),
    *((f"perturbed {seed}", "tianwen1", (*GUST, f"seed={seed}")) for seed in (2, 3, 4)),
    ("thin air", "tianwen1", ("truth={atmosphere.density_factor: 0.85, vehicle.mass.entry_kg: 1310}",)),
    ("dead D7", "tianwen1", (fault("D7", "stuck_off", "hazard_avoidance"),)),
    ("dead F3", "tianwen1", (fault("F3", "stuck_off", "slow_descent"),)),
    ("open D5", "tianwen1", (fault("D5", "stuck_on", "lift"),)),
    ("weak P1", "tianwen1", (fault("P1", "degraded", "powered_deceleration"),)),
    ("open P2", "tianwen1", (fault("P2", "stuck_on", "parachute"),)),
    ("dead D1", "tianwen1", (fault("D1", "stuck_off", "trim_aoa"),)),
    *(
        (law, "tianwen1", (f"flight_software.guidance.entry.law={law}", "mission.goal=deployment"))
        for law in ("npc", "etpc", "ftc_dob")
    ),
    *((name, name, ()) for name in ("msl", "wu2013", "yan2016", "zheng2015")),
    *((f"nesc {k}", f"nesc/case{k:02d}", ()) for k in range(1, 11)),
)
CASES = 50


def digest(values: np.ndarray) -> str:
    """Short hash of an array of numbers."""
    return hashlib.sha256(np.ascontiguousarray(values, dtype=float).tobytes()).hexdigest()[:16]


def flown(scenario: str, overrides: tuple[str, ...]) -> dict[str, str]:
    """Hash of each channel, figure and event of a flight by its name."""
    flight = edl6dof.fly(scenario, overrides)
    found = {f"telemetry {name}": digest(values) for name, values in flight.telemetry.items()}
    found |= {f"figure {name}": digest(np.array([value])) for name, value in flight.metrics.items()}
    events = "\n".join(f"{event['t_s']!r} {event['key']}" for event in flight.events)
    return {**found, "events": hashlib.sha256(events.encode()).hexdigest()[:16], "outcome": flight.outcome}


def rows() -> dict[str, str]:
    """Hash of each column of the first cases of the campaign."""
    from edl6dof.campaign.design.plan import load_plan
    from edl6dof.campaign.executor import fly_cases

    plan = load_plan("tianwen1_mc")
    table = fly_cases(plan.loaded, plan.cases(0, CASES))
    return {
        f"column {name}": hashlib.sha256(repr(table[name].to_pylist()).encode()).hexdigest()[:16]
        for name in table.column_names
    }


def everything() -> Iterator[tuple[str, dict[str, str]]]:
    """Name and hashes of everything that is flown."""
    for name, scenario, overrides in FLIGHTS:
        yield name, flown(scenario, overrides)
    yield f"campaign, {CASES} cases", rows()


def differences(before: dict[str, str], after: dict[str, str]) -> list[str]:
    """Names whose hashes differ, and those that are there on one side only."""
    changed = [name for name in before if name in after and before[name] != after[name]]
    gone = [f"{name} (gone)" for name in before if name not in after]
    return [*changed, *gone, *(f"{name} (new)" for name in after if name not in before)]


def main() -> int:
    """Record or compare."""
    parser = argparse.ArgumentParser(description="Hashes of what the code computes.")
    parser.add_argument("action", choices=("record", "compare"))
    parser.add_argument("file")
    parser.add_argument("--gone-is-fine", action="store_true", help="compare only what both sides have")
    options = parser.parse_args()
    if options.action == "record":
        with open(options.file, "w", encoding="utf-8") as file:
            json.dump(dict(everything()), file, indent=1)
        return 0
    with open(options.file, encoding="utf-8") as file:
        before = json.load(file)
    wrong = 0
    for name, after in everything():
        found = differences(before[name], after)
        found = [text for text in found if not (options.gone_is_fine and text.endswith(("(gone)", "(new)")))]
        wrong += bool(found)
        print(f"{name:<24} {'same bits' if not found else f'{len(found)} differ: ' + ', '.join(found[:6])}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
