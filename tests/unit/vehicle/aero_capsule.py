"""A capsule of 3.4 m with the default parameters: its records, and its coefficients and forces in one
call.
"""

from math import cos, pi, radians, sin

import numpy as np

import edl6dof
from edl6dof.config.dtype import fill
from edl6dof.environment.gas import GAS
from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams, capsule_aero, capsule_coefficients
from edl6dof.vehicle.aerodynamics.capsule_table import aero_inputs, build_aero_table
from edl6dof.vehicle.aerodynamics.wrench import AERO, AeroParams

D, AREA = 3.4, pi / 4 * 3.4**2
DENSE, RARE = 1e-2, 1e-12  # kg/m3: Kn < 1e-3 and Kn > 10
PARAMS = AeroParams()
GAS_PARAMS = edl6dof.load("tianwen1").scenario.planet.gas


def gas_record():
    gas = np.zeros(1, GAS)
    fill(gas[0], GAS_PARAMS)
    return gas.view(np.recarray)[0]


def record(params=PARAMS):
    aero = np.zeros(1, AERO)
    fill(aero[0], params)
    return aero.view(np.recarray)[0]


def table_of(params=PARAMS):
    inputs = aero_inputs(params.capsule, GAS_PARAMS.shock_layer_heat_capacity_ratio)
    return build_aero_table(inputs).view(np.recarray)[0]


def capsule_with(**changes):
    return record(AeroParams(capsule=CapsuleParams(**changes)))


def velocity(angle_deg, roll_deg=90.0, speed=1.0):
    """Velocity at a total angle; roll 0 is sideslip to the right, roll 90 is positive alpha."""
    a, f = radians(angle_deg), radians(roll_deg)
    return speed * cos(a), speed * sin(a) * cos(f), speed * sin(a) * sin(f)


def coefficients(table, mach, angle_deg, rho=DENSE, aero=None):
    return np.array(
        capsule_coefficients((aero or record()).capsule, table, gas_record(), mach, rho, radians(angle_deg))
    )


def wrench(table, vel, mach=5.0, rho=DENSE, rates=(0.0, 0.0, 0.0), aero=None):
    return np.array(capsule_aero(aero or record(), table, (gas_record(), 1.0, mach, rho), tuple(vel), rates))
