"""Where thruster diagnosis on instruments breaks: ``python tools/diagnosis_limits.py [-n 100] [--seed 1]
[--factors 1,3,10,30,100] [--only NAME ...] [--with-meters]``.

The noise of the accelerometers, the tone and the random vibration with the engines, each by itself, are
multiplied by each factor; one of the random part has the standard deviation of the tone. The flight computer
knows the noise of its own unit, and nothing of the vibration. For each, n dispersed flights
(``fault_figures.py``) with a dead horizontal thruster, n with a 250 N thruster stuck on and n without a
fault: a row of the table in ``docs/diagnosis.md``. Force and torque alone decide, unless flow meters fly too.
"""

from __future__ import annotations

import argparse

import numpy as np
from fault_figures import HORIZONTAL, STRONG, dispersed, isolated

from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.executor import Row, fly_rows
from edl6dof.config.units import G0
from edl6dof.sensors.inertial_unit import InertialUnitParams

#: Instruments of ``tianwen1_meters``.
METERS = ("sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches, flow_meters]",)
UNIT = "sensors.inertial_unit"
HEAD = (
    "factor",
    "dead: named right, %",
    "median, s",
    "stuck on: named right, %",
    "median, s",
    "healthy flights with a false alarm, %",
    "of all, landed within limits, %",
)


def accelerometer_noise(factor: float) -> tuple[str, ...]:
    """Overrides for ``factor`` times the noise of the accelerometers."""
    usual = InertialUnitParams().accelerometers.noise_ug_sqrt_hz
    return (f"{UNIT}.accelerometers.noise_ug_sqrt_hz={factor * usual}",)


def engine_vibration(factor: float) -> tuple[str, ...]:
    """Overrides for ``factor`` times the vibration, of rate and acceleration alike."""
    usual = InertialUnitParams().vibration
    return (
        f"{UNIT}.vibration.rate_deg_s={factor * usual.rate_deg_s}",
        f"{UNIT}.vibration.acceleration_m_s2={factor * usual.acceleration_m_s2}",
    )


def random_vibration(factor: float) -> tuple[str, ...]:
    """Overrides for random vibration of ``factor`` times the standard deviation of the tone, beside it."""
    tone, random = InertialUnitParams().vibration, f"{UNIT}.vibration.random"
    return (
        f"{random}.rate_deg_s={factor * tone.rate_deg_s / np.sqrt(2.0)}",
        f"{random}.acceleration_g0={factor * tone.acceleration_m_s2 / np.sqrt(2.0) / G0}",
    )


#: What is varied, by the name that ``--only`` takes.
VARIED = {
    "noise": ("Noise of the accelerometers", accelerometer_noise),
    "tone": ("Vibration with the engines: the tone", engine_vibration),
    "random": ("Vibration with the engines: at random", random_vibration),
}


def share(values: list[bool]) -> str:
    """Per cent of ``values`` that are true."""
    return f"{100.0 * sum(values) / len(values):.1f}"


def named_right(rows: list[Row]) -> tuple[str, str]:
    """Share of the faults that began of which the right thruster was named, and the median time to that."""
    begun = [row for row in rows if row.get("fault_s") is not None]
    times = [row["isolation_s"] for row in begun if row["name_right"]]
    return share([row["name_right"] for row in begun]), f"{np.median(times):.2f}" if times else "-"


def table_row(factor: float, sets: tuple[str, ...], n: int, seed: int) -> str:
    """Fly for one row of a table."""
    plan = load_plan("tianwen1_mc", sets, cases=n)
    dead, stuck, sound = (
        list(fly_rows(plan.loaded, dispersed(plan, seed, kind, thrusters), collect=isolated))
        for kind, thrusters in (("stuck_off", HORIZONTAL), ("stuck_on", STRONG), (None, HORIZONTAL))
    )
    alarms = share([row.get("false_alarms", 0.0) > 0.0 for row in sound])
    landed = share([row["success"] for row in dead + stuck + sound])
    return f"| {factor:g} | {' | '.join([*named_right(dead), *named_right(stuck), alarms, landed])} |"


def main() -> None:
    """Fly and print both tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-n", type=int, default=100, help="flights of each kind for each factor")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--factors", default="1,3,10,30,100", help="with commas")
    parser.add_argument("--only", action="append", choices=tuple(VARIED), help="this alone")
    parser.add_argument("--with-meters", action="store_true", help="flow meters fly too")
    options = parser.parse_args()
    instruments = METERS if options.with_meters else ()
    for title, overrides in (VARIED[name] for name in options.only or VARIED):
        print(f"{title}:\n\n| {' | '.join(HEAD)} |\n{'|---' * len(HEAD)}|", flush=True)
        for factor in map(float, options.factors.split(",")):
            row = table_row(factor, instruments + overrides(factor), options.n, options.seed)
            print(row, flush=True)
        print()


if __name__ == "__main__":
    main()
