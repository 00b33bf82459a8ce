"""Print the miss (km) of entry laws on undisturbed entries, or the largest in unexpected winds.

python tools/nominal_miss.py [LAW ...]
python tools/nominal_miss.py --wind 40 [LAW ...]    # constant wind (m/s) to north, east, south and west
"""

from __future__ import annotations

import argparse

import edl6dof
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, OWN_REVERSALS

ENTRY = "flight_software.guidance.entry"
MISSIONS = ("tianwen1", "msl", "mars2020", "tianwen1_range_trigger", "msl_range_trigger")
POINT_MASSES = ("wu2013", "zheng2015", "yan2016")


def main() -> None:
    """Fly and print a row for each law."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("laws", nargs="*", metavar="LAW")
    parser.add_argument("--wind", type=float, default=0.0)
    options = parser.parse_args()
    scenarios = MISSIONS if options.wind else (*MISSIONS, *POINT_MASSES)
    print("| law: miss, km | " + " | ".join(f"`{name}`" for name in scenarios) + " |")
    print("|---" + "|---:" * len(scenarios) + "|")
    for law in options.laws or [name for name in ENTRY_LAWS.names if name != "constant_bank"]:
        misses = (max(miss(name, law, wind) for wind in winds(options.wind)) for name in scenarios)
        print(f"| `{law}` | " + " | ".join(f"{one:.1f}" for one in misses) + " |", flush=True)


def winds(speed: float) -> list[list[str]]:
    """Overrides for each wind; the flight computer keeps the wind that it expects."""
    ways = [f"{way}_m_s: {sign * speed}" for way in ("north", "east") for sign in (1.0, -1.0)]
    return [[f"wind={{model: constant, constant: {{{way}}}}}"] for way in ways] if speed else [[]]


def miss(scenario: str, law: str, wind: list[str]) -> float:
    """Distance (km) from the aim point at the mortar."""
    own = [f"{ENTRY}.reversal.logic=own_sign"] if law in OWN_REVERSALS else []
    flight = edl6dof.fly(scenario, ["mission.goal=deployment", f"{ENTRY}.law={law}", *own, *wind])
    return flight.figures["parachute_miss_m"] / 1e3


if __name__ == "__main__":
    main()
