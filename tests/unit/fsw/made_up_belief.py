"""What the flight computer believes of the made-up landing: planet, site and instruments."""

import numpy as np
from made_up_course import FLATTENING, MU, RADIUS, SITE, SPIN
from made_up_instruments import ARM

from edl6dof.config.dtype import dtype_of, fill
from edl6dof.fsw.navigation.filters.error_state import ErrorStateParams
from edl6dof.fsw.onboard import ONBOARD


def onboard_record():
    """Belief: planet, site and instruments with the error figures of the sheets."""
    record = np.zeros(1, ONBOARD)
    planet, site, unit = record[0]["planet"], record[0]["site"], record[0]["instruments"]
    planet["mu"], planet["equatorial_radius"] = MU, RADIUS
    planet["flattening"], planet["rotation_rate"] = FLATTENING, SPIN
    site["altitude"] = SITE
    tilt = np.radians(54.7356)
    for k in range(6):
        around = k * np.pi / 3.0
        axis = np.cos(tilt), np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around)
        unit["gyro_axis"][k] = unit["accelerometer_axis"][k] = axis
    unit["n_gyros"] = unit["n_accelerometers"] = 6
    degree_per_hour = np.radians(1.0) / 3600.0
    unit["gyro_noise"] = np.radians(0.01) / 60.0
    unit["gyro_bias"], unit["gyro_bias_walk"] = 0.03 * degree_per_hour, 0.003 * degree_per_hour / 60.0
    unit["gyro_scale"] = 5e-5
    unit["accelerometer_noise"] = 20e-6 * 9.81
    unit["accelerometer_bias"], unit["accelerometer_bias_walk"] = 30e-6 * 9.81, 1e-6 * 9.81 / 60.0
    unit["accelerometer_scale"] = 7e-5
    unit["n_trackers"] = 1
    unit["star_sigma"], unit["star_bias"] = np.radians(0.005), np.radians(0.004)
    unit["tracking_position"], unit["tracking_velocity"] = 500.0**2 * np.eye(3), 0.5**2 * np.eye(3)
    unit["antenna_position"] = ARM
    lean = np.radians(25.0)
    for k in range(4):
        around = np.pi / 4.0 + k * np.pi / 2.0
        unit["beam_axis"][k] = np.cos(lean), np.sin(lean) * np.cos(around), np.sin(lean) * np.sin(around)
    unit["n_beams"] = 4
    unit["range_sigma"], unit["range_sigma_relative"] = 0.1, 0.01 / 3.0
    unit["speed_sigma"], unit["speed_sigma_relative"] = 0.1 / 3.0, 0.01 / 3.0
    unit["range_bias"], unit["range_scale"], unit["speed_scale"] = 0.1, 0.0015, 0.0005
    return record


def params_record(**changes):
    record = np.zeros(1, dtype_of(ErrorStateParams))
    # the made-up planet attracts as the flight computer believes
    fill(record[0], ErrorStateParams(**{"gravity_m_s2": 0.0, **changes}))
    return record
