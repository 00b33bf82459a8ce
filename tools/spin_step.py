"""How far a step errs on a spinning capsule that nothing controls: the table of docs/step.md.

    python tools/spin_step.py

Stardust and Genesis enter 9 deg off the flow and nutating; every row of telemetry up to the drogue is
compared with that of a flight at a quarter of the finest step shown.  The roll rate has no cause to change.
"""

from __future__ import annotations

from time import process_time

import numpy as np

import edl6dof

STEPS_MS = (20.0, 10.0, 5.0, 2.5)
REFERENCE_MS = 0.625
#: What disturbs the entry, and until when both are in the air without a parachute, s.
DISTURBED = ("initial.alpha_deg=8", "initial.beta_deg=-5", "mission.goal=time", "simulation.time_limit_s=129")
CAPSULES = {"stardust": "initial.rate_deg_s=[81, 3, -2]", "genesis": "initial.rate_deg_s=[90, 3, -2]"}
ANGLE, ALTITUDE = "truth.total_alpha_deg", "truth.altitude_m"
RATES = tuple(f"truth.rate_{axis}_deg_s" for axis in "pqr")


def flown(name: str, step_ms: float) -> tuple[dict[str, np.ndarray], float]:
    """Columns of one flight, and its CPU time, s."""
    step = f"simulation.step_s={1e-3 * step_ms}"
    began = process_time()
    telemetry = edl6dof.fly(name, [step, CAPSULES[name], *DISTURBED]).telemetry
    return {key: np.asarray(telemetry[key]) for key in (ANGLE, ALTITUDE, *RATES)}, process_time() - began


def main() -> None:
    """Print one table for each capsule."""
    for name in CAPSULES:
        reference, _ = flown(name, REFERENCE_MS)
        fastest = float(np.hypot(reference[RATES[1]], reference[RATES[2]]).max())
        print(f"\n{name}: lateral rate up to {fastest:.1f} deg/s")
        print(
            "| step | total angle (deg) | lateral rate (deg/s) | roll rate (deg/s) | altitude (m) | CPU (s) |"
        )
        print("|---:|---:|---:|---:|---:|---:|")
        for step in STEPS_MS:
            own, cpu = flown(name, step)
            apart = {key: np.abs(own[key] - reference[key]).max() for key in own}
            lateral = max(apart[key] for key in RATES[1:])
            errors = (apart[ANGLE], lateral, apart[RATES[0]], apart[ALTITUDE])
            print(f"| {step:g} ms | " + " | ".join(f"{error:.2g}" for error in errors) + f" | {cpu:.2f} |")


if __name__ == "__main__":
    main()
