"""Print the miss of undisturbed entries at slow bank rates: ``python tools/slow_bank.py``.

Every law on the entry of Zheng & Cui as a point mass, and four on the rigid bodies.  The last rows of
``zheng2015`` are the papers' laws with gains that suit a slow bank angle, those of ``msl``.  The last two
rows are ``fnpeg`` on the entry of Yan, Sun & Guo, and the least miss there of open-loop flights at one bank
angle and, after one reversal, another.
"""

from __future__ import annotations

import json
from itertools import product
from math import inf

import edl6dof
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, OWN_REVERSALS

ENTRY = "flight_software.guidance.entry"
RATES_DEG_S = (5.0, 10.0, 20.0)
POINT_MASSES = ("zheng2015", "yan2016")
LAWS = tuple(law for law in ENTRY_LAWS.names if law not in ("constant_bank", "bank_profile"))
FOUR = ("fnpeg", "npc", "etpc", "drag_tracking")
#: Gains of laws whose papers bank at once, slower than the bank angle: those of msl.
SLOWER = {
    "dob_sliding": "{filter_time_s: 2.0, error_gain: 0.08}",
    "ftc_dob": "{error_gain: 0.05, rate_gain: 0.3}",
    "pd_dob": "{error_gain: 0.02, rate_gain: 0.25}",
}


def main() -> None:
    """Fly and print."""
    print("| miss km | " + " | ".join(f"{rate:g} deg/s" for rate in RATES_DEG_S) + " |")
    for law in LAWS:
        row("zheng2015", law)
    for law, gains in SLOWER.items():
        row("zheng2015", law, gains)
    for vehicle in ("msl", "tianwen1"):
        for law in FOUR:
            row(vehicle, law)
    row("yan2016", "fnpeg")
    print(f"| `yan2016`: one reversal, open loop | {least_of_one_reversal():.1f} | | |")


def row(vehicle: str, law: str, gains: str = "") -> None:
    """One line: the miss at each bank rate."""
    own = [f"{ENTRY}.reversal.logic=own_sign"] if law in OWN_REVERSALS else []
    own += [f"{ENTRY}.{law}={gains}"] if gains else []
    missed = [miss(vehicle, [f"{ENTRY}.law={law}", *own], rate) for rate in RATES_DEG_S]
    name = f"`{vehicle}`: `{law}`{', slower gains' if gains else ''}"
    print(f"| {name} | " + " | ".join(f"{km:.1f}" for km in missed) + " |", flush=True)


def least_of_one_reversal() -> float:
    """Least miss (km) of 48 flights of yan2016 at 5 deg/s with one reversal, each at two bank angles."""
    own = [f"{ENTRY}.law=bank_profile", f"{ENTRY}.reversal.logic=own_sign"]
    misses = []
    for first, speed, last in product((100, 130, 150, 170), (5650, 5550, 5400, 5000), (-110, -90, -70)):
        points = [{"at": speed - 1, "bank_deg": last}, {"at": speed + 1, "bank_deg": first}]
        profile = f"{ENTRY}.bank_profile={json.dumps({'points': points})}"
        misses.append(miss("yan2016", [*own, profile], 5.0))
    return min(misses)


def miss(vehicle: str, sets: list[str], rate: float) -> float:
    """Miss (km) at a bank rate that flight software and vehicle have in common."""
    rigid = "flight_software.control.bank_to_steer.bank.rate_deg_s"
    turning = (
        ["point_mass.bank_response=rate_limited", f"point_mass.bank_rate_deg_s={rate}"]
        if vehicle in POINT_MASSES
        else [f"{rigid}={rate}"]
    )
    about = ["mission.goal=deployment", f"{ENTRY}.bank_rate_deg_s={rate}", *turning]
    return edl6dof.fly(vehicle, [*sets, *about]).figures.get("parachute_miss_m", inf) / 1e3


if __name__ == "__main__":
    main()
