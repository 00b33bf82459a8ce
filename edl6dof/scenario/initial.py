"""The initial state: where the vehicle is, how it moves and how it points at t = 0.

Height is given above the ellipsoid or above the areoid; velocity by speed, flight-path angle and azimuth, or
by its north, east and down components; attitude by angle of attack, sideslip and bank, or by yaw, pitch and
roll.  A file that uses both ways at once is refused.
"""

from __future__ import annotations

from functools import partial
from math import radians, sqrt
from typing import Literal, Self

from pydantic import model_validator

from edl6dof.config.base import REQUIRED, Params, Vec3, param, stated
from edl6dof.config.errors import Inconsistent
from edl6dof.spatial.elementary import atan2, cos, hypot, sin

_MISSING = {
    "speed_m_s": "required key is missing: speed relative to the rotating planet, in m/s",
    "flight_path_angle_deg": "required key is missing: flight-path angle, negative downwards, in deg",
    "azimuth_deg": "required key is missing: azimuth of the velocity, from north through east, in deg",
}
_NO_HEIGHT = (
    "required key is missing: height above the ellipsoid, in m (or give the height as height_above_areoid_m)"
)
_OR_COMPONENTS = " (or give the velocity as velocity_ned_m_s)"
_CAPSULES = (-40, 40, "capsules and lifting bodies")
#: One of two ways to give the state: left out of the record, which has neither.
_either = partial(param, None, record=False)


class InitialState(Params):
    """State of the centre of mass and attitude at t = 0."""

    epoch_utc: str = param(
        "",
        "date and time of t = 0, which set season and hour of the atmosphere model seasonal",
        record=False,
    )
    altitude_m: float | None = _either(
        "height above the ellipsoid; needed without height_above_areoid_m",
        ge=-10e3,
        le=1e7,
        usual=(0, 2e6, "drop tests to entry at Titan"),
    )
    height_above_areoid_m: float | None = _either(
        "height above the areoid, instead of altitude_m", ge=-10e3, le=1e7
    )
    latitude_deg: float = param(REQUIRED, "geodetic latitude", ge=-90.0, le=90.0)
    longitude_deg: float = param(REQUIRED, "east longitude", ge=-360.0, le=360.0)
    speed_m_s: float | None = _either(
        "speed relative to the rotating planet; needed without velocity_ned_m_s",
        ge=0.0,
        le=60000.0,
        usual=(0, 48000, "drop tests to entries at Jupiter"),
    )
    flight_path_angle_deg: float | None = _either(
        "flight-path angle, negative downwards; needed without velocity_ned_m_s", ge=-90.0, le=90.0
    )
    azimuth_deg: float | None = _either(
        "azimuth of the velocity, from north through east; needed without velocity_ned_m_s",
        ge=-360.0,
        le=360.0,
    )
    velocity_ned_m_s: Vec3 | None = _either(
        "planet-relative velocity north, east, down; instead of speed, flight-path angle and azimuth"
    )
    vertical: Literal["geodetic", "geocentric"] = param(
        "geodetic", "vertical that the initial velocity refers to", record=False
    )
    alpha_deg: float | None = _either(
        "angle of attack; 0 when neither it nor yaw_pitch_roll_deg is given",
        ge=-180.0,
        le=180.0,
        usual=_CAPSULES,
    )
    beta_deg: float | None = _either(
        "sideslip angle; 0 when not given, as alpha_deg", ge=-90.0, le=90.0, usual=_CAPSULES
    )
    bank_deg: float | None = _either("bank angle; 0 when not given, as alpha_deg", ge=-180.0, le=180.0)
    yaw_pitch_roll_deg: Vec3 | None = _either(
        "3-2-1 Euler angles of the body from geodetic north-east-down; instead of alpha, beta and bank"
    )
    rate_deg_s: Vec3 = param((0.0, 0.0, 0.0), "inertial body rate p, q, r", record=False)

    @model_validator(mode="after")
    def _each_given_once(self) -> Self:
        problems = {**self._velocity_problems(), **self._attitude_problems()}
        if self.altitude_m is None and self.height_above_areoid_m is None:
            problems["altitude_m"] = _NO_HEIGHT
        if self.altitude_m is not None and self.height_above_areoid_m is not None:
            problems["altitude_m"] = "must not stand beside height_above_areoid_m: the height is given twice"
        if problems:
            raise Inconsistent(problems)
        return self

    def _velocity_problems(self) -> dict[str, str]:
        given = [name for name in _MISSING if getattr(self, name) is not None]
        if self.velocity_ned_m_s is None:
            hint = "" if given else _OR_COMPONENTS
            return {name: words + hint for name, words in _MISSING.items() if name not in given}
        message = "must not stand beside velocity_ned_m_s: the velocity is given twice"
        problems = dict.fromkeys(given, message)
        if self.speed > 20000.0:
            problems["velocity_ned_m_s"] = f"must have a length of at most 20000 (got {self.speed:g})"
        return problems

    def _attitude_problems(self) -> dict[str, str]:
        if self.yaw_pitch_roll_deg is None:
            return {}
        message = "must not stand beside yaw_pitch_roll_deg: the attitude is given twice"
        angles = ("alpha_deg", "beta_deg", "bank_deg")
        problems = {name: message for name in angles if getattr(self, name) is not None}
        yaw, pitch, roll = self.yaw_pitch_roll_deg
        if abs(pitch) > 90.0 or abs(yaw) > 360.0 or abs(roll) > 360.0:
            words = "must be yaw and roll within -360 and 360, pitch within -90 and 90"
            problems["yaw_pitch_roll_deg"] = f"{words} (got [{yaw:g}, {pitch:g}, {roll:g}])"
        return problems

    @property
    def place(self) -> tuple[float, float]:
        """Geodetic latitude and east longitude, rad."""
        return radians(self.latitude_deg), radians(self.longitude_deg)

    @property
    def velocity_ned(self) -> Vec3:
        """Planet-relative velocity north, east, down, m/s."""
        if self.velocity_ned_m_s is not None:
            return self.velocity_ned_m_s
        gamma, azimuth, speed = self.flight_path_angle, self.azimuth, self.speed
        return speed * (cos(gamma) * cos(azimuth)), speed * (cos(gamma) * sin(azimuth)), speed * -sin(gamma)

    @property
    def speed(self) -> float:
        """Speed relative to the rotating planet, m/s."""
        if self.velocity_ned_m_s is None:
            return stated(self.speed_m_s)
        north, east, down = self.velocity_ned_m_s
        return sqrt(north * north + east * east + down * down)

    @property
    def flight_path_angle(self) -> float:
        """Flight-path angle, rad, negative downwards; 0 at rest."""
        if self.velocity_ned_m_s is None:
            return radians(stated(self.flight_path_angle_deg))
        north, east, down = self.velocity_ned_m_s
        return atan2(-down, hypot(north, east))

    @property
    def azimuth(self) -> float:
        """Azimuth of the velocity, rad; 0 at rest when only components are given."""
        if self.velocity_ned_m_s is None:
            return radians(stated(self.azimuth_deg))
        return atan2(self.velocity_ned_m_s[1], self.velocity_ned_m_s[0])

    @property
    def wind_angles(self) -> Vec3:
        """Bank, angle of attack and sideslip, rad."""
        return radians(self.bank_deg or 0.0), radians(self.alpha_deg or 0.0), radians(self.beta_deg or 0.0)
