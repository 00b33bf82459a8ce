"""JSBSim's nearest case: an uncontrolled 6-DOF capsule entering the atmosphere of Mars, 250 s at 100 Hz.

Has: rotating oblate Mars with J2, JSBSim's own Mars atmosphere, constant mass, drag over Mach number and
total angle of attack from a table, normal force, static moments over the full range of angles, rate damping.
Log: none. Called from Python step by step (``FGFDMExec.run``), as JSBSim's Python users do.

Lacks, against the flight of edl6dof: guidance, control, thrusters, parachute, separations, engine,
propellant, terrain, wind, landing gear, telemetry, events located inside a step. JSBSim evaluates the forces
**once** a step (Adams-Bashforth rules); edl6dof does so four times (Runge-Kutta), and once more in every
cycle of the flight software.

The start is at 100 km and not at 125 km, because JSBSim's Mars atmosphere falls below absolute zero above
112.6 km; the path is shallower than Tianwen-1's, to stay above the ground for 250 s.
"""

from __future__ import annotations

import math
import time

from jsbsim_vehicle import prepare, version

__all__ = ["run", "version"]

NAME = "JSBSim"
CASE = "ballistic 6-DOF Mars entry from 100 km, 250 s, 100 Hz"
HAS = "J2, rotating Mars, its own Mars atmosphere, C_D(Mach, angle) table, moments"
LACKS = "guidance, control, thrusters, parachute, engine, staging, terrain, wind, log"
STEP_S = 0.01
STEPS = 25_000
FORCE_EVALUATIONS_A_STEP = 1.0

FOOT = 0.3048

AIRCRAFT = """<?xml version="1.0"?>
<fdm_config name="capsule" version="2.0" release="BETA">
  <planet name="Mars">
    <semimajor_axis unit="M"> 3396190 </semimajor_axis>
    <semiminor_axis unit="M"> 3376200 </semiminor_axis>
    <rotation_rate unit="RAD/SEC"> 7.088218e-5 </rotation_rate>
    <GM unit="M3/SEC2"> 4.282837e13 </GM>
    <J2> 1.96045e-3 </J2>
    <atmosphere model="MARS"/>
  </planet>
  <metrics>
    <wingarea unit="M2"> 9.079 </wingarea>
    <wingspan unit="M"> 3.4 </wingspan>
    <chord unit="M"> 3.4 </chord>
    <location name="AERORP" unit="M"> <x> 0 </x> <y> 0 </y> <z> 0 </z> </location>
  </metrics>
  <mass_balance>
    <ixx unit="KG*M2"> 1150 </ixx>
    <iyy unit="KG*M2"> 900 </iyy>
    <izz unit="KG*M2"> 950 </izz>
    <emptywt unit="KG"> 1285 </emptywt>
    <location name="CG" unit="M"> <x> 0 </x> <y> 0 </y> <z> 0 </z> </location>
  </mass_balance>
  <ground_reactions/>
  <aerodynamics>
    <function name="aero/total-angle-rad">
      <acos> <product>
        <cos> <property>aero/alpha-rad</property> </cos>
        <cos> <property>aero/beta-rad</property> </cos>
      </product> </acos>
    </function>
    <axis name="DRAG"> <function name="aero/drag"> <product>
      <property>aero/qbar-area</property>
      <table>
        <independentVar lookup="row">velocities/mach</independentVar>
        <independentVar lookup="column">aero/total-angle-rad</independentVar>
        <tableData>
                0.0   0.17  0.35  0.70  1.57
          0.0   1.05  1.03  0.98  0.80  0.60
          0.8   1.12  1.10  1.04  0.85  0.65
          1.0   1.30  1.27  1.20  0.98  0.75
          1.5   1.48  1.45  1.36  1.10  0.80
          3.0   1.55  1.51  1.42  1.13  0.80
          6.0   1.60  1.56  1.46  1.15  0.80
          15.0  1.66  1.62  1.51  1.17  0.80
          25.0  1.69  1.65  1.53  1.18  0.80
        </tableData>
      </table>
    </product> </function> </axis>
    <axis name="LIFT"> <function name="aero/lift"> <product>
      <property>aero/qbar-area</property> <value>-0.7</value>
      <sin> <product> <value>2</value> <property>aero/alpha-rad</property> </product> </sin>
    </product> </function> </axis>
    <axis name="SIDE"> <function name="aero/side"> <product>
      <property>aero/qbar-area</property> <value>0.7</value>
      <sin> <product> <value>2</value> <property>aero/beta-rad</property> </product> </sin>
    </product> </function> </axis>
    <axis name="ROLL"> <function name="aero/roll-damping"> <product>
      <property>aero/qbar-area</property> <property>metrics/bw-ft</property>
      <property>aero/bi2vel</property> <property>velocities/p-rad_sec</property> <value>-0.05</value>
    </product> </function> </axis>
    <axis name="PITCH">
      <function name="aero/pitch"> <product>
        <property>aero/qbar-area</property> <property>metrics/cbarw-ft</property>
        <value>-0.12</value> <sin> <property>aero/alpha-rad</property> </sin>
      </product> </function>
      <function name="aero/pitch-damping"> <product>
        <property>aero/qbar-area</property> <property>metrics/cbarw-ft</property>
        <property>aero/ci2vel</property> <property>velocities/q-rad_sec</property> <value>-0.5</value>
      </product> </function>
    </axis>
    <axis name="YAW">
      <function name="aero/yaw"> <product>
        <property>aero/qbar-area</property> <property>metrics/bw-ft</property>
        <value>0.12</value> <sin> <property>aero/beta-rad</property> </sin>
      </product> </function>
      <function name="aero/yaw-damping"> <product>
        <property>aero/qbar-area</property> <property>metrics/bw-ft</property>
        <property>aero/bi2vel</property> <property>velocities/r-rad_sec</property> <value>-0.5</value>
      </product> </function>
    </axis>
  </aerodynamics>
</fdm_config>
"""

INITIAL = {
    "ic/lat-geod-deg": 37.953,
    "ic/long-gc-deg": 110.282,
    "ic/h-sl-ft": 100_000.0 / FOOT,
    "ic/vt-fps": 4800.0 / FOOT,
    "ic/gamma-deg": -9.0,
    "ic/psi-true-deg": 181.41,
    "ic/alpha-deg": -7.0,
    "ic/beta-deg": 3.0,
    "ic/p-rad_sec": 0.002,
    # second-order Adams-Bashforth; the default, Euler's rule, makes the capsule tumble
    "simulation/integrator/rate/rotational": 3,
    "simulation/integrator/position/rotational": 3,
}
#: State at the end: position, m (x east of the prime meridian), attitude in the local level axes, rad.
POSITION = tuple(f"position/eci-{axis}-ft" for axis in "xyz")
ATTITUDE = ("attitude/phi-rad", "attitude/theta-rad", "attitude/psi-rad")
WATCHED = ("position/h-sl-ft", "velocities/vt-fps", *POSITION, *ATTITUDE)


def run() -> tuple[float, float, dict[str, float]]:
    """One entry: wall seconds, CPU seconds, and where it ended.

    Raises:
        FloatingPointError: the state is not finite (``run`` returns True all the same, and such a run looks
            faster).
    """
    wall, cpu, end = run_with(STEP_S)
    altitude_m, speed_m_s = FOOT * end["position/h-sl-ft"], FOOT * end["velocities/vt-fps"]
    return wall, cpu, {"time_s": STEPS * STEP_S, "altitude_m": altitude_m, "speed_m_s": speed_m_s}


def run_with(step_s: float) -> tuple[float, float, dict[str, float]]:
    """As :func:`run` with another step: wall seconds, CPU seconds, and the properties ``WATCHED``."""
    vehicle = prepare(AIRCRAFT, step_s, INITIAL)
    step = vehicle.run
    wall, cpu = time.perf_counter(), time.process_time()
    for _ in range(round(STEPS * STEP_S / step_s)):
        step()
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    end = {name: float(vehicle[name]) for name in WATCHED}
    if not all(map(math.isfinite, end.values())):
        raise FloatingPointError(f"JSBSim's state is not finite after {vehicle.get_sim_time():.2f} s")
    return wall, cpu, end
