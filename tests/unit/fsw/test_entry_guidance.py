"""Entry guidance against an independently integrated point mass, quadrature and vector geometry."""

from math import atan2, cos, exp, log, pi, radians, sin, sqrt

import numpy as np
import pytest
from given_functions import entry_guidance
from scipy.integrate import quad, solve_ivp

from edl6dof.fsw.guidance.entry.aim_point import to_target
from edl6dof.fsw.guidance.entry.airframe import mach_nodes
from edl6dof.fsw.guidance.entry.drag_dynamics import (
    drag_dynamics,
    drag_dynamics_in_air,
    measured_drag_dynamics,
)
from edl6dof.fsw.guidance.entry.range_update import range_scale, scaled, tracking
from edl6dof.fsw.guidance.entry.reference import REFERENCE
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS, ENTRY_MEMORY
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV

RADIUS, MU = 3.3962e6, 4.2828e13
SCALE_HEIGHT, DENSITY = 9354.0, 0.0158
BALLISTIC, LIFT_TO_DRAG = 90.0, 0.18  # kg/m2


# ---- drag dynamics -----------------------------------------------------------------------------------------


def motion(cos_bank):
    """Wu et al. eqs. 1-3, 7, 8: radius, speed, flight-path angle."""

    def rates(t, s):
        r, v, gamma = s
        drag = drag_at(r, v)
        g = MU / r**2
        return [
            v * sin(gamma),
            -drag - g * sin(gamma),
            LIFT_TO_DRAG * drag * cos_bank / v + (v / r - g / v) * cos(gamma),
        ]

    return rates


def drag_at(r, v):
    return 0.5 * DENSITY * np.exp(-(r - RADIUS) / SCALE_HEIGHT) * v**2 / BALLISTIC


@pytest.mark.parametrize(
    "altitude, speed, gamma_deg",
    [(60e3, 4800.0, -11.0), (35e3, 3800.0, -8.0), (15e3, 1200.0, -14.0), (25e3, 2500.0, 3.0)],
)
def test_drag_derivatives_are_those_of_an_integrated_trajectory(altitude, speed, gamma_deg):
    """D' and, from two bank angles, the free and the bank part of D''; five-point differences of the
    integrated drag.
    """
    r, gamma = RADIUS + altitude, radians(gamma_deg)
    h = 0.5
    first, second = {}, {}
    for cos_bank in (0.9, -0.3, 0.0):
        values = []
        for side in (-1.0, 1.0):
            steps = side * h * np.array([1.0, 2.0])
            out = solve_ivp(
                motion(cos_bank), (0.0, steps[-1]), [r, speed, gamma], t_eval=steps, rtol=1e-12, atol=1e-10
            )
            values.append(drag_at(out.y[0], out.y[1]))
        (m1, m2), (p1, p2), zero = values[0], values[1], drag_at(r, speed)
        first[cos_bank] = (8.0 * (p1 - m1) - (p2 - m2)) / (12.0 * h)
        second[cos_bank] = (16.0 * (p1 + m1) - (p2 + m2) - 30.0 * zero) / (12.0 * h * h)
    drag, g = drag_at(r, speed), MU / r**2
    rate, a, b = drag_dynamics(drag, speed, gamma, r, g, LIFT_TO_DRAG * drag, SCALE_HEIGHT)
    assert rate == pytest.approx(first[0.9], rel=1e-5)
    assert rate == pytest.approx(first[-0.3], rel=1e-5)  # bank acts on the second derivative only
    assert a == pytest.approx((second[0.9] - second[-0.3]) / 1.2, rel=1e-3)
    assert b == pytest.approx(second[0.0], rel=1e-3, abs=1e-5)
    assert a < 0.0  # lift up lowers drag


@pytest.mark.parametrize("cos_bank", [0.5, -0.2])
@pytest.mark.parametrize("altitude, speed, climb", [(30e3, 4800.0, -900.0), (15e3, 2500.0, -250.0)])
def test_drag_derivatives_hold_in_the_expected_wind_and_where_the_scale_height_changes(
    onboard, altitude, speed, climb, cos_bank
):
    """Towards the east over a sphere, in a tail wind that grows with height; five-point differences of the
    integrated drag.  In still air of one scale height the derivatives would be wrong by many times as much.
    """
    record, scale, change, wind = onboard[0], 8000.0, -0.1, (20.0, 1e-3)
    air, vehicle = record["atmosphere"], record["vehicle"]
    heights = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    held = -np.log(np.maximum(scale + change * heights, 100.0) / scale) / change
    air["ln_density"], air["wind_north"], air["wind_east"] = held - 4.0, 0.0, wind[0] + wind[1] * heights
    vehicle["airframe"]["drag"] = 1.0
    altitude = heights[round((altitude - air["bottom"]) / air["spacing"])] + 0.5 * air["spacing"]

    def through(s):
        east, up = s[1] - wind[0] - wind[1] * s[0], s[2]
        size = np.hypot(east, up)
        density = exp(-log((scale + change * s[0]) / scale) / change - 4.0)
        return 0.5 * density * size**2 / BALLISTIC, east / size, up / size

    def rates(t, s):
        r, (drag, east, up) = RADIUS + s[0], through(s)
        lift = LIFT_TO_DRAG * drag * cos_bank
        forward = -drag * east - lift * up
        return [s[2], forward - s[1] * s[2] / r, -drag * up + lift * east + s[1] ** 2 / r - MU / r**2]

    h, start = 0.2, [altitude, sqrt(speed**2 - climb**2), climb]
    m2, m1, zero, p1, p2 = (
        through(solve_ivp(rates, (0.0, k * h), start, rtol=1e-12, atol=1e-9).y[:, -1])[0]
        if k
        else through(start)[0]
        for k in (-2, -1, 0, 1, 2)
    )
    first = (8.0 * (p1 - m1) - (p2 - m2)) / (12.0 * h)
    second = (16.0 * (p1 + m1) - (p2 + m2) - 30.0 * zero) / (12.0 * h * h)
    nav = np.zeros(1, NAV)[0]
    nav["altitude"], nav["radius"], nav["gravity"] = (
        altitude,
        RADIUS + altitude,
        MU / (RADIUS + altitude) ** 2,
    )
    nav["speed"], nav["drag"], nav["v_N"], nav["mach"] = speed, zero, (0.0, start[1], -climb), speed / 230.0
    nav["flight_path_angle"] = np.arcsin(climb / speed)
    errors = []
    vehicle["lift_to_drag"], vehicle["airframe"]["lift"] = LIFT_TO_DRAG, 1.0
    still = measured_drag_dynamics(record, nav, LIFT_TO_DRAG * zero)
    for rate, a, b in (drag_dynamics_in_air(record, nav), still):
        errors.append((abs(rate - first), abs(b + a * cos_bank - second)))
    assert errors[0][0] < 0.1 * errors[1][0] and errors[0][1] < 0.3 * errors[1][1]


# ---- range update ------------------------------------------------------------------------------------------


def table(first=450.0, last=4900.0):
    reference = np.zeros(1, REFERENCE)[0]
    n = len(reference["drag"])
    reference["first"], reference["spacing"] = first, (last - first) / (n - 1)
    u = first + reference["spacing"] * np.arange(n)
    reference["drag"], reference["ground"] = profile(u), slope(u)
    # along a flight without gravity, u' = -D, that meets the reference drag
    reference["drag_rate"] = -profile(u) * derivative(profile, u)
    reference["drag_acceleration"] = -profile(u) * derivative(
        lambda x: -profile(x) * derivative(profile, x), u
    )
    return reference


def derivative(function, x):
    return (function(x + 1.0) - function(x - 1.0)) / 2.0


def profile(u):
    return 8.0 + 75.0 * np.exp(-(((u - 3300.0) / 1100.0) ** 2))


def slope(u):
    return 0.97 + 0.02 * np.cos(u / 900.0)


def factor(u, scale, first=450.0, last=4900.0):
    """Wu et al. eq. 15 over the energies of the whole reference."""
    share = (u**2 - first**2) / (last**2 - first**2)
    return 1.0 + scale * 2.0 * (1.0 - sqrt(2.0) * (share - 0.5) ** 2)


def integrated_range(u_now, u_end, scale):
    """Wu et al. eq. 14 by adaptive quadrature over energy."""
    now, end = 0.5 * u_now**2, 0.5 * u_end**2

    def integrand(energy):
        u = sqrt(2.0 * energy)
        return slope(u) / (profile(u) * factor(u, scale))

    return quad(integrand, end, now, epsrel=1e-10, limit=200)[0]


@pytest.mark.parametrize("scale", [-0.25, -0.05, 0.0, 0.1, 0.3])
@pytest.mark.parametrize("u_now", [4700.0, 3111.1, 1500.0, 905.0])
def test_drag_scale_gives_the_wanted_range_by_independent_quadrature(scale, u_now):
    reference = table()
    wanted = integrated_range(u_now, 450.0, scale)
    found = 0.0
    for _ in range(3):  # guidance calls it again every cycle
        found = range_scale(reference, u_now, wanted, found, 0.4)
    assert integrated_range(u_now, 450.0, found) == pytest.approx(wanted, rel=4e-3)
    assert found == pytest.approx(scale, abs=4e-3)


def test_drag_scale_converges_from_the_old_value_in_one_call_and_respects_its_limit():
    reference = table()
    wanted = integrated_range(3000.0, 450.0, 0.1)
    assert range_scale(reference, 3000.0, wanted, 0.08, 0.4) == pytest.approx(0.1, abs=2e-3)
    assert range_scale(reference, 3000.0, 0.2 * wanted, 0.0, 0.4) == pytest.approx(0.4)
    assert range_scale(reference, 3000.0, 5.0 * wanted, 0.0, 0.4) == pytest.approx(-0.4)
    assert range_scale(reference, 452.0, wanted, 0.123, 0.4) == 0.123  # too close to the end: frozen


def test_longer_range_wants_less_drag():
    reference = table()
    nominal = integrated_range(3500.0, 450.0, 0.0)
    assert range_scale(reference, 3500.0, 1.05 * nominal, 0.0, 0.4) < -0.005
    assert range_scale(reference, 3500.0, 0.95 * nominal, 0.0, 0.4) > 0.005


@pytest.mark.parametrize("scale", [-0.25, 0.0, 0.15, 0.3])
@pytest.mark.parametrize("share", [1.0, 0.85])
@pytest.mark.parametrize("u_now", [4300.0, 2600.0, 1100.0])
def test_goal_and_its_rates_are_those_of_the_scaled_profile_along_the_flight(scale, share, u_now):
    """Drag, drag rate and acceleration of the goal against finite differences along an integrated flight,
    whose drag is the goal (or a share of it: a flight behind its goal passes the energies more slowly).

    With the scale to the first power on rate and acceleration, as once, this fails for every scale but none.
    """
    h = 0.2

    def goal(u):
        return profile(u) * factor(u, scale)

    steps = h * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    back, on = (
        solve_ivp(
            lambda t, u: -share * goal(u),
            (0.0, side * 2.0 * h),
            [u_now],
            rtol=1e-12,
            atol=1e-9,
            dense_output=True,
        ).sol
        for side in (-1.0, 1.0)
    )
    d = np.array([goal(float((back if t < 0.0 else on)(t)[0])) for t in steps])
    rate = (8.0 * (d[3] - d[1]) - (d[4] - d[0])) / (12.0 * h)
    acceleration = (16.0 * (d[3] + d[1]) - (d[4] + d[0]) - 30.0 * d[2]) / (12.0 * h * h)
    found = scaled(table(), scale, u_now, u_now, 0.0, share * d[2], share * rate)
    assert found[0] == pytest.approx(d[2], rel=1e-4)
    assert found[1] == pytest.approx(rate, rel=2e-3, abs=1e-3)
    assert found[2] == pytest.approx(acceleration, rel=1e-2, abs=2e-3)


# ---- geometry ----------------------------------------------------------------------------------------------


def point(lat, lon):
    return np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])


def test_range_crossrange_and_downrange_to_go_are_those_of_vector_geometry(onboard):
    rng = np.random.default_rng(0)
    site = onboard[0]["site"]
    radius = onboard[0]["planet"]["equatorial_radius"]
    target = point(site["aim_latitude"], site["aim_longitude"])
    nav = np.zeros(1, NAV)[0]
    for _ in range(200):
        nav["latitude"] = site["aim_latitude"] + rng.uniform(-0.3, 0.3)
        nav["longitude"] = site["aim_longitude"] + rng.uniform(-0.3, 0.3)
        nav["azimuth"] = rng.uniform(-pi, pi)
        here = point(nav["latitude"], nav["longitude"])
        east = np.cross((0.0, 0.0, 1.0), here)
        east /= np.linalg.norm(east)
        along = cos(nav["azimuth"]) * np.cross(here, east) + sin(nav["azimuth"]) * east
        left = np.cross(here, along)
        distance, crossrange, downrange = to_target(onboard[0], nav)
        assert distance == pytest.approx(
            radius * atan2(np.linalg.norm(np.cross(here, target)), here @ target), abs=1e-3
        )
        # target on the left of the track: the velocity points to its right
        assert crossrange == pytest.approx(radius * np.arcsin(target @ left), abs=1e-3)
        # what is flown along the track to the foot of the perpendicular from the target
        assert downrange == pytest.approx(radius * atan2(target @ along, target @ here), abs=1e-3)


# ---- reference trajectory ----------------------------------------------------------------------------------


def airframe(vehicle, mach):
    """Believed drag area and lift-to-drag ratio by numpy's interpolation over ln(Mach)."""
    table, x, log = vehicle["airframe"], np.log(mach), np.log(mach_nodes())
    if mach < table["wing_mach"]:
        return vehicle["drag_area"] * np.interp(x, log, table["drag_with_wing"]), 0.0
    return vehicle["drag_area"] * np.interp(x, log, table["drag"]), vehicle["lift_to_drag"] * np.interp(
        x, log, table["lift"]
    )


@pytest.mark.parametrize(
    ("drag", "speed", "tracks"),
    [(0.9, 4000.0, False), (1.0, 4000.0, True), (0.9, 800.0, True), (0.0, 800.0, False), (0.9, 900.0, True)],
)
def test_reference_drag_is_followed_from_a_drag_on_and_to_the_end(onboard, drag, speed, tracks):
    """Once it has slowed down the vehicle stays on it, however thin the air of a skip is."""
    p = onboard[0]["guidance"]["entry"]["tracking"]
    assert (p["start_drag"], p["update_stop"]) == (1.0, 900.0)
    nav = np.zeros(1, NAV)
    nav["drag"], nav["speed"] = drag, speed
    assert tracking(onboard[0], nav[0]) == tracks


def test_tabulated_drag_rate_is_consistent_with_the_tabulated_drag(onboard):
    """dD/du (-D V / u) = dD/dt, since dE = u du = -V D dt."""
    t = onboard[0]["reference"]
    u = t["first"] + t["spacing"] * np.arange(len(t["drag"]))
    middle = slice(40, -40)
    mu, radius = onboard[0]["planet"]["mu"], onboard[0]["planet"]["equatorial_radius"]
    speed = 0.985 * u  # close enough: potential energy is a small share of E at these speeds
    assert mu / radius**2 * 60e3 < 0.05 * 0.5 * 3000.0**2
    predicted = np.gradient(t["drag"], u) * (-t["drag"] * speed / u)
    fast = (u > 2000.0)[middle]
    assert predicted[middle][fast] == pytest.approx(
        t["drag_rate"][middle][fast], abs=0.05 * np.max(np.abs(t["drag_rate"]))
    )


# ---- the law in a closed loop ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "density_factor, range_error_km",
    [
        pytest.param(1.0, 0.0, marks=pytest.mark.long),
        (1.1, 0.0),
        pytest.param(0.92, 0.0, marks=pytest.mark.long),
        pytest.param(1.0, 8.0, marks=pytest.mark.long),
        (1.0, -8.0),
    ],
)
def test_drag_tracking_flies_a_point_mass_to_the_aim_range(
    onboard, planned_rows, density_factor, range_error_km
):
    """Three degrees of freedom in the plane with the believed tables times a factor; bank as commanded once a
    second.
    """
    record = onboard[0]
    planet, vehicle, air, site = record["planet"], record["vehicle"], record["atmosphere"], record["site"]
    site["aim_latitude"], site["aim_longitude"] = 0.0, 0.0
    nodes = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    radius, mu = planet["equatorial_radius"], planet["mu"]
    align, final = record["guidance"]["entry"]["align_speed"], record["guidance"]["entry"]["final_speed"]
    total = float(planned_rows["beyond"][-1] - planned_rows["beyond"][0]) + 1e3 * range_error_km
    nav, guide, memory = np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0], np.zeros(1, ENTRY_MEMORY)[0]
    law = ENTRY_LAWS.names.index("drag_tracking")
    entry = independent_start(record)
    r, v, gamma = radius + entry[0], entry[1], entry[2]
    s, dt = 0.0, 0.2
    k = 0
    while v > final and k < 3000:
        g = mu / r**2
        density = density_factor * np.exp(np.interp(r - radius, nodes, air["ln_density"]))
        mach = v / np.interp(r - radius, nodes, air["speed_of_sound"])
        area, lift_to_drag = airframe(vehicle, mach)
        drag = 0.5 * density * v**2 * area / vehicle["entry_mass"]
        if k % 5 == 0:
            nav["t"], nav["latitude"], nav["longitude"], nav["azimuth"] = (
                k * dt,
                0.0,
                -(total - s) / radius,
                pi / 2,
            )
            nav["speed"], nav["flight_path_angle"], nav["radius"], nav["altitude"] = v, gamma, r, r - radius
            nav["drag"], nav["gravity"], nav["energy"] = drag, g, 0.5 * v * v + mu * (1.0 / radius - 1.0 / r)
            nav["mach"], nav["specific_force_B"] = mach, (-drag, 0.0, lift_to_drag * drag)
            entry_guidance(law, record, nav, memory, guide)
        lift = lift_to_drag * drag * cos(guide["bank"])
        for part in range(2):  # midpoint
            h = 0.5 * dt if part == 0 else dt
            if part == 0:
                base = (r, v, gamma, s)
                rates = (
                    v * sin(gamma),
                    -drag - g * sin(gamma),
                    lift / v + (v / r - g / v) * cos(gamma),
                    v * cos(gamma) * radius / r,
                )
            else:
                density = density_factor * np.exp(np.interp(r - radius, nodes, air["ln_density"]))
                drag = 0.5 * density * v**2 * area / vehicle["entry_mass"]
                lift, g = lift_to_drag * drag * cos(guide["bank"]), mu / r**2
                rates = (
                    v * sin(gamma),
                    -drag - g * sin(gamma),
                    lift / v + (v / r - g / v) * cos(gamma),
                    v * cos(gamma) * radius / r,
                )
            r, v, gamma, s = (x + h * y for x, y in zip(base, rates, strict=True))
        k += 1
    assert abs(s - total) < 5e3
    assert r - radius > 5e3
    assert align > final


def independent_start(record):
    """Entry interface of the reference: highest energy node, at 125 km."""
    top = record["reference"]["first"] + record["reference"]["spacing"] * (
        len(record["reference"]["drag"]) - 1
    )
    planet = record["planet"]
    potential = planet["mu"] * (
        1.0 / planet["equatorial_radius"] - 1.0 / (planet["equatorial_radius"] + 125e3)
    )
    return 125e3, sqrt(top**2 - 2.0 * potential), radians(-11.581)
