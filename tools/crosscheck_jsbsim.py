"""NASA NESC check cases 6 and 9 flown three times: by edl6dof, by JSBSim and by the TM's simulation 04;
prints the differences.

    pip install "edl6dof[bench]"
    python tools/crosscheck_jsbsim.py            # --step S for another step of JSBSim

Case 6: sphere with drag dropped from 30,000 ft over the rotating ellipsoid with J2. Case 9: the sphere shot
up and east at 1000 ft/s each. JSBSim flies its own Earth and its own US76 atmosphere; its vehicle is written
here from the TM's numbers, nothing is taken from edl6dof. JSBSim evaluates the forces once a step
(Adams-Bashforth), hence the shorter step; from 0.01 s to 0.0002 s its difference changes by less than a
tenth. What is left (0.004 ft and 0.03 ft) is air: JSBSim's sea-level density is 8.8e-6 above ours (2116.228
lbf/ft2 and rounded gas constants), simulation 04's 0.9e-6.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from jsbsim_vehicle import prepare, version

from edl6dof.verify.nesc import flown, reference

SPIN = 7.292115e-5  # rad/s
END_S, INTERVAL_S = 30.0, 0.1

AIRCRAFT = """<?xml version="1.0"?>
<fdm_config name="sphere" version="2.0" release="BETA">
  <metrics>
    <wingarea unit="FT2"> 0.1963495 </wingarea>
    <wingspan unit="FT"> 1 </wingspan>
    <chord unit="FT"> 1 </chord>
    <location name="AERORP" unit="FT"> <x> 0 </x> <y> 0 </y> <z> 0 </z> </location>
  </metrics>
  <mass_balance>
    <ixx unit="SLUG*FT2"> 3.6 </ixx>
    <iyy unit="SLUG*FT2"> 3.6 </iyy>
    <izz unit="SLUG*FT2"> 3.6 </izz>
    <emptywt unit="LBS"> 32.174049 </emptywt>
    <location name="CG" unit="FT"> <x> 0 </x> <y> 0 </y> <z> 0 </z> </location>
  </mass_balance>
  <ground_reactions/>
  <aerodynamics>
    <axis name="DRAG"> <function name="aero/drag"> <product>
      <property>aero/qbar-psf</property> <property>metrics/Sw-sqft</property> <value>0.1</value>
    </product> </function> </axis>
  </aerodynamics>
</fdm_config>
"""

#: Third-order Adams-Bashforth, and what all cases begin with.
COMMON: dict[str, float] = {
    **{
        f"simulation/integrator/{state}/{motion}": 4
        for state in ("rate", "position")
        for motion in ("translational", "rotational")
    },
    **{"ic/lat-geod-deg": 0.0, "ic/long-gc-deg": 0.0, "ic/theta-deg": 0.0, "ic/phi-deg": 0.0},
}
#: Initial conditions by case. JSBSim's rates are relative to the Earth: those of case 6 make the inertial
#: rate zero.
INITIAL: dict[int, dict[str, float]] = {
    6: {"ic/h-sl-ft": 30000.0, "ic/psi-true-deg": 0.0, "ic/p-rad_sec": -SPIN},
    9: {
        "ic/h-sl-ft": 0.0,
        "ic/psi-true-deg": 90.0,
        "ic/vn-fps": 0.0,
        "ic/ve-fps": 1000.0,
        "ic/vd-fps": -1000.0,
    },
}
DEGREES = 180.0 / math.pi
#: Column of the check cases, property of JSBSim, factor.
WATCHED = (
    ("altitudeMsl_ft", "position/geod-alt-ft", 1.0),
    ("feVelocity_ft_s_X", "velocities/v-north-fps", 1.0),
    ("feVelocity_ft_s_Y", "velocities/v-east-fps", 1.0),
    ("feVelocity_ft_s_Z", "velocities/v-down-fps", 1.0),
    ("longitude_deg", "position/long-gc-deg", 1.0),
    ("latitude_deg", "position/lat-geod-deg", 1.0),
    ("eulerAngle_deg_Yaw", "attitude/psi-rad", DEGREES),
    ("eulerAngle_deg_Pitch", "attitude/theta-rad", DEGREES),
    ("eulerAngle_deg_Roll", "attitude/phi-rad", DEGREES),
    ("bodyAngularRateWrtEi_deg_s_Roll", "velocities/pi-rad_sec", DEGREES),
    ("bodyAngularRateWrtEi_deg_s_Pitch", "velocities/qi-rad_sec", DEGREES),
    ("bodyAngularRateWrtEi_deg_s_Yaw", "velocities/ri-rad_sec", DEGREES),
)
Table = Mapping[str, np.ndarray]


def fly_jsbsim(case: int, step_s: float) -> Table:
    """Rows each 0.1 s of a case flown by JSBSim."""
    vehicle = prepare(AIRCRAFT, step_s, {**COMMON, **INITIAL[case]})
    steps = round(INTERVAL_S / step_s)
    rows = [_row(vehicle)]
    for _ in range(round(END_S / INTERVAL_S)):
        for _ in range(steps):
            vehicle.run()
        rows.append(_row(vehicle))
    table = dict(zip(("time", *(column for column, _, _ in WATCHED)), np.array(rows).T, strict=True))
    if not all(np.isfinite(values).all() for values in table.values()):
        raise FloatingPointError("JSBSim's state is not finite")
    return table


def _row(vehicle: Any) -> list[float]:
    return [vehicle.get_sim_time(), *(vehicle[name] * factor for _, name, factor in WATCHED)]


def largest(first: Table, second: Table, column: str) -> float:
    """Largest difference over all rows; angles on the circle."""
    difference = np.abs(first[column] - second[column])
    return float(
        np.max(np.minimum(difference, 360.0 - difference) if column.startswith("eulerAngle") else difference)
    )


def main() -> int:
    parser = argparse.ArgumentParser(
        description=("Cross-check NESC cases 6 and 9 with JSBSim and simulation 04.")
    )
    parser.add_argument(
        "--step", type=float, default=0.002, help=("JSBSim's step, s (default 0.002; a divisor of 0.1)")
    )
    step_s = parser.parse_args().step
    if not 0.0 < step_s <= INTERVAL_S or abs(INTERVAL_S / step_s - round(INTERVAL_S / step_s)) > 1e-6:
        parser.error(f"--step must divide {INTERVAL_S} (got {step_s:g})")
    try:
        installed = version()
    except ImportError:
        print('JSBSim is not installed: pip install "edl6dof[bench]"', file=sys.stderr)
        return 2
    print(
        f"largest difference over 301 rows; edl6dof at 0.01 s, JSBSim {installed} at {step_s:g} s, NESC "
        "simulation 04"
    )
    sources: tuple[Callable[[int], Table], ...] = (flown, lambda case: fly_jsbsim(case, step_s), reference)
    for case in INITIAL:
        own, jsb, tm = (source(case) for source in sources)
        print(f"\ncase {case:<32} {'ours - sim 04':>15} {'ours - JSBSim':>15} {'JSBSim - sim 04':>16}")
        for column, _, _ in WATCHED:
            print(
                f"{column:<37} {largest(own, tm, column):15.2e} {largest(own, jsb, column):15.2e} "
                f"{largest(jsb, tm, column):16.2e}"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
