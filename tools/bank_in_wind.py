"""Print how far each entry law moves its bank angle in a wind of 60 m/s, over its travel in calm air:
``python tools/bank_in_wind.py [VEHICLE ...]``.

The point masses of three papers, with a bank angle that follows at once and with one that turns at 20 deg/s;
the wind blows from behind, from ahead, from either side, and turns round between 60 and 0 km.  In the last
column it blows from behind and is told beforehand: what the wind itself asks for.  After each ratio, in
brackets: by how many km the flight ends beyond the aim point.
"""

from __future__ import annotations

import argparse
from math import cos, radians, sin

import numpy as np

import edl6dof
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.interface.roles import LIFT

ENTRY = "flight_software.guidance.entry"
WIND_M_S = 60.0
#: Course (deg) of each entry.
COURSE = {"zheng2015": 90.0, "yan2016": 90.0, "wu2013": 0.0}
#: Gains of pd_dob that a slow bank angle can follow: those of tianwen1.
SLOWER = f"{ENTRY}.pd_dob={{error_gain: 0.01, rate_gain: 0.18}}"
BANKS = {
    "at once": ("point_mass.bank_response=ideal", f"{ENTRY}.bank_rate_deg_s=20000"),
    "20 deg/s": ("point_mass.bank_response=rate_limited", f"{ENTRY}.bank_rate_deg_s=20", SLOWER),
}
#: Turning round between 60 and 0 km.
SHEARED = (
    "truth={wind.model: shear, wind.shear.east_m_s: -60.0, wind.shear.east_shear: 2e-3, "
    "wind.shear.north_m_s: 60.0, wind.shear.north_shear: -2e-3}"
)
#: Laws of constant magnitude or of a fixed profile answer nothing.
LAWS = tuple(law for law in ENTRY_LAWS.names if law not in ("constant_bank", "bank_profile"))


def main() -> None:
    """Fly and print, a table for each vehicle and bank response."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("vehicles", nargs="*", metavar="VEHICLE", help=f"of {', '.join(COURSE)}; all if none")
    vehicles = parser.parse_args().vehicles or list(COURSE)
    if not set(vehicles) <= set(COURSE):
        parser.error(f"a vehicle is one of {', '.join(COURSE)}")
    for vehicle in vehicles:
        for bank, sets in BANKS.items():
            print(f"\n{vehicle}, bank angle {bank}\n| law | calm, deg | " + " | ".join(winds(vehicle)) + " |")
            for law in LAWS:
                print(line(vehicle, law, sets), flush=True)


def line(vehicle: str, law: str, sets: tuple[str, ...]) -> str:
    """One row: travel in calm air, and in each wind over it."""
    calm, _ = travel(vehicle, law, sets)
    flown = [travel(vehicle, law, (*sets, *wind)) for wind in winds(vehicle).values()]
    return f"| `{law}` | {calm:.0f} | " + " | ".join(f"{t / calm:.2f} ({d:.1f})" for t, d in flown) + " |"


def winds(vehicle: str) -> dict[str, tuple[str, ...]]:
    """``--set`` texts of each wind by its name."""
    tail, _ = steady(COURSE[vehicle])
    sides = {"ahead": 180.0, "left": 90.0, "right": 270.0}
    found = {f"from {name}": (steady(COURSE[vehicle] + turn)[0],) for name, turn in sides.items()}
    return {"from behind": (tail,), **found, "turning": (SHEARED,), "behind, told": steady(COURSE[vehicle])}


def steady(towards_deg: float) -> tuple[str, str]:
    """A wind towards an azimuth: blowing, and told beforehand."""
    east, north = WIND_M_S * sin(radians(towards_deg)), WIND_M_S * cos(radians(towards_deg))
    parts = f"east_m_s: {east!r}, north_m_s: {north!r}"
    blowing = f"truth={{wind.model: constant, wind.constant: {{{parts}}}}}"
    return blowing, f"{ENTRY}.expected_wind={{{parts}}}"


def travel(vehicle: str, law: str, sets: tuple[str, ...]) -> tuple[float, float]:
    """Bank travel in lift control (deg), and how far beyond the aim point the flight ends (km)."""
    shared = (f"{ENTRY}.law={law}", "mission.goal=deployment", "simulation.log_every=1")
    flight = edl6dof.fly(vehicle, [*shared, *sets])
    bank = flight.telemetry["guide.bank_deg"][flight.during(LIFT)]
    return float(np.sum(np.abs(np.diff(bank)))), flight.figures["parachute_downrange_m"] / 1e3


if __name__ == "__main__":
    main()
