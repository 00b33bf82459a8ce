"""Check cases of the capsule: trim, frequency and damping in pitch, thin air, and its equilibrium glide."""

from __future__ import annotations

from functools import partial
from math import exp, pi, sqrt
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

import edl6dof
from edl6dof.config.base import stated
from edl6dof.scenario.schema import Scenario
from edl6dof.verify import case
from edl6dof.verify.case import BARE, ENDLESS, NO_RATE, ONE_BODY, Bench, fit, given, largest

_TABLE = Path(edl6dof.__file__).parent / "data" / "aerodynamics" / "phoenix_70deg_static_aero.csv"
DIAMETER = 3.4
STATION = -0.85
REFERENCE = -0.253 * DIAMETER
TRIM_DEG = 11.0


class Published:
    """CA, CN and Cm at one Mach number over alpha (deg)."""

    def __init__(self, mach: float) -> None:
        rows = np.genfromtxt(_TABLE, delimiter=",", skip_header=3)
        angle, drag, lift, moment = rows[rows[:, 0] == mach][:, 1:5].T
        a = np.radians(angle)
        axial, normal = drag * np.cos(a) - lift * np.sin(a), drag * np.sin(a) + lift * np.cos(a)
        mirrored = np.concatenate([-angle[:0:-1], angle])
        both = [np.concatenate([s * y[:0:-1], y]) for s, y in ((1, axial), (-1, normal), (-1, moment))]
        self.axial, self.normal, self.moment = (PchipInterpolator(mirrored, y) for y in both)
        self.lift = float(-lift[angle == TRIM_DEG][0])
        self.lift_to_drag = self.lift / float(drag[angle == TRIM_DEG][0])

    def offset(self) -> float:
        """Station z (m) of the centre of mass that trims the capsule at alpha = -``TRIM_DEG``: lift up."""
        ca, cn, cm = self.axial(TRIM_DEG), self.normal(TRIM_DEG), self.moment(TRIM_DEG)
        return float((DIAMETER * cm + (REFERENCE - STATION) * cn) / ca)

    def pitching(self, alpha_deg: float, z: float) -> float:
        """Moment about the centre of mass at station ``z`` over dynamic pressure and area, m."""
        ca, cn, cm = self.axial(alpha_deg), self.normal(alpha_deg), self.moment(alpha_deg)
        return float(DIAMETER * cm + z * ca + (REFERENCE - STATION) * cn)


#: A capsule of the published table as it stands, in a gas whose ratio of specific heats is one number.
HEAT_CAPACITY_RATIO = 1.29
_CAPSULE = (
    *(*BARE, *ONE_BODY, *ENDLESS, NO_RATE, "vehicle.aero.capsule.axial_factor=1"),
    *given("planet.gas", heat_capacity_ratio=HEAT_CAPACITY_RATIO, vibrations=[]),
    *given("initial", beta_deg=0, bank_deg=0),
)


def _scene(mach: float, density: float, extra: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Overrides for a capsule at one Mach number that trims at alpha = -11 deg.

    The vehicle weighs a million tonnes with the inertia of the real capsule: it turns like the capsule and
    neither slows down nor turns its path, so the linearised pitch equation alone governs it.
    """
    sound = sqrt(HEAT_CAPACITY_RATIO * 191.0 * 214.0)
    return (
        *(*_CAPSULE, *case.WEIGHTLESS, *case.UNIFORM, "vehicle.aero.capsule.damping_factor=0"),
        *given("vehicle.mass", entry_kg=1e9, entry_centre_m=[STATION, 0, Published(mach).offset()]),
        f"atmosphere.exponential.density_kg_m3={density}",
        *given("initial", speed_m_s=mach * sound, altitude_m=1e6),
        *given("initial", flight_path_angle_deg=0, alpha_deg=-TRIM_DEG + 0.05),
        *("simulation.time_limit_s=20", *extra),
    )


def _stiffness(scenario: Scenario, mach: float) -> tuple[float, float]:
    """Natural frequency (rad/s) of the linearised pitch equation about trim, and qbar A D^2 / (2 V Iyy)
    (1/s), without the simulator.
    """
    table = Published(mach)
    speed, inertia = scenario.initial.speed, stated(scenario.vehicle.mass.entry_inertia_kg_m2)[1]
    density = stated(scenario.atmosphere.exponential).density_kg_m3
    push = 0.5 * density * speed**2 * pi / 4.0 * DIAMETER**2
    z, h = table.offset(), 0.01
    slope = (table.pitching(-TRIM_DEG + h, z) - table.pitching(-TRIM_DEG - h, z)) / np.radians(2.0 * h)
    return sqrt(-push * slope / inertia), push * DIAMETER**2 / (2.0 * speed * inertia)


def capsule_trim(bench: Bench) -> None:
    """Verifies: trim angle and pitch frequency of the capsule with an offset centre of mass, at Mach 2 and
    Mach 15.

    gravity none | atmosphere uniform | winds none | vehicle capsule, too heavy to be slowed down | source:
    moment balance and slope of the published coefficients (Phoenix, AIAA 2008-7219) read and interpolated by
    scipy's PCHIP, linearised pitch equation | tolerance: 1e-3 deg of trim (a swing of 0.05 deg shifts its
    middle by its square) and 1e-3 of the frequency (the slope of the moment changes by that within the
    swing).

    Swing 0.05 deg about trim and measure the middle and the frequency.
    """
    compare = partial(bench.compare, source="published table by PCHIP, linearised")
    for mach, density in ((2.0, 1e-2), (15.0, 1e-3)):
        nominal, flight = bench.flown(_scene(mach, density))
        t, alpha = flight.telemetry["t_s"], flight.telemetry["truth.alpha_deg"]
        expected, _ = _stiffness(nominal, mach)
        found, middle = fit(t, alpha, complex(0.0, expected))
        trim, off = abs(middle + TRIM_DEG), abs(found.imag / expected - 1.0)
        about = {"verifies": "static moment, CG offset", "why": "square of the swing"}
        compare(f"trim angle, Mach {mach:g}", trim, 1e-3, "deg", **about)
        about = {"verifies": "static stability", "why": "slope changes within the swing"}
        compare(f"pitch frequency, Mach {mach:g}", off, 1e-3, **about)
    curve = -TRIM_DEG + (alpha[0] + TRIM_DEG) * np.cos(expected * t)
    bench.plot("Pitch at Mach 15", "time (s)", "alpha (deg)", t, alpha, curve)


def damping(bench: Bench) -> None:
    """Verifies: growth and decay of the pitch oscillation by the damping derivative.

    gravity none | atmosphere uniform | winds none | vehicle capsule, too heavy to be slowed down | source:
    linearised pitch equation, the envelope grows with sigma = qbar A D^2 Cmq / (4 V Iyy) | tolerance 1e-3 of
    sigma: curvature of the static moment within the swing of 0.05 deg leaks into the envelope.

    Swing with Cmq = -1 and +1 and measure the growth of the envelope.
    """
    mach, about = 15.0, ("pitch damping", "linearised pitch equation", "curvature of the moment")
    for cmq in (-1.0, 1.0):
        table = {"damping_mach": [6], "damping_angle_deg": [0], "damping_table": [[cmq]]}
        damped = given("vehicle.aero.capsule", damping_factor=1, **table)
        nominal, flight = bench.flown(_scene(mach, 1e-3, damped))
        t, alpha = flight.telemetry["t_s"], flight.telemetry["truth.alpha_deg"]
        frequency, unit = _stiffness(nominal, mach)
        sigma = 0.5 * unit * cmq
        found, _ = fit(t, alpha, complex(sigma, frequency))
        error = abs(found.real / sigma - 1.0)
        bench.compare(f"growth rate, Cmq {cmq:+g}", error, 1e-3, "-", *about)
    envelope, swing = abs(alpha[0] + TRIM_DEG) * np.exp(sigma * t), alpha + TRIM_DEG
    bench.plot("Growth by Cmq = +1: envelope", "time (s)", "alpha from trim (deg)", t, swing, envelope)


#: Roll angle (deg) by which the offset of the centre of mass is turned from the z axis.
_TURNED_DEG = 35.0


def offset_trim(bench: Bench) -> None:
    """Verifies: trim of the capsule with a centre of mass off the axis in y and z, at Mach 15.

    gravity none | atmosphere uniform | winds none | vehicle capsule, too heavy to be slowed down | source: a
    body of revolution trims in the plane of axis and centre of mass, at the total angle of the moment balance
    of ``capsule_trim``; the velocity in B is the one of that case, turned about x | tolerance 2e-3 deg, twice
    the trim error of ``capsule_trim``: a flight that begins off the trim swings to its other side.

    Begin at this trim and compare angle of attack and sideslip for 20 s.
    """
    mach, trim, turn = 15.0, np.radians(TRIM_DEG), np.radians(_TURNED_DEG)
    apart = Published(mach).offset() * np.array([-np.sin(turn), np.cos(turn)])
    u, v, w = np.cos(trim), np.sin(trim) * np.sin(turn), -np.sin(trim) * np.cos(turn)
    alpha, beta = float(np.degrees(np.arctan2(w, u))), float(np.degrees(np.arcsin(v)))
    centre = f"vehicle.mass.entry_centre_m={[STATION, *apart.tolist()]}"
    trimmed = (centre, *given("initial", alpha_deg=alpha, beta_deg=beta))
    rows = bench.flown(_scene(mach, 1e-3, trimmed))[1].telemetry
    about = "static moment, CG offset in y and z", "published table by PCHIP, turned", "twice the trim error"
    for name, angle in (("alpha", alpha), ("beta", beta)):
        bench.compare(name, largest(rows[f"truth.{name}_deg"] - angle), 2e-3, "deg", *about)


#: Knudsen number, and share of the free-molecular coefficient: sin^2 of 0, pi/8, pi/4, 3 pi/8, pi/2.
_SHARES = {1e-3: 0.0, 1e-2: 0.5 - sqrt(0.125), 0.1: 0.5, 1.0: 0.5 + sqrt(0.125), 10.0: 1.0, 1e3: 1.0}


def bridging(bench: Bench) -> None:
    """Verifies: axial force from continuum to free-molecular flow, at Mach 15.

    gravity none | atmosphere uniform | winds none | vehicle capsule at zero angle of attack | source:
    continuum: published table (Phoenix, AIAA 2008-7219); free-molecular: molecules that lose all momentum to
    the wall give a drag coefficient of 2 on the projected area; between them sin^2(pi/8 (3 + log10 Kn))
    (Wilmoth, Mitcheltree & Moss, AIAA 97-2510), with the mean free path m / (sqrt(2) pi d^2 rho) of hard
    spheres | tolerance 1e-9: quadrature of the capsule's surface.

    Compare the axial coefficient at the start of flights in six densities.
    """
    mach, dense = 15.0, float(Published(15.0).axial(0.0))
    about = ("-", "rarefied flow", "published table, momentum of molecules", "quadrature of the surface")
    start = (
        *("vehicle.mass.entry_centre_m=[-0.85, 0, 0]", "simulation.time_limit_s=0.02"),
        *given("initial", alpha_deg=0, altitude_m=1000),
    )
    gas = case.scenes(())[0].planet.gas
    path = gas.molecular_mass_kg / (sqrt(2.0) * pi * gas.molecular_diameter_m**2)
    for knudsen, share in _SHARES.items():
        density = path / (knudsen * DIAMETER)
        nominal, flight = bench.flown(_scene(mach, density, start))
        push = 0.5 * density * nominal.initial.speed**2 * pi / 4.0 * DIAMETER**2
        found = -float(flight.telemetry["truth.aero_force_x_n"][0]) / push
        error = abs(found - dense - share * (2.0 - dense))
        bench.compare(f"axial coefficient, Kn {knudsen:g}", error, 1e-9, *about)


_MASS, _ALTITUDE, _SCALE, _RADIUS, _MU = 1285.0, 10e3, 200.0, 3396190.0, 4.282837285418775e13
_R, _START = _RADIUS + _ALTITUDE, 0.8
_G = _MU / _R**2


def _glide(table: Published) -> tuple[str, ...]:
    """Overrides for a glide from 80 % of circular energy, with lift equal to the weight to be carried."""
    speed2 = _START * _G * _R
    short = 4.0 * _SCALE / (_R * table.lift_to_drag**2 * _START)
    weight = _MASS * _G * (1.0 - _START) * (1.0 - short)
    density = 2.0 * weight / (table.lift * pi / 4.0 * DIAMETER**2 * speed2)
    slope = -np.degrees(2.0 * _SCALE / (_R * table.lift_to_drag * _START))
    return (
        *(*_CAPSULE, "atmosphere.model=exponential", "simulation.time_limit_s=130"),
        *(f"planet.equatorial_radius_m={_RADIUS}", "planet.gas.molecular_diameter_m=1e-8"),
        *given("planet.gravity", model="central", mu_m3_s2=_MU),
        f"atmosphere.exponential={{density_kg_m3: {density * exp(_ALTITUDE / _SCALE)!r}, "
        f"scale_height_m: {_SCALE}, temperature_k: 5}}",
        *given("vehicle.mass", entry_kg=_MASS, entry_centre_m=[STATION, 0, table.offset()]),
        *given("initial", altitude_m=_ALTITUDE, latitude_deg=0, azimuth_deg=90, alpha_deg=-TRIM_DEG),
        *given("initial", speed_m_s=float(np.sqrt(speed2)), flight_path_angle_deg=float(slope)),
    )


def equilibrium_glide(bench: Bench) -> None:
    """Verifies: lift, drag and the curvature of the planet together, on a glide from 80 % to 35 % of circular
    energy.

    gravity central | atmosphere exponential, 200 m scale height (makes the glide's own approximation good) |
    winds none | vehicle capsule trimmed at alpha = -11 deg beyond Mach 30, where its table is constant |
    source: Eggers, Allen & Neice, NACA report 1382 (1957): the lift L equals the weight less the centrifugal
    force, L = m (g - V^2/r), and the range from the speed V0 to V1 is r/2 L/D ln((1 - u1) / (1 - u0)), with u
    = V^2 / (g r) at either speed | tolerance 1 %: the expected values include two corrections of first
    order. The path steepens, so the lift is smaller by the share 4 H / (r (L/D)^2 u) (1 to 2.5 %; H: scale
    height); the range includes this share and the component of the weight along the path. Errors of second
    order, the slow phugoid from the start, and the change of weight with altitude are not included.

    Glide for 130 s; compare lift and weight at each speed, and the range.
    """
    table = Published(30.0)
    rows = bench.flown(_glide(table))[1].telemetry
    t, v, r = rows["t_s"], rows["truth.speed_m_s"], _RADIUS + rows["truth.altitude_m"]
    u = v**2 * r / _MU
    short = 4.0 * _SCALE / (r * table.lift_to_drag**2 * u)
    lift = 0.5 * rows["truth.density_kg_m3"] * v**2 * table.lift * pi / 4.0 * DIAMETER**2 / _MASS
    ratio = lift / ((1.0 - u) * (1.0 - short) * _MU / r**2)
    east = np.radians(rows["truth.longitude_deg"])
    flown_range = float(np.mod(east[-1] - east[0], 2.0 * pi) * r.mean())
    steeper = 1.0 - short - 2.0 * _SCALE / (r * u * (1.0 - u))
    expected = float(-0.5 * r.mean() * table.lift_to_drag * np.trapezoid(1.0 / ((1.0 - u) * steeper), u))
    off, why = abs(flown_range / expected - 1.0), "second order of the glide's approximation"
    compare = partial(bench.compare, source="Eggers, Allen & Neice, NACA 1382", why=why)
    compare("lift against weight", largest(ratio - 1.0), 1e-2, verifies="lift over a curved planet")
    compare("range", off, 1e-2, verifies="lift-to-drag ratio")
    bench.plot("Equilibrium glide", "time (s)", "lift (m/s2)", t, lift, lift / ratio)
