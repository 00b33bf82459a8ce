"""Shape, rotation, gravity and gas of the planet, and its colours in pictures."""

from __future__ import annotations

import numpy as np

from edl6dof.config.base import REQUIRED, Params, Title, Vec3, group, param, section
from edl6dof.config.dtype import extended, fill
from edl6dof.environment.climate import ClimateParams
from edl6dof.environment.gas import GAS, GasParams, fill_gas
from edl6dof.environment.gravity import GRAVITY, GravityParams, fill_gravity

#: A height above the areoid in km, and the colour of the ground there.
Tint = tuple[float, float, float, float]
GREY: Vec3 = (128.0, 128.0, 128.0)


class AppearanceParams(Params):
    """Colours as red, green and blue from 0 to 255; a planet without them is grey."""

    ground_dark: Vec3 = param(GREY, "darkest ground", record=False)
    ground_light: Vec3 = param(GREY, "lightest ground", record=False)
    rock: Vec3 = param(GREY, "boulders", record=False)
    haze: Vec3 = param(GREY, "far ground through the air", record=False)
    sky_horizon: Vec3 = param(GREY, "sky at the horizon, seen from the ground", record=False)
    sky_zenith: Vec3 = param(GREY, "sky overhead, seen from the ground", record=False)
    sky_scale_m: float = param(
        10e3,
        "height over which the sky darkens by e",
        record=False,
        gt=0.0,
        usual=(1000, 200000, "thin air to Titan"),
    )
    sky_top_m: float = param(100e3, "height above which there is no sky", record=False, gt=0.0)
    relief: list[Tint] = param(
        None,
        "height in km and colour of the ground on the globe, rising",
        record=False,
        factory=lambda: [(0.0, *GREY)],
        min_length=1,
    )


class OrientationParams(Params):
    """Where the north pole and the prime meridian point in the celestial frame (ICRF), and their drift: days
    of 86,400 s and Julian centuries since J2000.
    """

    pole_ra_deg: float = param(REQUIRED, "right ascension of the pole", record=False)
    pole_ra_rate_deg_century: float = param(0.0, "drift of the right ascension", record=False)
    pole_dec_deg: float = param(REQUIRED, "declination of the pole", record=False, ge=-90.0, le=90.0)
    pole_dec_rate_deg_century: float = param(0.0, "drift of the declination", record=False)
    prime_meridian_deg: float = param(
        REQUIRED, "prime meridian from the ascending node of the equator", record=False
    )
    prime_meridian_rate_deg_day: float = param(REQUIRED, "rotation of the prime meridian", record=False)


class PlanetParams(Params):
    """Ellipsoid, rotation, gravity field and gas of a planet; one file per planet in edl6dof/data/planets."""

    name: Title = param(REQUIRED, "name of the planet", record=False)
    equatorial_radius_m: float = param(
        REQUIRED,
        "equatorial radius of the reference ellipsoid",
        status="published",
        source="planet file",
        gt=0.0,
        usual=(100000, 8e7, "small moons to Jupiter"),
    )
    mean_radius_m: float = param(
        REQUIRED,
        "mean radius: turns angles into distances over ground",
        status="published",
        source="planet file",
        record=False,
        gt=0.0,
        usual=(100000, 8e7, "small moons to Jupiter"),
    )
    flattening: float = param(
        REQUIRED,
        "flattening of the reference ellipsoid (0: sphere)",
        status="published",
        source="planet file",
        ge=0.0,
        lt=0.1,
        usual=(0, 0.1, "sphere to Saturn"),
    )
    rotation_rate_rad_s: float = param(
        REQUIRED,
        "rotation rate about the north pole",
        status="published",
        source="planet file",
        ge=-1e-3,
        le=1e-3,
        usual=(-0.0002, 0.0002, "as fast as Jupiter"),
    )
    orientation: OrientationParams | None = param(
        None, "pole and prime meridian in the celestial frame: for CCSDS messages", record=False
    )
    areoid: str = param(
        "",
        (
            "map of the areoid's height above the ellipsoid, in edl6dof/data/areoid or by absolute path: "
            "heights of air and ground count from it; without one, from the ellipsoid"
        ),
        record=False,
    )
    gravity: GravityParams = section("gravity field")
    gas: GasParams = section("gas of the atmosphere")
    climate: ClimateParams | None = param(
        None, "seasons and surface pressure, for atmosphere.model seasonal", record=False
    )
    appearance: AppearanceParams = group(AppearanceParams, "colours in pictures", record=False)


PLANET = extended(PlanetParams, gravity=GRAVITY, gas=GAS)


def fill_planet(record: np.void, params: PlanetParams) -> None:
    """Copy the parameters and derive the gravity weights and the rows of the gas."""
    fill(record, params)
    fill_gas(record["gas"], params.gas)
    fill_gravity(record["gravity"], params.gravity)
