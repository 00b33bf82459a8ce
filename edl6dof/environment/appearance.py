"""How the planet looks in pictures; no flight depends on it."""

from __future__ import annotations

from edl6dof.config.base import Params, Vec3, param

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
