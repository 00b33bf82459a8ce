"""Perfect sensors: gyro, accelerometer, inertial position, attitude and ground range without error or delay;
beside them the IMU.
"""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import Params, group
from edl6dof.interface.sensed import SENSED
from edl6dof.jit import kernel
from edl6dof.sensors.imu import READINGS, ImuParams, read_imu
from edl6dof.vehicle.plant import ATTITUDE, POSITION, RATE, VELOCITY

#: Opening of the trim wing at which its end switch closes.
END_SWITCH = 0.95


class SensorParams(Params):
    """What the flight computer measures with."""

    imu: ImuParams = group(ImuParams, "inertial measurement unit")


#: What the sensors remember, and what crosses to the flight software.
SENSORS = np.dtype([("imu", READINGS), ("sensed", SENSED)], align=True)


@kernel
def sense(case, plant, outputs, sensors):
    """Write into ``sensors.sensed`` what ideal instruments at the centre of mass would measure in the
    state ``plant`` with its ``outputs``.
    """
    y, sensed = plant.y, sensors.sensed
    sensed.t = plant.t
    for i in range(3):
        sensed.r_I[i] = y[POSITION + i]
        sensed.v_I[i] = y[VELOCITY + i]
        sensed.w_B[i] = y[RATE + i]
        sensed.specific_force_B[i] = outputs.specific_force_B[i]
    for i in range(4):
        sensed.q_I2B[i] = y[ATTITUDE + i]
    sensed.height_above_ground = outputs.height
    sensed.footpad_contact = 1 if outputs.pads > 0 else 0
    read_imu(case.sensors.imu, plant, sensors.imu, sensed)
    sensed.wing_open = 1 if outputs.wing_opening > END_SWITCH else 0
