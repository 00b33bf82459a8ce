"""Basilisk's nearest case: a rigid entry vehicle with drag, eight thrusters and attitude control at 10 Hz,
500 s at 100 Hz.

Has: Mars as a point mass, exponential atmosphere, drag with an offset centre of pressure, eight on/off
thrusters with ramps and least on-time, ideal navigation, inertial pointing by MRP feedback, force mapping,
Schmitt trigger; fourth-order Runge-Kutta as edl6dof. Log: none (recording the state at 100 Hz costs Basilisk
some 13 % more).

Lacks, against the flight of edl6dof: J2, aerodynamic tables, lift and damping, varying mass, guidance,
mission phases, parachute, separations, engine, terrain, wind, touchdown, telemetry, events located inside a
step. The density is taken once a step. The entry is shallower than Tianwen-1's, to stay above the ground for
500 s.
"""

from __future__ import annotations

import itertools
import math
import time
from importlib.metadata import version as installed_version
from typing import Any

NAME = "Basilisk"
CASE = "rigid body + 8 thrusters + attitude control at 10 Hz, 500 s, 100 Hz"
HAS = "point-mass Mars, exponential atmosphere, drag, thrusters with ramps, MRP control, Schmitt trigger, RK4"
LACKS = "J2, aero tables, varying mass, guidance, phases, parachute, engine, staging, terrain, wind, log"
STEP_S = 0.01
CONTROL_S = 0.1
SECONDS = 500.0
STEPS = 50_000
FORCE_EVALUATIONS_A_STEP = 4.0

RADIUS_M = 3_396_190.0
ALTITUDE_M = 125_000.0
SPEED_M_S = 4800.0
FLIGHT_PATH_DEG = -7.7
INERTIA = [1150.0, 0.0, 0.0, 0.0, 900.0, 0.0, 0.0, 0.0, 950.0]
ARM_M, OUT_M, TILT = 0.85, 1.2, math.sqrt(0.5)
#: (position, direction) of the thrusters, which push obliquely: pure torques about all three axes are sums of
#: four of them.
THRUSTERS = [
    ([x * 0.04, side * OUT_M, z * ARM_M], [side * x * TILT, -side * TILT, 0.0])
    for side, x, z in itertools.product((1, -1), repeat=3)
]


def version() -> str:
    """Version of the installed module; raises ``ImportError`` when there is none."""
    import Basilisk  # noqa: F401

    return installed_version("bsk")


def run() -> tuple[float, float, dict[str, float]]:
    """One run: wall seconds, CPU seconds, and where it ended.

    Raises:
        FloatingPointError: the state is not finite.
    """
    wall, cpu, r, v, _, w = run_with(STEP_S, SECONDS, controlled=True)
    end = {
        "altitude_m": math.hypot(*r) - RADIUS_M,
        "speed_m_s": math.hypot(*v),
        "rate_deg_s": math.degrees(math.hypot(*w)),
    }
    return wall, cpu, {"time_s": SECONDS, **end}


def run_with(
    step_s: float, seconds: float, *, controlled: bool
) -> tuple[float, float, list[float], list[float], list[float], list[float]]:
    """As :func:`run`, with another step and length: wall seconds, CPU seconds; position (m), velocity (m/s),
    modified Rodrigues parameters and rate (rad/s) at the end.

    Without control the thrusters and their software are left out: a free entry.
    """
    from Basilisk.simulation import dragDynamicEffector, exponentialAtmosphere, spacecraft
    from Basilisk.utilities import SimulationBaseClass, macros, simIncludeGravBody

    simulation = SimulationBaseClass.SimBaseClass()
    for name, period in (("dynamics", step_s), ("software", CONTROL_S)):
        simulation.CreateNewProcess(name).addTask(simulation.CreateNewTask(name, macros.sec2nano(period)))

    vehicle = spacecraft.Spacecraft()
    vehicle.ModelTag = "capsule"
    vehicle.hub.mHub = 1285.0
    vehicle.hub.IHubPntBc_B = [INERTIA[0:3], INERTIA[3:6], INERTIA[6:9]]
    gamma = math.radians(FLIGHT_PATH_DEG)
    vehicle.hub.r_CN_NInit = [RADIUS_M + ALTITUDE_M, 0.0, 0.0]
    vehicle.hub.v_CN_NInit = [SPEED_M_S * math.sin(gamma), SPEED_M_S * math.cos(gamma), 0.0]
    vehicle.hub.sigma_BNInit = [[0.05], [0.10], [-0.08]]
    vehicle.hub.omega_BN_BInit = [[0.01], [-0.01], [0.02]]
    gravity = simIncludeGravBody.gravBodyFactory()
    gravity.createMars().isCentralBody = True
    gravity.addBodiesTo(vehicle)

    air = exponentialAtmosphere.ExponentialAtmosphere()
    air.planetRadius, air.baseDensity, air.scaleHeight, air.localTemp = RADIUS_M, 0.020, 11_100.0, 210.0
    air.addSpacecraftToModel(vehicle.scStateOutMsg)
    drag = dragDynamicEffector.DragDynamicEffector()
    drag.coreParams.projectedArea, drag.coreParams.dragCoeff = 9.079, 1.6
    drag.coreParams.comOffset = [0.0, 0.003, -0.005]
    drag.atmoDensInMsg.subscribeTo(air.envOutMsgs[0])
    vehicle.addDynamicEffector(drag)
    for model in (air, drag, vehicle):
        simulation.AddModelToTask("dynamics", model)
    keep = _add_control(simulation, vehicle) if controlled else []

    simulation.InitializeSimulation()
    simulation.ConfigureStopTime(macros.sec2nano(seconds))
    wall, cpu = time.perf_counter(), time.process_time()
    simulation.ExecuteSimulation()
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    end = vehicle.scStateOutMsg.read()
    r, v, s, w = (list(map(float, x)) for x in (end.r_BN_N, end.v_BN_N, end.sigma_BN, end.omega_BN_B))
    if not all(map(math.isfinite, r + v + s + w)):
        raise FloatingPointError("Basilisk's state is not finite")
    del keep
    return wall, cpu, r, v, s, w


def _add_control(simulation: Any, vehicle: Any) -> list[Any]:
    """Add thrusters, navigation and attitude control; returns what Basilisk refers to without owning."""
    from Basilisk.architecture import messaging
    from Basilisk.fswAlgorithms import (
        attTrackingError,
        inertial3D,
        mrpFeedback,
        thrFiringSchmitt,
        thrForceMapping,
    )
    from Basilisk.simulation import simpleNav, thrusterDynamicEffector
    from Basilisk.utilities import simIncludeThruster

    factory = simIncludeThruster.thrusterFactory()
    for position, direction in THRUSTERS:
        factory.create("MOOG_Monarc_445", position, direction, MaxThrust=250.0, MinOnTime=0.02)
    thrusters = thrusterDynamicEffector.ThrusterDynamicEffector()
    factory.addToSpacecraft("thrusters", thrusters, vehicle)
    navigation = simpleNav.SimpleNav()
    navigation.scStateInMsg.subscribeTo(vehicle.scStateOutMsg)
    for model in (thrusters, navigation):
        simulation.AddModelToTask("dynamics", model)

    pointing = inertial3D.inertial3D()
    pointing.sigma_R0N = [0.0, 0.0, 0.0]
    error = attTrackingError.attTrackingError()
    error.attNavInMsg.subscribeTo(navigation.attOutMsg)
    error.attRefInMsg.subscribeTo(pointing.attRefOutMsg)
    inertia = messaging.VehicleConfigMsg().write(messaging.VehicleConfigMsgPayload(ISCPntB_B=INERTIA))
    layout = factory.getConfigMessage()
    control = mrpFeedback.mrpFeedback()
    control.K, control.P, control.Ki, control.integralLimit = 400.0, 600.0, -1.0, 0.0
    control.guidInMsg.subscribeTo(error.attGuidOutMsg)
    control.vehConfigInMsg.subscribeTo(inertia)
    mapping = thrForceMapping.thrForceMapping()
    mapping.controlAxes_B, mapping.thrForceSign = [1, 0, 0, 0, 1, 0, 0, 0, 1], +1
    mapping.cmdTorqueInMsg.subscribeTo(control.cmdTorqueOutMsg)
    mapping.thrConfigInMsg.subscribeTo(layout)
    mapping.vehConfigInMsg.subscribeTo(inertia)
    trigger = thrFiringSchmitt.thrFiringSchmitt()
    trigger.thrMinFireTime, trigger.level_on, trigger.level_off = 0.02, 0.75, 0.25
    trigger.thrConfInMsg.subscribeTo(layout)
    trigger.thrForceInMsg.subscribeTo(mapping.thrForceCmdOutMsg)
    thrusters.cmdsInMsg.subscribeTo(trigger.onTimeOutMsg)
    for module in (pointing, error, control, mapping, trigger):
        simulation.AddModelToTask("software", module)
    return [factory, inertia, layout]
