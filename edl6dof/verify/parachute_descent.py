"""Check cases of vehicle and canopy: the parachute fills, and the descent under it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from edl6dof.config.base import stated
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.vehicle.plant import CANOPY_POSITION, CANOPY_VELOCITY
from edl6dof.verify import case
from edl6dof.verify.case import Bench, fit, given, largest, scenes, state_of, to_the_end, vectors

_GRAVITY = 3.72
_CENTRE = -1.0
_SCENE = (
    *(*case.BARE, *case.FLAT, *case.UNIFORM, *case.ONE_BODY, *case.ENDLESS),
    *given("vehicle.mass", entry_kg=1100, entry_centre_m=[_CENTRE, 0, 0]),
    *given("vehicle.parts.parachute_pack", mass_kg=38, centre_m=[-1, 0, 0], inertia_kg_m2=[0, 0, 0]),
    *given("vehicle.parachutes.main", confluence_m=[-3.9, 0, 0], trim_angle_deg=0, pack_drag_area_m2=0),
    *given("initial", latitude_deg=0, longitude_deg=0, altitude_m=20000),
)
#: Tilt (rad) at which a swing begins.
_SWING = 2e-3


class _Planar:
    """Two bodies on an elastic riser in a vertical plane, in uniform gravity and density.

    The model shares nothing with the simulator but the parameters.  State: x (east), z (down), tilt, their
    rates; x, z and rates of the canopy.
    """

    def __init__(self, scenario: Scenario) -> None:
        vehicle, chute = scenario.vehicle, scenario.vehicle.main_parachute
        self.bluff, self.chute = vehicle.aero.backshell, chute
        self.rho = stated(scenario.atmosphere.exponential).density_kg_m3
        self.packed = next(part.mass_kg for part in vehicle.parts if part.name == chute.pack)
        self.mass = vehicle.mass.entry_kg - self.packed
        self.inertia = stated(vehicle.mass.entry_inertia_kg_m2)[1]
        sphere = 4.0 / 3.0 * np.pi * (0.35 * chute.diameter_m) ** 3
        self.canopy_mass = self.packed + chute.apparent_mass_factor * self.rho * sphere
        self.attachment = chute.confluence_m[0] - _CENTRE
        self.pressure_point = self.bluff.centre_of_pressure_x_m - _CENTRE
        self.drag_area = np.pi / 4.0 * chute.diameter_m**2 * chute.drag_coefficient * chute.drag_factor
        self.normal_area = np.pi / 4.0 * chute.diameter_m**2 * chute.normal_slope

    def terminal_speed(self) -> float:
        """Speed at which drag carries the weight of both."""
        area = self.drag_area + self.bluff.reference_area_m2 * self.bluff.drag_coefficient
        return float(np.sqrt(2.0 * (self.mass + self.packed) * _GRAVITY / (self.rho * area)))

    def rates(self, s: np.ndarray) -> np.ndarray:
        """Time derivative of the state."""
        tilt, v, turn, v_c = s[2], s[3:5], s[5], s[8:10]
        nose, belly = np.array([np.sin(tilt), np.cos(tilt)]), np.array([-np.cos(tilt), np.sin(tilt)])
        forward, down = v @ nose, v @ belly
        half = 0.5 * self.rho * np.linalg.norm(v) * self.bluff.reference_area_m2
        along, across = -half * self.bluff.drag_coefficient * forward, -half * self.bluff.normal_slope * down
        damping = 0.5 * half * self.bluff.pitch_damping * self.bluff.reference_length_m**2
        moment = damping * turn - self.pressure_point * across
        line = s[6:8] - s[0:2] - self.attachment * nose
        length = np.linalg.norm(line)
        line = line / length
        stretching = (v_c - v + self.attachment * turn * belly) @ line
        damper = 2.0 * self.chute.damping_ratio * np.sqrt(self.chute.stiffness_n_m * self.packed)
        tension = self.chute.stiffness_n_m * (length - self.chute.line_length_m) + damper * stretching
        moment -= self.attachment * tension * (line @ belly)
        weight = np.array([0.0, _GRAVITY])
        pull = (along * nose + across * belly + tension * line) / self.mass + weight
        speed_c = np.linalg.norm(v_c)
        axial = (v_c @ line) * line
        drag = -0.5 * self.rho * speed_c * (self.drag_area * axial + self.normal_area * (v_c - axial))
        pull_c = (drag - tension * line + self.packed * weight) / self.canopy_mass
        return np.concatenate([v, [turn], pull, [moment / self.inertia], v_c, pull_c])

    def equilibrium(self) -> np.ndarray:
        """Steady descent with the vehicle straight below the canopy."""

        def state(speed: float, apart: float) -> np.ndarray:
            return np.array([0, 0, 0, 0, speed, 0, 0, -apart, 0, speed], dtype=float)

        start = (self.terminal_speed(), self.chute.line_length_m - self.attachment + 0.1)
        speed, apart = fsolve(lambda x: self.rates(state(*x))[[4, 9]], start, xtol=1e-13)
        return state(speed, apart)

    def modes(self) -> tuple[np.ndarray, np.ndarray]:
        """Eigenvalues of motion off the vertical, ascending, and their modes (columns, unit tilt)."""
        rest = self.equilibrium()
        step = 1e-5 * np.eye(10)
        matrix = np.stack([(self.rates(rest + h) - self.rates(rest - h)) / 2e-5 for h in step], axis=1)
        values, shapes = np.linalg.eig(matrix)
        keep = [i for i in range(10) if values[i].imag > 1e-3 and abs(shapes[2, i]) > 1e-6]
        keep.sort(key=lambda i: values[i].imag)
        return values[keep], shapes[:, keep] / shapes[2, keep]


def _descend(
    bench: Bench, state: np.ndarray, seconds: float, extra: Sequence[str] = (), line_stretch: float = -1e3
) -> tuple[np.ndarray, np.ndarray, Flight]:
    """Fly from a planar state with further overrides, ``extra``, and line stretch at a time (s); returns time
    (s), tilt (rad) and the flight.
    """
    _, loaded = bench.scenes([*_SCENE, *extra, f"simulation.time_limit_s={seconds}"])

    def place(plant: np.void, fsw: np.void) -> None:
        east, down = np.array([0.0, 1.0, 0.0]), np.array([-1.0, 0.0, 0.0])
        x, z, tilt = state[:3]
        nose, belly = np.sin(tilt) * east + np.cos(tilt) * down, np.sin(tilt) * down - np.cos(tilt) * east
        axes = np.stack([nose, np.cross(belly, nose), belly], axis=1)
        y, origin = plant["y"], plant["y"][0:3].copy()
        y[0:3] = origin + x * east + z * down
        y[3:6] = state[3] * east + state[4] * down
        y[6:10] = Rotation.from_matrix(axes).as_quat(scalar_first=True)
        y[10:13] = (0.0, state[5], 0.0)
        y[CANOPY_POSITION : CANOPY_POSITION + 3] = origin + state[6] * east + state[7] * down
        y[CANOPY_VELOCITY : CANOPY_VELOCITY + 3] = state[8] * east + state[9] * down
        plant["attached"][:] = 0
        plant["attached"][1] = 1  # the backshell
        plant["canopy"], plant["line_stretch_time"] = 2, line_stretch

    flight = to_the_end(loaded, state_of(loaded, place))
    nose = Rotation.from_quat(vectors(flight, "q_I2B", "", "wxyz"), scalar_first=True).apply([1.0, 0.0, 0.0])
    return flight.telemetry["t_s"], np.arctan2(nose[:, 1], -nose[:, 0]), flight


def pendulum(bench: Bench) -> None:
    """Verifies: the swing of vehicle and canopy about each other (pendulum) and of the vehicle about its
    bridle (wrist mode).

    gravity uniform | atmosphere uniform | winds none | vehicle Tianwen-1 without heat shield under the open
    canopy | source: eigenvalues of an independent planar two-body model in plain numpy | tolerance 1e-4 of
    the eigenvalue, period and damping together: swings of 2 mrad are linear to 1e-5 and gravity varies by
    1e-5 on the way; the differences are good to 1e-8.

    Start each mode alone and measure its frequency and damping.
    """
    model = _Planar(scenes(_SCENE)[0])
    values, shapes = model.modes()
    rest = model.equilibrium()
    verifies, why = "vehicle, riser and canopy", "swings of 2 mrad are linear to 1e-5"
    compare = partial(bench.compare, verifies=verifies, source="eigenvalues of a planar model", why=why)
    for name, index in (("pendulum", 0), ("wrist", -1)):
        value = complex(values[index])
        seconds = round(3.0 * 2.0 * np.pi / value.imag)
        t, tilt, _ = _descend(bench, rest + _SWING * shapes[:, index].real, seconds)
        found, _ = fit(t, tilt, value)
        quantity = f"{name} mode (period {2.0 * np.pi / value.imag:.2f} s)"
        compare(quantity, abs(found - value) / abs(value), 1e-4)
    expected = _SWING * np.real(np.exp(value * t))
    bench.plot("Wrist mode under the parachute", "time (s)", "tilt (rad)", t, tilt, expected)


def terminal_velocity(bench: Bench) -> None:
    """Verifies: steady descent under the open canopy.

    gravity uniform | atmosphere uniform | winds none | vehicle Tianwen-1 without heat shield under the open
    canopy | source: weight of both bodies equals drag of both, V = sqrt(2 m g / rho (sum of CD A)) |
    tolerance 2e-5: gravity changes by 2e-5 over the 8 km of the descent, and a start 20 % too fast has died
    out to 1e-7 after 120 s.

    Start 20 % too fast and compare the speed after two minutes.
    """
    model = _Planar(scenes(_SCENE)[0])
    start = model.equilibrium()
    start[[4, 9]] *= 1.2
    t, _, flight = _descend(bench, start, 120.0)
    speed, expected = flight.telemetry["truth.speed_m_s"], model.terminal_speed()
    about = ("drag of vehicle and canopy", "weight = drag", "gravity varies by 2e-5 on the way")
    bench.compare("speed after 120 s", abs(float(speed[-1]) / expected - 1.0), 2e-5, "-", *about)
    bench.plot("Terminal velocity", "time (s)", "speed (m/s)", t, speed, np.full_like(t, expected))


#: A vehicle that the canopy cannot slow down, on lines that hardly stretch.  The planet is small, so that
#: positions resolve 1e-10 m, 5 mN of the riser.
_INFINITE_MASS = (
    *(*case.WEIGHTLESS, "planet.equatorial_radius_m=1e6", "vehicle.mass.entry_kg=1e9"),
    *given("vehicle.parachutes.main", stiffness_n_m=4e7, damping_ratio=1, apparent_mass_factor=0),
    "vehicle.parachutes.main.disk_gap_band.dynamic_load_factor=1",
    "simulation.canopy_step_s=0.0005",
)


def inflation(bench: Bench) -> None:
    """Verifies: load of a canopy that fills behind a vehicle of infinite mass.

    gravity none | atmosphere uniform | winds none | vehicle of 1e9 kg on a riser of 40 MN/m | source: Cruz et
    al., AIAA 2013-1276: at constant dynamic pressure q the load is q CD S CX (t / tf)^n up to the filling
    time tf = D / 27.2 m/s, then, the overshoot gone, q CD S | tolerance 2e-4 of the load: the riser stretches
    with 2 mm/s of the 100 m/s (5e-5 of q), and the packed mass takes (m / k) n (n - 1) / tf^2 of the load
    (3e-5).

    Compare the tension of the riser at every time up to the filling time and after the overshoot.
    """
    model, speed = _Planar(scenes([*_SCENE, *_INFINITE_MASS])[0]), 100.0
    chute = model.chute
    start = np.array([0, 0, 0, 0, speed, 0, 0, -(chute.line_length_m - model.attachment), 0, speed])
    t, _, flight = _descend(bench, start, 1.2, _INFINITE_MASS, line_stretch=0.0)
    filled = chute.diameter_m / chute.disk_gap_band.inflation_speed_m_s
    growth = (t / filled) ** chute.disk_gap_band.inflation_exponent
    steady = 0.5 * model.rho * speed**2 * model.drag_area
    opening, late = t <= filled, t > filled + chute.disk_gap_band.overshoot_decay_s + 0.05
    expected = steady * np.where(opening, chute.disk_gap_band.opening_load_factor * growth, 1.0)
    tension = flight.telemetry["truth.riser_tension_n"]
    about = "canopy filling, opening load", "Cruz et al., infinite mass", "stretching riser, packed mass"
    for name, rows in (("load while it fills", opening), ("load of the open canopy", late)):
        bench.compare(name, largest((tension - expected)[rows]) / steady, 2e-4, "-", *about)
    curves = (one[opening | late] for one in (t, tension, expected))
    bench.plot("Opening load, infinite mass", "time (s)", "tension (N)", *curves)
