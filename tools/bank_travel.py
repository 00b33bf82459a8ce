"""Print bank travel (deg) and propellant (kg) of entry laws beyond what the reversals need.

python tools/bank_travel.py [MISSION]    # on instruments, in calm air, waves of density, gusts and winds

Each flight is an undisturbed entry with one disturbance that the flight computer does not expect; the last
column has waves and gusts together with the wind that costs most.
"""

from __future__ import annotations

import argparse
from math import cos, radians, sin

import edl6dof
from edl6dof.fsw.guidance.entry.registry import OWN_REVERSALS
from edl6dof.studies.guidance import ENTRY, LAWS, of_flight

WIND_M_S = 40.0
WAVES, GUSTS = "atmosphere.perturbation.enabled=true", "wind.gust.enabled=true"
#: Direction (deg) from the course to where the wind blows.
WINDS = {"tail": 0.0, "left": 90.0, "head": 180.0, "right": 270.0}


def main() -> None:
    """Fly and print a row for each law."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("mission", nargs="?", default="tianwen1", metavar="MISSION")
    mission = parser.parse_args().mission
    columns = ("calm", "waves", "gusts", *(f"{name} wind" for name in WINDS), "waves, gusts, wind")
    print(f"| law: deg, kg (`{mission}`) | " + " | ".join(columns) + " |")
    print("|---" + "|---:" * len(columns) + "|")
    for law in LAWS:
        found = [beyond(mission, law, sets) for sets in ((), (WAVES,), (GUSTS,))]
        blown = [beyond(mission, law, (wind(mission, turn), WAVES, GUSTS)) for turn in WINDS.values()]
        found += [beyond(mission, law, (wind(mission, turn),)) for turn in WINDS.values()]
        cells = (f"{travel:.0f}, {fuel:.1f}" for travel, fuel in (*found, max(blown)))
        print(f"| `{law}` | " + " | ".join(cells) + " |", flush=True)


def wind(mission: str, turn_deg: float) -> str:
    """A constant wind towards the course plus an angle; the flight computer keeps the wind it expects."""
    towards = radians(edl6dof.load(mission).scenario.initial.azimuth_deg + turn_deg)
    parts = f"north_m_s: {WIND_M_S * cos(towards)!r}, east_m_s: {WIND_M_S * sin(towards)!r}"
    return f"wind={{model: constant, constant: {{{parts}}}}}"


def beyond(mission: str, law: str, sets: tuple[str, ...]) -> tuple[float, float]:
    """Bank travel (deg) and propellant (kg) of one entry beyond the reversals."""
    own = [f"{ENTRY}.reversal.logic=own_sign"] if law in OWN_REVERSALS else []
    found = of_flight(edl6dof.fly(mission, ["mission.goal=deployment", f"{ENTRY}.law={law}", *own, *sets]))
    return found["extra_travel_deg"], found["extra_propellant_kg"]


if __name__ == "__main__":
    main()
