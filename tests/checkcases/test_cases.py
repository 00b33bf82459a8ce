"""Every check case passes, and fails for each of these planted errors, which change what flies and not what
is expected.  More for NESC's cases, one for each model: ``tests/nesc/test_check_cases.py``.
"""

from __future__ import annotations

from math import hypot, pi

import pytest

from edl6dof.spatial import frames, quaternion
from edl6dof.verify import free_motion
from edl6dof.verify.check import CASES

#: Their tolerances are below a millimetre.
EXACT = ("jettison", "nesc", "point_mass")
#: Case, a result that must fail, what is planted, and the overrides that plant it.
PLANTED = [
    ("allen_eggers", "speed", "scale height + 1 mm", ["atmosphere.exponential.scale_height_m=9354.001"]),
    ("areoid", "height", "polar radius + 5 m", ["planet.flattening=0.0058845353"]),
    ("bridging", "Kn 0.1", "molecules + 0.2 %", ["planet.gas.molecular_diameter_m=4.60e-10"]),
    ("capsule_trim", "trim", "centre + 0.1 mm", ["vehicle.mass.entry_centre_m=[-0.85, 0, -0.0391]"]),
    ("contact", "height", "damping + 0.1 %", ["vehicle.landing_gear.damping_n_s_m=800.8"]),
    ("damping", "growth rate", "damping + 1 %", ["vehicle.aero.capsule.damping_factor=1.01"]),
    ("equilibrium_glide", "range", "axial force + 3 %", ["vehicle.aero.capsule.axial_factor=1.03"]),
    ("gravity_field", "J2", "sixth digit of J2", ["planet.gravity.j2=1.956617e-03"]),
    ("heating", "heat load", "constant + 1e-6", ["planet.gas.sutton_graves_constant=1.9027019e-4"]),
    ("impulses", "propellant", "valves open 1 % slower", ["vehicle.rcs.thrusters.0.rise_s=0.01212"]),
    ("inflation", "fills", "opening load + 0.1 %", [
        "vehicle.parachutes.main.disk_gap_band.opening_load_factor=1.3453"
    ]),
    ("jettison", "heat shield", "10 mg more", ["vehicle.parts.heat_shield.mass_kg=150.00001"]),
    ("kepler", "position", "mu + 1e-8", ["planet.gravity.mu_m3_s2=4.28283732824714625e13"]),
    ("nesc", "case 6: altitude", "mu + 1e-5", ["planet.gravity.mu_m3_s2=3.98604427804418e14"]),
    ("offset_trim", "beta", "y + 0.1 mm", ["vehicle.mass.entry_centre_m=[-0.85, 0.02272, -0.03231]"]),
    ("pendulum", "pendulum", "normal force + 1 %", ["vehicle.parachutes.main.normal_slope=0.2525"]),
    ("point_mass", "", "bank + 1e-4 deg", ["initial.bank_deg=55.0001"]),
    ("rocket_equation", "mass", "flow - 1e-4", ["vehicle.engines.main.specific_impulse_factor=1.0001"]),
    ("seasonal_column", "least", "mean pressure + 5 %", [
        "planet.climate.surface_pressure.pressure_pa=837"
    ]),
    ("symmetric_top", "rate in the body", "Ixx + 10 g m2", [
        "vehicle.mass.entry_inertia_kg_m2=[1150.01, 900, 900]"
    ]),
    ("terminal_velocity", "speed", "canopy drag + 0.1 %", ["vehicle.parachutes.main.drag_factor=1.001"]),
    ("tumbling", "body rates", "Ixx + 1 g m2", ["vehicle.mass.entry_inertia_kg_m2=[1150.001, 900, 1000]"]),
    ("us76_table", "density", "density + 1e-4", ["atmosphere.density_factor=1.0001"]),
]  # fmt: skip
#: More of them, which the suite has no time for.
PLANTED_LONG = [
    ("allen_eggers", "speed", "path off by 0.1 deg", ["initial.flight_path_angle_deg=-89.9"]),
    ("allen_eggers", "speed", "mass + 0.1 kg", ["vehicle.mass.entry_kg=400.1"]),
    ("capsule_trim", "pitch frequency", "moment + 1 %", ["vehicle.aero.capsule.moment_factor=1.01"]),
    ("capsule_trim", "pitch frequency", "inertia + 0.5 %", [
        "vehicle.mass.entry_inertia_kg_m2=[1150, 904.5, 950]"
    ]),
    ("contact", "height", "stiffness + 1e-4", ["vehicle.landing_gear.stiffness_n_m=40004"]),
    ("equilibrium_glide", "lift", "begun 5 % too fast", ["initial.speed_m_s=3340"]),
    ("equilibrium_glide", "lift", "lift turned by 15 deg", ["initial.bank_deg=15"]),
    ("gravity_field", "degree 4", "cut off at degree 3", ["planet.gravity.degree=3"]),
    ("heating", "heat flux", "nose + 1e-6", ["vehicle.nose_radius_m=0.85000085"]),
    ("impulses", "speed", "Isp + 0.001 %", ["vehicle.rcs.thrusters.0.specific_impulse_s=270.0027"]),
    ("inflation", "open canopy", "drag + 0.1 %", ["vehicle.parachutes.main.drag_factor=1.001"]),
    ("inflation", "fills", "exponent + 1e-3", [
        "vehicle.parachutes.main.disk_gap_band.inflation_exponent=4.004"
    ]),
    ("jettison", "backshell", "inertia + 1 g m2", [
        "vehicle.parts.backshell.inertia_kg_m2=[190.001, 115, 115]"
    ]),
    ("jettison", "mortar", "gravity", ["planet.gravity.model=central", "planet.gravity.mu_m3_s2=100"]),
    ("kepler", "position", "1e-15 kg/m3 of air", [
        "atmosphere.model=exponential",
        "atmosphere.exponential={density_kg_m3: 1e-15, scale_height_m: 1e15, temperature_k: 214}",
        "vehicle.aero.model=constant",
        "vehicle.aero.constant={drag_coefficient: 1, reference_area_m2: 9}",
    ]),
    ("pendulum", "wrist", "bridle + 1 cm", ["vehicle.parachutes.main.confluence_m=[-3.91, 0, 0]"]),
    ("pendulum", "pendulum", "no apparent mass", ["vehicle.parachutes.main.apparent_mass_factor=0"]),
    ("point_mass", "", "planet + 1e-5", ["planet.rotation_rate_rad_s=7.0883e-5"]),
    ("point_mass", "", "L/D + 1e-6", ["vehicle.aero.lift_drag.lift_to_drag=0.200001"]),
    ("rocket_equation", "speed", "Isp + 1 ms", ["vehicle.engines.main.full_specific_impulse_s=300.001"]),
    ("rocket_equation", "speed", "tilt of 0.001 deg", ["vehicle.engines.main.misalignment_y_deg=0.001"]),
    ("seasonal_column", "ln p", "gas constant + 1e-4", ["planet.gas.gas_constant_j_kg_k=191.02"]),
    ("seasonal_column", "greatest", "one harmonic turned", [
        "planet.climate.surface_pressure.season=[0.069, 0.060, 0.045, -0.050]"
    ]),
    ("symmetric_top", "rate in space", "Iyy + 10 g m2", [
        "vehicle.mass.entry_inertia_kg_m2=[1150, 900.01, 900]"
    ]),
    ("terminal_velocity", "speed", "canopy + 0.2 kg", [
        "vehicle.parts.parachute_pack.mass_kg=38.2", "vehicle.mass.entry_kg=1100.2"
    ]),
    ("tumbling", "energy", "a trace of damping", [
        "atmosphere.model=exponential",
        "atmosphere.exponential={density_kg_m3: 1e-7, scale_height_m: 1e15, temperature_k: 214}",
        "vehicle.aero.model=constant",
        "vehicle.aero.constant={roll_damping: -1, pitch_damping: -1, yaw_damping: -1, drag_coefficient: 0, "
        "reference_area_m2: 9, span_m: 3, chord_m: 3}",
        "wind.model=constant",
        "wind.constant.east_m_s=100",
    ]),
    ("us76_table", "temperature", "the Mars table", ["atmosphere.model=table"]),
]  # fmt: skip

multiply, to_frame = quaternion.multiply, quaternion.to_frame
geodetic, attitude, great_circle = frames.geodetic, frames.attitude_from_wind_angles, frames.great_circle


def geocentric(radius, flattening, r):
    _, _, sin_lon, cos_lon, altitude = geodetic(radius, flattening, r)
    length = hypot(*r)
    return r[2] / length, hypot(r[0], r[1]) / length, sin_lon, cos_lon, altitude


def from_east(*points):
    arc, azimuth = great_circle(*points)
    return arc, 0.5 * pi - azimuth


def sideslip_turned(v, up, bank, alpha, beta):
    return attitude(v, up, bank, alpha, -beta)


def banked_in_air(v, v_air, up, bank, alpha):
    return attitude(v_air, up, bank, alpha, 0.0)


def sign_turned(p, q):
    """The product with i j = -k."""
    *first, last = multiply(p, q)
    return *first, last - 2.0 * p[1] * q[2]


def rate_in_inertial(q, w):
    return tuple(0.5 * c for c in multiply((0.0, *w), q))


#: Case, the one result that must fail, and a kernel with what stands in for it.
KERNELS = [
    ("rotations", "product", quaternion, "multiply", sign_turned),
    ("frames", "latitude, longitude", frames, "geodetic", geocentric),
]
KERNELS_LONG = [
    ("rotations", "to inertial", quaternion, "from_frame", lambda q, v: to_frame(q, v)),
    ("rotations", "rate", quaternion, "rate", rate_in_inertial),
    ("frames", "attitude from wind angles", frames, "attitude_from_wind_angles", sideslip_turned),
    ("frames", "great-circle azimuth", frames, "great_circle", from_east),
    ("frames", "bank in a wind", frames, "attitude_in_wind", banked_in_air),
]


def some(planted, *marks):
    return [
        pytest.param(*one, id=f"{one[0]}-{one[2] if len(one) == 4 else one[1]}", marks=marks)
        for one in planted
    ]


def failing(outcome):
    return [result.quantity for result in outcome.results if not result.passed]


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=[pytest.mark.exact_start] if one in EXACT else []) for one in CASES]
)
def test_passes(name):
    outcome = CASES[name]()
    assert outcome.passed, failing(outcome)


@pytest.mark.parametrize(
    ("name", "quantity", "what", "overrides"), [*some(PLANTED), *some(PLANTED_LONG, pytest.mark.long)]
)
def test_planted_error_is_caught(name, quantity, what, overrides):
    caught = failing(CASES[name](overrides))
    assert any(quantity in one for one in caught), caught


@pytest.mark.parametrize(
    ("name", "quantity", "module", "kernel", "wrong"),
    [*some(KERNELS), *some(KERNELS_LONG, pytest.mark.long)],
)
def test_planted_kernel_is_caught(monkeypatch, name, quantity, module, kernel, wrong):
    monkeypatch.setattr(module, kernel, wrong)
    assert failing(CASES[name]()) == [quantity]


def test_an_error_of_second_order_is_caught(monkeypatch):
    """1e-6 h^2 relative, in the end state: a changed weight of the Runge-Kutta formula leaves an error of at
    most third order, and would recompile the simulator.
    """
    state = free_motion.end_state
    monkeypatch.setattr(free_motion, "end_state", lambda h, bench: state(h, bench) * (1.0 + 1e-6 * h**2))
    assert not CASES["rk4_order"]().passed


def test_every_case_has_a_planted_error():
    assert {one[0] for one in (*PLANTED, *KERNELS)} | {"rk4_order"} == set(CASES)
