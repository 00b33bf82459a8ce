"""Yan, Sun & Guo 2016, section 3: finite-time against proportional-derivative drag tracking, both with the
disturbance observer.

The flight-path rate is disturbed by 0.01 sin(t) rad/s.  The paper says that the initial state deviates but
not by how much, and prints neither gains nor exponent; here both laws have the same gains, and fly from all
eight corners of a box of initial deviations.  Which law
is better depends on the gains: the comparison is repeated with others.  Errors are those against the
undisturbed nominal flight at equal time, as in the paper's figures.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pyarrow as pa

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.variants import scenario_of
from edl6dof.campaign.executor import fly_cases
from edl6dof.fsw.mission.roles import LIFT
from edl6dof.report.figure import Figure, Panel
from edl6dof.scenario.schema import load_scenario
from edl6dof.sim.flight import Flight, fly
from edl6dof.studies import plots
from edl6dof.studies.cases import values
from edl6dof.studies.study import Finding, Progress, Report, Study

SCENARIO = "yan2016"
LAWS = {"ftc_dob": "FTC+DOB", "pd_dob": "PD+DOB"}
AMPLITUDE, FREQUENCY = 0.01, 1.0
#: k_1 = k_P (1/s2) and k_2 = k_D (1/s): those of the comparison, and others that show how much it rests on
#: them.
GAINS = ((0.25, 0.8), (0.1, 0.6), (0.5, 1.2), (1.0, 2.0))
#: Deviations of the initial state: path, nominal, half width of the box.
DEVIATIONS = (
    ("initial.altitude_m", 60e3, 500.0),
    ("initial.speed_m_s", 5700.0, 25.0),
    ("initial.flight_path_angle_deg", -14.0, 0.1),
)
#: Seconds after which the observer has settled.
SETTLED_S = 1.0


def run(runs: int, progress: Progress) -> Report:
    """Fly the nominal, both laws from every corner, and one corner in full for the figures; ``runs`` is
    fixed.
    """
    loaded = load_scenario(SCENARIO)
    nominal = fly(loaded)
    corners = [_truth(signs) for signs in product((1.0, -1.0), repeat=3)]
    cases = [_case(number, *choice) for number, choice in enumerate(product(GAINS, LAWS, corners))]
    table = fly_cases(
        loaded,
        cases,
        collect=lambda flight: _figures(flight, nominal),
        progress=lambda done, row: progress(done, len(cases)),
    )
    shown = {
        law: fly(scenario_of(load_scenario(SCENARIO), _case(0, GAINS[0], law, corners[0]))) for law in LAWS
    }
    findings = (*_estimate(table), *_compared(table))
    remarks = (
        (
            "Gains are not printed: both laws have k_1 = k_P = 0.25 1/s2 and k_2 = k_D = 0.8 1/s (others "
            "as noted), the observer 60 1/s."
        ),
        (
            "Errors are means over eight corners of +-500 m, +-25 m/s, +-0.1 deg at entry, against the "
            "nominal at equal time."
        ),
    )
    return Report(
        findings,
        (*_tracking_drawings(nominal, shown), *_observer_drawings(shown["ftc_dob"])),
        table,
        len(table),
        remarks,
    )


def _truth(signs: tuple[float, ...]) -> dict[str, float]:
    deviations = {
        path: nominal + sign * width for (path, nominal, width), sign in zip(DEVIATIONS, signs, strict=True)
    }
    return {**deviations, "point_mass.disturbance.amplitude_rad_s": AMPLITUDE}


def _case(number: int, gains: tuple[float, float], law: str, truth: dict[str, float]) -> Case:
    entry = "flight_software.guidance.entry"
    belief = {
        f"{entry}.law": law,
        f"{entry}.{law}.error_gain": gains[0],
        f"{entry}.{law}.rate_gain": gains[1],
    }
    return Case(
        number, truth=truth, belief=belief, label={"law": law, "error_gain": gains[0], "rate_gain": gains[1]}
    )


def _figures(flight: Flight, nominal: Flight) -> dict[str, float]:
    """How far one flight is from the nominal, and how good its disturbance estimate is."""
    rows = flight.telemetry
    shared = min(len(rows["t_s"]), len(nominal.telemetry["t_s"]))
    altitude = (rows["truth.altitude_m"][:shared] - nominal.telemetry["truth.altitude_m"][:shared]) / 1e3
    downrange = (_downrange(flight)[:shared] - _downrange(nominal)[:shared]) / 1e3
    t, estimate = _observed(flight)
    off = np.abs(estimate - AMPLITUDE * np.sin(FREQUENCY * t)) / AMPLITUDE
    return {
        "rms_altitude_error_km": _rms(altitude),
        "rms_range_error_km": _rms(downrange),
        "final_altitude_error_km": abs(
            flight.metrics["parachute_altitude_m"] - nominal.metrics["parachute_altitude_m"]
        )
        / 1e3,
        "final_range_error_km": abs(float(_downrange(flight)[-1] - _downrange(nominal)[-1])) / 1e3,
        "estimate_error_pct": 100.0 * float(np.max(off[t > SETTLED_S])),
    }


def _downrange(flight: Flight) -> np.ndarray:
    """Range flown along the equator, m on the reference sphere."""
    return np.radians(flight.telemetry["truth.longitude_deg"]) * flight.scenario.planet.equatorial_radius_m


def _observed(flight: Flight) -> tuple[np.ndarray, np.ndarray]:
    """Times and estimated disturbance (rad/s) while the law flies."""
    rows = flight.telemetry
    guided = flight.during(LIFT)
    return rows["t_s"][guided], np.radians(rows["guide.path_disturbance_deg_s"][guided])


def _estimate(table: pa.Table) -> tuple[Finding, ...]:
    worst = float(np.max(values(table, "estimate_error_pct")))
    return (
        Finding(
            "disturbance estimate, largest error",
            "%",
            worst,
            4.0,
            "<=",
            f"of the amplitude, after {SETTLED_S:g} s",
        ),
    )


def _compared(table: pa.Table) -> tuple[Finding, ...]:
    findings = []
    for name, label in (
        ("rms_altitude_error_km", "RMS altitude error"),
        ("rms_range_error_km", "RMS range error"),
        ("final_altitude_error_km", "final altitude error"),
        ("final_range_error_km", "final range error"),
    ):
        errors = {law: _mean(table, name, law, GAINS[0]) for law in LAWS}
        findings += [Finding(f"{label}, {title}", "km", errors[law]) for law, title in LAWS.items()]
        findings.append(
            Finding(
                f"{label}, FTC over PD",
                "",
                errors["ftc_dob"] / errors["pd_dob"],
                1.0,
                "<=",
                "published: FTC is better",
            )
        )
    for gains in GAINS[1:]:
        for name, label in (("rms_altitude_error_km", "altitude"), ("rms_range_error_km", "range")):
            ratio = _mean(table, name, "ftc_dob", gains) / _mean(table, name, "pd_dob", gains)
            findings.append(
                Finding(
                    f"RMS {label} error, FTC over PD", "", ratio, note=f"gains {gains[0]:g}, {gains[1]:g}"
                )
            )
    return tuple(findings)


def _mean(table: pa.Table, name: str, law: str, gains: tuple[float, float]) -> float:
    """Mean of a column over the corners flown by one law with one pair of gains."""
    chosen = np.array([row == law for row in table["law"].to_pylist()]) & (
        values(table, "error_gain") == gains[0]
    )
    return float(np.mean(values(table, name)[chosen]))


def _tracking_drawings(nominal: Flight, shown: dict[str, Flight]) -> tuple[Figure, ...]:
    def column(name: str, per: float = 1.0) -> dict[str, np.ndarray]:
        return {law: flight.telemetry[name] / per for law, flight in (*shown.items(), ("nominal", nominal))}

    times = column("t_s")
    drag = column("nav.drag_m_s2")
    rate = {law: np.gradient(drag[law], times[law]) for law in drag}
    ranges = {law: _downrange(flight) / 1e3 for law, flight in (*shown.items(), ("nominal", nominal))}
    compared = (
        ("fig2_speed", "speed (m/s)", column("truth.speed_m_s")),
        ("fig3_longitude", "longitude (deg)", column("truth.longitude_deg")),
        ("fig4_drag", "drag (m/s2)", drag),
        ("fig5_drag_rate", "drag rate (m/s3)", rate),
        ("fig6_altitude", "altitude above the ellipsoid (km)", column("truth.altitude_m", 1e3)),
        ("fig7_range", "range (km)", ranges),
    )
    return tuple(
        plots.figure(name, tuple(_beside(label, times, curves, law) for law in ("pd_dob", "ftc_dob")))
        for name, label, curves in compared
    )


def _beside(label: str, times: dict[str, np.ndarray], curves: dict[str, np.ndarray], law: str) -> Panel:
    pair = (
        plots.curve(times[law], curves[law], "flown"),
        plots.reference(times["nominal"], curves["nominal"], "nominal"),
    )
    return plots.panel(LAWS[law], "time (s)", label, pair)


def _observer_drawings(flight: Flight) -> tuple[Figure, ...]:
    t, estimate = _observed(flight)
    true = AMPLITUDE * np.sin(FREQUENCY * t)
    both = plots.curve(t, estimate, "estimate"), plots.reference(t, true, "true")
    return (
        plots.figure(
            "fig8_disturbance",
            (plots.panel("Disturbance of the flight-path rate", "time (s)", "d (rad/s)", both),),
        ),
        plots.figure(
            "fig9_estimate_error",
            (
                plots.panel(
                    "Error of the estimate",
                    "time (s)",
                    "d - estimate (rad/s)",
                    (plots.curve(t, true - estimate),),
                ),
            ),
        ),
    )


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(errors**2)))


STUDY = Study(
    SCENARIO,
    "Finite-time drag tracking against a sinusoidal disturbance",
    "Yan, Sun & Guo 2016",
    run,
    runs=64,
    quick_runs=64,
)
