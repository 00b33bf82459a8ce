"""Print the miss (km) of entry laws on undisturbed entries: ``python tools/nominal_miss.py [LAW ...]``."""

from __future__ import annotations

import sys

import edl6dof
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS

ENTRY = "flight_software.guidance.entry"
MISSIONS = ("tianwen1", "msl", "mars2020", "tianwen1_range_trigger", "msl_range_trigger")
POINT_MASSES = ("wu2013", "zheng2015", "yan2016")


def main() -> None:
    """Fly and print a row for each law."""
    scenarios = (*MISSIONS, *POINT_MASSES)
    print("| law | " + " | ".join(f"`{name}`" for name in scenarios) + " |")
    for law in sys.argv[1:] or [name for name in ENTRY_LAWS.names if name != "constant_bank"]:
        print(f"| `{law}` | " + " | ".join(f"{miss(name, law):.1f}" for name in scenarios) + " |", flush=True)


def miss(scenario: str, law: str) -> float:
    """Distance (km) from the aim point at the mortar."""
    own = [f"{ENTRY}.reversal.logic=own_sign"] if law == "fnpeg" else []
    flight = edl6dof.fly(scenario, ["mission.goal=deployment", f"{ENTRY}.law={law}", *own])
    return flight.figures["parachute_miss_m"] / 1e3


if __name__ == "__main__":
    main()
