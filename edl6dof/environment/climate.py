"""Climate of a planet: the pressure of its air at the ground by season and elevation.

The mean over the day; tides move it by 1 to 5 %, dust storms by more.
Source: Withers, Space Science Reviews 170 (2012) 837-860, "Empirical estimates of Martian surface pressure in
support of the landing of Mars Science Laboratory", whose coefficients are in the planet file.
"""

from __future__ import annotations

from edl6dof.config.base import REQUIRED, Params, param, section
from edl6dof.environment.calendar import CalendarParams
from edl6dof.spatial.elementary import cos, exp, sin


class SurfacePressureParams(Params):
    """Pressure at the ground: exponential in the elevation, two harmonics of the season."""

    pressure_pa: float = param(
        REQUIRED,
        "mean over the year at that elevation",
        record=False,
        gt=0.0,
        usual=(0.5, 1e7, "Pluto to Venus"),
    )
    elevation_m: float = param(REQUIRED, "elevation above the areoid that it is of", record=False)
    scale_height_m: float = param(
        REQUIRED,
        "elevation over which it falls by e",
        record=False,
        gt=100.0,
        le=1e6,
        usual=(3000, 80000, "Venus to Saturn"),
    )
    season: tuple[float, float, float, float] = param(
        (0.0, 0.0, 0.0, 0.0),
        "relative change with the season: of the sine and cosine of the solar longitude, and of twice it",
        record=False,
    )


class ClimateParams(Params):
    """What the air of a planet that has seasons follows from."""

    calendar: CalendarParams = section("season and hour of a moment", record=False)
    surface_pressure: SurfacePressureParams = section("pressure at the ground", record=False)


def surface_pressure(law: SurfacePressureParams, season: float, elevation: float) -> float:
    """Pressure (Pa) at the ground at an ``elevation`` (m) above the areoid and a solar longitude (rad)."""
    a, b, c, d = law.season
    change = a * sin(season) + b * cos(season) + c * sin(2.0 * season) + d * cos(2.0 * season)
    return law.pressure_pa * exp((law.elevation_m - elevation) / law.scale_height_m) * (1.0 + change)
