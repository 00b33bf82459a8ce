"""Lu & Bayard: drag-velocity tracking under adaptive H-infinity control; the claims of section 3 put to
numbers.

The paper prints no vehicle, no entry and no run.  Vehicle and entry are those of Wu, Cui & Cui 2013, an
MSL-class point mass, with estimates for what it stands.  First the theorem in its own setting: constant
theta, unlimited control.  Then the law in flight, where bank angle, sampling and a changing path limit it;
there everything that the undisturbed error dynamics leave out counts as disturbance.
"""

from __future__ import annotations

from collections.abc import Callable
from math import asin, cos, log, sin

import numpy as np
import pyarrow as pa
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.linalg import solve_continuous_are

from edl6dof.fsw.guidance.entry.laws.adaptive_hinf import MEMORY, begin
from edl6dof.fsw.guidance.entry.laws.hinf import feedback, riccati
from edl6dof.fsw.guidance.entry.prediction.drag_dynamics import drag_dynamics
from edl6dof.fsw.guidance.entry.profiles.drag_velocity import path_sine, profile_drag, profile_range
from edl6dof.fsw.guidance.entry.profiles.entry_corridor import corridor
from edl6dof.fsw.mission.roles import LIFT
from edl6dof.report.figure import Figure, Panel
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import load_scenario
from edl6dof.sim.flight import Flight, fly
from edl6dof.studies import plots
from edl6dof.studies.drag_model import Design, Response, respond
from edl6dof.studies.study import Finding, Progress, Report, Study

ENTRY = "flight_software.guidance.entry"
#: The scenario of the vehicle, and what is changed in it; limits of the vehicle are estimates.
SCENARIO = "wu2013"
SETTINGS = (
    f"{ENTRY}.law=adaptive_hinf",
    f"{ENTRY}.adaptive_hinf={{start_drag_m_s2: 7.0, disturbance_gain: 40.0, "
    "control_weight: 625.0, adaptation_energy: 20.0}",
    f"{ENTRY}.limits={{heat_rate_w_cm2: 100.0, nose_radius_m: 1.1, "
    "load_g0: 15.0, dynamic_pressure_pa: 18000.0}",
    f"{ENTRY}.tracking.update=false",
)
#: True theta of the design model, inside the law's set, and the drag error (m/s2) at its start.
THETA = np.array([1e-3, -5e-5, 0.06, 0.03, 0.05])
START_ERROR = 2.0
DURATION_S = 110.0
#: True values of the flights: as planned, and off by what the flight computer is not told.
FLIGHTS = {
    "as planned": {},
    "lift 10 % low": {"vehicle.aero.lift_drag.lift_to_drag": 0.216},
    "density 10 % high": {"atmosphere.density_factor": 1.1},
    "path disturbed": {
        "point_mass.disturbance.amplitude_rad_s": 0.0005,
        "point_mass.disturbance.frequency_rad_s": 0.3,
    },
}
#: Times (s) after the start and before the end of what counts as tracking in flight.
SETTLED_S, END_S = 30.0, 2.0


def pulse(t: float) -> float:
    """Energy-bounded disturbance, m/s4: near the resonance of the drag loop, dying out."""
    return 0.05 * sin(0.11 * t) * np.exp(-t / 30.0)


def gust(t: float) -> float:
    """Energy-bounded disturbance, m/s4: one half wave."""
    return 0.08 * sin(np.pi * (t - 30.0) / 10.0) if 30.0 < t < 40.0 else 0.0


def run(runs: int, progress: Progress) -> Report:
    """Integrate the design model with three disturbances, and fly the law."""
    loaded = load_scenario(SCENARIO, SETTINGS)
    onboard = build_onboard(loaded.scenario)
    design = _design(onboard)
    responses = {
        "w = 0": _respond(design, onboard, lambda t: 0.0),
        "w dying out": _respond(design, onboard, pulse),
    }
    responses["w one gust"] = _respond(design, onboard, gust)
    fixed = _respond(design, onboard, lambda t: 0.0, adaptive=False)
    histories = {}
    for number, (name, truth) in enumerate(FLIGHTS.items()):
        progress(number, len(FLIGHTS))
        changes = "{" + ", ".join(f"{path}: {value}" for path, value in truth.items()) + "}"
        histories[name] = _history(fly(load_scenario(SCENARIO, [*SETTINGS, f"truth={changes}"])), design)
    progress(len(FLIGHTS), len(FLIGHTS))
    rows = [
        *(_response_row(name, r, design) for name, r in responses.items()),
        *(_flight_row(n, h, design) for n, h in histories.items()),
    ]
    findings = (
        *_riccati_findings(design),
        *_theorem(rows, fixed),
        *_flights(rows),
        *_range(onboard, loaded.scenario.planet.equatorial_radius_m),
    )
    remarks = (
        (
            "Design model: drag, drag rate and speed under eq. 15 with constant theta; the estimate starts "
            "in the middle of its set."
        ),
        (
            "The bound is lambda^2 int w^2 + epsilon + z(0)'P z(0), computed here.  In flight w = e'' - F "
            "(e, e') from 30 s on, the limits of"
        ),
        (
            "the bank angle included: at the joints the three segments ask for a change of path that no "
            "bank angle of this vehicle gives."
        ),
    )
    return Report(
        findings,
        _drawings(onboard, responses, fixed, histories),
        pa.Table.from_pylist(rows),
        len(rows),
        remarks,
    )


def _design(onboard: np.ndarray) -> Design:
    """Settings of the law as it flies."""
    law, planet = onboard[0]["guidance"]["entry"]["adaptive_hinf"], onboard[0]["planet"]
    memory = np.zeros(1, MEMORY)[0]
    begin(law, memory)
    radius = float(planet["equatorial_radius"])
    return Design(
        float(law["disturbance_gain"]),
        float(law["control_weight"]),
        float(law["adaptation_energy"]),
        memory["low"].copy(),
        memory["high"].copy(),
        float(planet["mu"]) / radius**2,
        radius,
        _scale_height(onboard),
    )


def _scale_height(onboard: np.ndarray) -> float:
    air = onboard[0]["atmosphere"]
    return float(-air["spacing"] / (air["ln_density"][1] - air["ln_density"][0]))


def _respond(
    design: Design, onboard: np.ndarray, disturbance: Callable[[float], float], *, adaptive: bool = True
) -> Response:
    """Response of the design model along the profile in time, from a wrong drag and a wrong theta."""
    profile = onboard[0]["plan"]["adaptive_hinf"]

    def rates(t: float, v: np.ndarray) -> np.ndarray:
        drag, slope, _ = profile_drag(profile, v[0])
        return np.array(
            [-drag - design.gravity * path_sine(v[0], drag, slope, design.gravity, design.scale_height)]
        )

    t = np.arange(0.0, DURATION_S + 1.0, 0.5)
    speed = solve_ivp(rates, (0.0, t[-1]), [profile["start"]], t_eval=t, rtol=1e-9).y[0]
    along = CubicSpline(t, [profile_drag(profile, v)[0] for v in speed])
    parts = (along, along.derivative(), along.derivative(2))

    def reference(now: float) -> tuple[float, float, float]:
        return float(parts[0](now)), float(parts[1](now)), float(parts[2](now))

    start = (START_ERROR, 0.0, float(profile["start"]))
    return respond(design, reference, THETA, disturbance, start, DURATION_S, adaptive=adaptive)


def _history(flight: Flight, design: Design) -> dict[str, np.ndarray]:
    """Drag, reference, error and effective disturbance d = e'' - F (e, e') of one flight, at the rate of
    guidance.
    """
    rates = flight.scenario.flight_software.rates
    law = flight.scenario.flight_software.guidance.entry.adaptive_hinf
    rows = {name: column[:: rates.entry_guidance_every] for name, column in flight.telemetry.items()}
    tracked = flight.during(LIFT)[:: rates.entry_guidance_every] & (
        rows["nav.drag_m_s2"] >= law.start_drag_m_s2
    )
    rows = {name: column[tracked] for name, column in rows.items()}
    t, error = rows["t_s"], rows["nav.drag_m_s2"] - rows["guide.reference_drag_m_s2"]
    rate = np.gradient(error, t)
    f1, f2 = feedback(design.gain, design.weight)
    return {
        "t_s": t,
        "speed": rows["truth.speed_m_s"],
        "drag": rows["nav.drag_m_s2"],
        "error": error,
        "rate": rate,
        "disturbance": np.gradient(rate, t) - f1 * error - f2 * rate,
        "bank_deg": np.abs(rows["guide.bank_deg"]),
        "theta": np.array(flight.fsw["guidance"]["entry"]["law"]["adaptive_hinf"]["theta"][0]),
    }


def _margin(theta: np.ndarray, design: Design) -> float:
    """Least distance of an estimate from the outside of the set, as a share of its width; negative
    outside.
    """
    width = design.high - design.low
    return float(np.min(np.minimum(theta - design.low, design.high - theta) / width))


def _response_row(name: str, response: Response, design: Design) -> dict[str, float | str]:
    return {
        "case": f"design model, {name}",
        "final_error_m_s2": float(np.max(np.abs(response.error[response.t > DURATION_S - 5.0]))),
        "error_energy": response.error_energy,
        "bound": response.bound(design),
        "theta_margin": _margin(response.theta, design),
    }


def _flight_row(name: str, h: dict[str, np.ndarray], design: Design) -> dict[str, float | str]:
    part = (h["t_s"] > SETTLED_S) & (h["t_s"] < h["t_s"][-1] - END_S)
    t, error, rate, disturbance = (h[key][part] for key in ("t_s", "error", "rate", "disturbance"))
    p11, p12, p22 = riccati(design.gain, design.weight)
    stored = p11 * error[0] ** 2 + 2.0 * p12 * error[0] * rate[0] + p22 * rate[0] ** 2
    return {
        "case": f"flight, {name}",
        "final_error_m_s2": float(np.max(np.abs(error[t > t[-1] - 5.0]))),
        "error_energy": float(np.trapezoid(error**2, t)),
        "bound": float(design.gain**2 * np.trapezoid(disturbance**2, t) + stored),
        "theta_margin": _margin(h["theta"], design),
    }


def _riccati_findings(design: Design) -> tuple[Finding, ...]:
    p11, p12, p22 = riccati(design.gain, design.weight)
    a, b, c = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
    oracle = solve_continuous_are(a, np.hstack([b, b]), c.T @ c, np.diag([-(design.gain**2), design.weight]))
    off = np.max(np.abs(np.array([[p11, p12], [p12, p22]]) / oracle - 1.0))
    f = np.array([feedback(design.gain, design.weight)])
    frequencies = np.geomspace(1e-4, 10.0, 2000)
    peak = max(abs((c @ np.linalg.solve(1j * w * np.eye(2) - a - b @ f, b))[0, 0]) for w in frequencies)
    return (
        Finding("Riccati solution against scipy's", "", float(off), note="largest relative difference"),
        Finding("peak gain from disturbance to error over lambda", "", float(peak / design.gain), 1.0, "<="),
    )


def _theorem(rows: list[dict], fixed: Response) -> tuple[Finding, ...]:
    model = [row for row in rows if row["case"].startswith("design")]
    found = [
        Finding(
            "design model, w = 0: |e| at the end",
            "m/s2",
            model[0]["final_error_m_s2"],
            0.0,
            note=f"from {START_ERROR:g}; tends to 0",
        ),
        Finding(
            "the same without adaptation",
            "m/s2",
            float(np.max(np.abs(fixed.error[fixed.t > DURATION_S - 5.0]))),
            note="a wrong theta stays",
        ),
    ]
    for row in model:
        found.append(
            Finding(
                f"{row['case']}: error energy",
                "",
                row["error_energy"],
                row["bound"],
                "<=",
                "m2/s3; bound of the theorem",
            )
        )
    found.append(
        Finding(
            "theta: least margin in its set",
            "",
            min(row["theta_margin"] for row in model),
            0.0,
            ">=",
            "share of its width",
        )
    )
    return tuple(found)


def _flights(rows: list[dict]) -> tuple[Finding, ...]:
    flown = [row for row in rows if row["case"].startswith("flight")]
    found = [Finding(f"{row['case']}: |e| at the end", "m/s2", row["final_error_m_s2"]) for row in flown]
    for row in flown:
        found.append(
            Finding(
                f"{row['case']}: error energy",
                "",
                row["error_energy"],
                row["bound"],
                "<=",
                "m2/s3; bound of section 3.3",
            )
        )
    found.append(
        Finding(
            "flights: least margin of theta",
            "",
            min(row["theta_margin"] for row in flown),
            0.0,
            ">=",
            "at the end",
        )
    )
    return tuple(found)


def _range(onboard: np.ndarray, radius: float) -> tuple[Finding, ...]:
    """Predicted range along the profile beside that of an integrated flight that is held on it by whatever
    lift it takes.
    """
    record, profile = onboard[0], onboard[0]["plan"]["adaptive_hinf"]
    mu, scale_height = float(record["planet"]["mu"]), _scale_height(onboard)
    first, final = 0.9 * float(profile["start"]), float(profile["final"])

    def rates(t: float, s: np.ndarray) -> list[float]:
        h, v, gamma, _ = s
        r = radius + h
        g = mu / r**2
        drag = _drag_at(onboard, h, v)
        goal, slope, curvature = profile_drag(profile, v)
        rate, a, b = drag_dynamics(drag, v, gamma, r, g, drag, scale_height)
        speed_rate = -drag - g * sin(gamma)
        wanted = (
            curvature * speed_rate**2
            - slope * rate
            + 0.8 * (slope * speed_rate - rate)
            + 0.16 * (goal - drag)
        )
        lift = drag * (wanted - b) / a
        return [
            v * sin(gamma),
            speed_rate,
            lift / v + (v / r - g / v) * cos(gamma),
            v * cos(gamma) * radius / r,
        ]

    def slow(t: float, s: np.ndarray) -> float:
        return s[1] - final

    slow.terminal = True  # type: ignore[attr-defined]  # scipy's mark on an event that ends the integration
    goal, slope, _ = profile_drag(profile, first)
    height = scale_height * log(_drag_at(onboard, 0.0, first) / goal)
    gamma = asin(path_sine(first, goal, slope, mu / (radius + height) ** 2, scale_height))
    flown = solve_ivp(
        rates, (0.0, 900.0), [height, first, gamma, 0.0], events=slow, rtol=1e-8, atol=1e-6, max_step=0.5
    ).y[3, -1]
    predicted = float(profile_range(profile, first))
    return (
        Finding(
            "range predicted along the profile",
            "km",
            predicted / 1e3,
            note=f"from {first:.0f} to {final:.0f} m/s",
        ),
        Finding("range of an integrated flight held on it", "km", float(flown) / 1e3),
    )


def _drag_at(onboard: np.ndarray, altitude: float, speed: float) -> float:
    air, vehicle = onboard[0]["atmosphere"], onboard[0]["vehicle"]
    density = np.exp(
        np.interp(
            altitude, air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"])), air["ln_density"]
        )
    )
    return float(0.5 * density * speed**2 * vehicle["drag_area"] / vehicle["entry_mass"])


def _drawings(
    onboard: np.ndarray,
    responses: dict[str, Response],
    fixed: Response,
    histories: dict[str, dict[str, np.ndarray]],
) -> tuple[Figure, ...]:
    time, error = "time (s)", "D - D_r (m/s2)"
    names, still = ("C", "C'", "1 - (R/r) cos2", "1 - cos", "sin2"), responses["w = 0"]
    shares = (still.theta - still.theta.min(axis=0)) / np.maximum(np.ptp(still.theta, axis=0), 1e-12)
    estimates = tuple(plots.curve(still.t, share, name) for share, name in zip(shares.T, names, strict=True))
    errors = tuple(plots.curve(r.t, r.error, name) for name, r in responses.items())
    flown = tuple(plots.curve(h["t_s"], h["error"], name) for name, h in histories.items())
    banks = tuple(plots.curve(h["t_s"], h["bank_deg"], name) for name, h in histories.items())
    return (
        plots.figure("fig1_corridor_and_profile", (_corridor_panel(onboard, histories["as planned"]),)),
        plots.figure(
            "design_model",
            (
                plots.panel(
                    "Drag error",
                    time,
                    error,
                    (*errors, plots.reference(fixed.t, fixed.error, "w = 0, theta not adapted")),
                ),
                plots.panel("Estimate of theta, w = 0", time, "share of its travel", estimates),
            ),
        ),
        plots.figure(
            "flights",
            (
                plots.panel("Drag error", time, error, flown),
                plots.panel("Bank angle", time, "|bank| (deg)", banks),
            ),
        ),
    )


def _corridor_panel(onboard: np.ndarray, flown: dict[str, np.ndarray]) -> Panel:
    """The paper's Fig. 1, with the bounds and a flight."""
    profile = onboard[0]["plan"]["adaptive_hinf"]
    v = np.linspace(float(profile["final"]), float(profile["start"]), 400)
    bounds = np.array([corridor(onboard[0], x) for x in v]).T
    joints = np.array([float(profile["join"]), float(profile["level"])])
    names = ("heat rate", "load", "dynamic pressure", "equilibrium glide")
    curves = (
        *(plots.curve(v, bound, name) for bound, name in zip(bounds, names, strict=True)),
        plots.reference(v, np.array([profile_drag(profile, x)[0] for x in v]), "profile"),
        plots.dots(joints, np.array([profile_drag(profile, x)[0] for x in joints]), "its joints"),
        plots.curve(flown["speed"], flown["drag"], "flown, as planned"),
    )
    return plots.panel("Entry corridor", "speed (m/s)", "drag (m/s2)", curves, y_range=(0.0, 200.0))


STUDY = Study(
    "lu_bayard",
    "Adaptive H-infinity tracking of a drag-velocity profile",
    "Lu & Bayard",
    run,
    runs=len(FLIGHTS),
    quick_runs=len(FLIGHTS),
)
