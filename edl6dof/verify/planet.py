"""Check cases of gravity, areoid and air of the planet."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
from scipy.special import factorial, lpmv

import edl6dof
from edl6dof.environment.areoid import areoid_height
from edl6dof.environment.atmosphere import air
from edl6dof.environment.gravity import gravity_F, read_coefficients
from edl6dof.spatial.frames import from_geodetic
from edl6dof.verify.case import Bench, given, largest, records_of

_CSV = Path(edl6dof.__file__).parent / "data" / "atmosphere" / "USStandardAtmosphere1976.csv"
_EARTH = 6356766.0
#: Geopotential altitude (m) of the base of the layers, and the pressure (Pa) there.
_BASES = (0.0, 11e3, 20e3, 32e3, 47e3, 51e3, 71e3)
_PRESSURES = (101325.0, 22632.06, 5474.889, 868.0187, 110.9063, 66.93887, 3.956420)


def us76_table(bench: Bench) -> None:
    """Verifies: the U.S. Standard Atmosphere 1976.

    gravity none | atmosphere us76 | winds none | vehicle none | source: published table (NOAA-S/T 76-1562):
    temperature and density against geopotential altitude as shipped (csv, up to 84 km), pressure at the layer
    bases of its table 4 | tolerance: half a unit of the last printed digit, which is what a table can prove:
    0.005 K (csv: two decimals), 5e-6 of six-digit densities and seven-digit pressures.

    Compare at every row of the table.
    """
    _, loaded = bench.scenes(["atmosphere.model=us76"])
    case, tables = records_of(loaded)

    def at(height: float) -> tuple[float, float, float, float]:
        geometric = _EARTH * height / (_EARTH - height)
        return air(case["atmosphere"], case["planet"]["gas"], tables["atmosphere"], geometric)

    rows = np.genfromtxt(_CSV, delimiter=",", skip_header=2)
    rows = rows[(rows[:, 0] >= 0.0) & (rows[:, 0] <= 84500.0)]
    got = np.array([at(float(height)) for height in rows[:, 0]])
    pressed = largest(np.array([at(height)[1] for height in _BASES]) / _PRESSURES - 1.0)
    compare = partial(bench.compare, verifies="US76", source="published table")
    compare("temperature", largest(got[:, 2] - rows[:, 1]), 0.005, "K", why="two decimals printed")
    compare("density", largest(got[:, 0] / rows[:, 2] - 1.0), 5e-6, why="six digits printed")
    compare("pressure at layer bases", pressed, 5e-6, why="seven digits printed")
    curves = rows[:, 0] / 1e3, got[:, 0], rows[:, 2]
    bench.plot("US76", "geopotential altitude (km)", "density (kg/m3)", *curves)


def potential(p: np.ndarray, degree: int, only_j2: float | None = None) -> float:
    """Potential (m2/s2) at ``p`` (m) without its central term."""
    radius, mu, C, S = read_coefficients("gmm3_degree12_sha.tab")
    r, lon = float(np.linalg.norm(p)), np.arctan2(p[1], p[0])
    if only_j2 is not None:
        return -mu / r * (radius / r) ** 2 * only_j2 * float(lpmv(0, 2, p[2] / r))
    total = 0.0
    for n in range(2, degree + 1):
        m = np.arange(n + 1)
        norm = np.sqrt(np.where(m == 0, 1, 2) * (2 * n + 1) * factorial(n - m) / factorial(n + m))
        legendre = (-1.0) ** m * lpmv(m, n, p[2] / r) * norm
        total += (radius / r) ** n * float(
            np.sum(legendre * (C[n, m] * np.cos(m * lon) + S[n, m] * np.sin(m * lon)))
        )
    return mu / r * total


def _gradient(p: np.ndarray, degree: int, only_j2: float | None) -> np.ndarray:
    """Gradient of :func:`potential` (m/s2), by central differences with one Richardson step."""
    out = np.zeros(3)
    for axis, e in enumerate(np.eye(3)):
        near, far = (
            (potential(p + h * e, degree, only_j2) - potential(p - h * e, degree, only_j2)) / (2.0 * h)
            for h in (1000.0, 2000.0)
        )
        out[axis] = (4.0 * near - far) / 3.0
    return out


def gravity_field(bench: Bench) -> None:
    """Verifies: gravity by spherical harmonics (degree 4 and 12) and by J2.

    gravity harmonics, J2 | atmosphere none | winds none | vehicle none | source: the potential in spherical
    coordinates with scipy's associated Legendre functions, and its gradient by central differences with one
    Richardson step | tolerance 1e-12 m/s2: differences over 1 and 2 km of a potential of 1e4 m2/s2 beyond the
    centre round to 1e-14 and truncate at (12 x 2 km / 3,400 km)^4 of degree 12's 1e-4 m/s2, 3e-13.

    Compare at random points up to 200 km above the surface.
    """
    rng, count = np.random.default_rng(5), 12
    direction = rng.normal(size=(count, 3))
    points = direction / np.linalg.norm(direction, axis=1)[:, None] * rng.uniform(3.38e6, 3.6e6, (count, 1))
    source, why = "finite difference of the potential, scipy", "truncation and rounding of the difference"
    for model, degree in (("harmonics", 4), ("harmonics", 12), ("j2", 2)):
        nominal, loaded = bench.scenes(given("planet.gravity", model=model, degree=degree))
        field = records_of(loaded)[0]["planet"]["gravity"]
        mu, only = nominal.planet.gravity.mu_m3_s2, nominal.planet.gravity.j2 if model == "j2" else None
        gaps = [
            gravity_F(field, tuple(p)) + mu * p / np.linalg.norm(p) ** 3 - _gradient(p, degree, only)
            for p in points
        ]
        error = float(max(np.linalg.norm(gap) for gap in gaps))
        name = "J2" if model == "j2" else f"degree {degree}"
        bench.compare(name, error, 1e-12, "m/s2", "gravity field", source, why)


def areoid(bench: Bench) -> None:
    """Verifies: the areoid is a surface of one potential of gravity and rotation.

    gravity harmonics, degree 12 | atmosphere none | winds none | vehicle none | source: the potential of
    :func:`potential` with the central and the centrifugal term; on the areoid it is its mean over the equator
    at 3,396 km (Smith et al., JGR 106 (2001) 23,689) | tolerance 1 m: bilinear interpolation over 1 deg errs
    by n^2 N (pi/180)^2 / 8, of which the 1 km of degree 2 and 3 has 0.3 m, and the 100 m of degree 12 0.5 m.

    Compare the potential, as a height, at random places on the areoid.
    """
    nominal, loaded = bench.scenes(())
    planet, mapped = nominal.planet, loaded.scenario.planet
    radius, mu, *_ = read_coefficients(planet.gravity.coefficients)

    def level(p: np.ndarray) -> float:
        turning = 0.5 * planet.rotation_rate_rad_s**2 * float(p[0] ** 2 + p[1] ** 2)
        return mu / float(np.linalg.norm(p)) + potential(p, 12) + turning

    turns = np.radians(15.0 * np.arange(24))
    reference = np.mean([level(radius * np.array([np.cos(a), np.sin(a), 0.0])) for a in turns])
    rng, errors = np.random.default_rng(14), []
    for _ in range(40):
        lat, lon = float(np.arcsin(rng.uniform(-0.999, 0.999))), float(rng.uniform(-np.pi, np.pi))
        height, shape = areoid_height(mapped, lat, lon), (mapped.equatorial_radius_m, mapped.flattening)
        p = np.array(from_geodetic(*shape, lat, lon, height))
        errors.append((level(p) - reference) * float(p @ p) / mu)
    about = ("areoid map", "scipy's Legendre functions", "bilinear interpolation over 1 deg")
    bench.compare("height of one potential", largest(errors), 1.0, "m", *about)


#: Place of Viking 1 (deg; m above the areoid), and moments with the daily mean of the pressure (Pa) that it
#: measured: after landing, at the southern cap's largest extent (solar longitude 150 deg), and in the cap's
#: summer (257 deg).
_VIKING_1 = (22.48, 312.05, -3627.0)
_SEASONS = {
    "first": ("1976-07-22T12:00:00", 765.0),
    "least": ("1976-11-08T00:00:00", 680.0),
    "greatest": ("1977-05-10T00:00:00", 900.0),
}


def seasonal_column(bench: Bench) -> None:
    """Verifies: surface pressure by season, and hydrostatic balance of the column above.

    gravity harmonics, degree 4 | atmosphere seasonal | winds none | vehicle none | source: daily mean
    pressure at Viking 1, 7.65 mbar in the first four sols (Hess et al., Science 193 (1976) 788), later as low
    as 6.8 mbar when the southern cap was largest and as high as 9.0 mbar (NASA's summary of the mission,
    second hand); weight of the air, by Gauss's quadrature of g / (R T) with the gradient of
    :func:`potential` | tolerance 3 % of the pressure: two printed digits (0.7 %), dust and difference of the
    years; 1e-6 of ln p over 90 km: gravity is interpolated between rows 500 m apart.

    Compare the pressure at the ground in three seasons, and between the ground and 90 km.
    """
    lat_deg, lon_deg, ground = _VIKING_1
    scene = [
        "atmosphere.model=seasonal",
        *given("atmosphere.seasonal", surface_pressure_factor=1.0, temperature_bias_k=0.0),
        *given("terrain", site_latitude_deg=lat_deg, site_longitude_deg=lon_deg, site_elevation_m=ground),
    ]
    source, why = "pressure at Viking 1", "printed digits, differences of the years"
    for name, (epoch, measured) in _SEASONS.items():
        nominal, loaded = bench.scenes([*scene, f"initial.epoch_utc={epoch}"])
        case, tables = records_of(loaded)
        at = partial(air, case["atmosphere"], case["planet"]["gas"], tables["atmosphere"])
        off = abs(at(ground)[1] / measured - 1.0)
        bench.compare(f"{name} pressure", off, 0.03, "-", "seasonal pressure", source, why)
    planet, (lat, lon) = nominal.planet, np.radians(_VIKING_1[:2])
    up = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    shape = (planet.equatorial_radius_m, planet.flattening)
    base = np.array(from_geodetic(*shape, lat, lon, areoid_height(planet, lat, lon)))

    def weight(height: float) -> float:
        p = base + height * up
        pull = -planet.gravity.mu_m3_s2 * p / np.linalg.norm(p) ** 3 + _gradient(p, 4, None)
        pull[:2] += planet.rotation_rate_rad_s**2 * p[:2]
        return -float(pull @ up)

    edges = np.concatenate([[ground], np.arange(-3500.0, 90001.0, 500.0)])
    nodes, shares = np.polynomial.legendre.leggauss(4)
    heights = 0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * nodes
    few = np.linspace(ground, 90e3, 9)
    pull = np.polynomial.Polynomial.fit(few, [weight(h) for h in few], 6)(heights)
    cold = np.array([[at(h)[2] for h in row] for row in heights])
    carried = 0.5 * np.diff(edges) @ (pull / (planet.gas.gas_constant_j_kg_k * cold)) @ shares
    fallen = np.log(at(ground)[1] / at(90e3)[1])
    about = ("hydrostatic column", "weight of the air, quadrature", "gravity between rows of 500 m")
    bench.compare("ln p, ground to 90 km", abs(fallen - carried), 1e-6, "-", *about)
