"""Zheng & Cui 2015, section 5: 500 dispersed point-mass entries under the sliding-mode law with disturbance
observer, as printed, and in variants where the paper leaves something open or contradicts itself.

The bank profile of the reference trajectory is not printed (see scenarios/zheng2015.yaml), nor the datum of
its altitudes; the reference radius of the density, 3394.5 km, is the only radius printed apart from that of
the entry, and heights here are above it.  With the printed density 0.2 Earth g is met at 44.3 s in place of
42 s, whatever the bank profile, and no three-segment profile ends above 7.5 km.  Raised by 3 km, the density
meets 42 s, and a profile that ends range control at 136 s ends at 9.8 km.

Table 1 gives means and 3-sigma errors of the entry state.  Of the density the text has a "maximum dispersion
of 20 %", Gaussian: as printed that is one factor for each flight.  Section 3.2 and section 5 have a reference
drag that is planned once; the outer loop of section 2 has no method, and is flown apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

import edl6dof
from edl6dof import Case
from edl6dof.campaign.executor import Row
from edl6dof.interface.roles import LIFT
from edl6dof.sim.flight import Flight
from edl6dof.studies.frame import SQUARE, Curve, Finding, Grid, Line, Panel, Report, Session, Study
from edl6dof.studies.samples import Spread, column, drag_dynamics_of, draw, percentage, pick, rms

SCENARIO, SEED = "zheng2015", 2015
ENTRY = "flight_software.guidance.entry"
UPDATE, DENSITY = f"{ENTRY}.tracking.update", "atmosphere.density_factor"
SPREADS = (
    Spread("initial.longitude_deg", 0.0, 0.1),
    Spread("initial.latitude_deg", 0.0, 0.01),
    Spread("initial.speed_m_s", 6000.0, 5.0),
    Spread("initial.flight_path_angle_deg", -15.0, 0.01),
    Spread("initial.azimuth_deg", 90.0, 0.01),
    Spread(DENSITY, 1.0, 0.2),
)
#: The density of the print raised so that 0.2 Earth g is met at 42 s, as if 3 km of its scale height higher
#: (the bank angle until then is printed, so nothing else is free), and a three-segment bank profile that then
#: ends range control at 136 s, which ends at the printed height.
DENSER_AIR = {
    DENSITY: 1.378,
    f"{ENTRY}.reference_bank.points.0.bank_deg": 45.0,
    f"{ENTRY}.reference_bank.points.1.at": 3000.0,
    f"{ENTRY}.reference_bank.points.1.bank_deg": 65.0,
    "terrain.site_longitude_deg": 10.8196,
}
#: Half width (m) of the bank-reversal dead band at zero velocity, which is not printed: chosen for the RMS
#: miss.  The scenario has 400 m.
DEAD_BAND = {f"{ENTRY}.reversal.crossrange_corridor.c0_m": 3500.0}


class Experiment(NamedTuple):
    """Dispersed entries: changes of the scenario, whether a density ``factor`` is dispersed, and the height
    (m) over which the density error of one flight is correlated, if there is one.
    """

    name: str
    belief: Mapping[str, Any]
    factor: bool = False
    correlation_m: float | None = None

    def truth(self, drawn: Mapping[str, float]) -> dict[str, Any]:
        """True values of one flight from the drawn ones."""
        truth: dict[str, Any] = {path: x for path, x in drawn.items() if self.factor or path != DENSITY}
        if self.correlation_m is not None:
            wave = {"enabled": True, "sigma": 0.2 / 3.0, "correlation_length_m": self.correlation_m}
            truth |= {f"atmosphere.perturbation.{key}": value for key, value in wave.items()}
        return truth


FIXED = {UPDATE: False}
AS_PRINTED = Experiment("as printed", FIXED, factor=True)
UNDISPERSED = Experiment("no density error", FIXED)
THICK = Experiment("denser air too", {**FIXED, **DENSER_AIR})
INFERRED = Experiment("as inferred", {**THICK.belief, **DEAD_BAND})
PROFILES = tuple(
    Experiment(f"density profile {length / 1e3:g} km", FIXED, correlation_m=length)
    for length in (500.0, 5000.0, 50000.0)
)
FLOWN = Experiment("flown", {UPDATE: True}, factor=True)
EXPERIMENTS = (AS_PRINTED, UNDISPERSED, THICK, INFERRED, *PROFILES, FLOWN)

#: Printed, of 500 flights: shares (%) within 3 and 5 km, RMS miss (km), and the middle (km) of the band of
#: 0.1 km that has most of the terminal altitudes; and half of that band.
SHARE_3, SHARE_5, RMS, ALTITUDE, BAND_KM = 79.2, 98.2, 2.47, 9.75, 0.05
#: Differences at which a value is reproduced: of a statistic (rms with two sampling errors), of heights,
#: and of times; and the flights from which a statistic is compared.
STATISTIC, HEIGHT, TIME, ENOUGH = 0.1, 0.05, 0.02, 200
#: Virtual state (m/s3) below which saturation counts as over, and for how long (s) it must stay there.
CONVERGED, CALM_S = 0.01, 3.0

REMARKS = (
    "as printed: reference drag planned once, one density factor a flight, 3 sigma 20 %; figures 3 to 5 and "
    "'run shown' are its first run; 'settled' is after the saturation at the beginning.",
    "denser air too: no density error, density raised by 3 km of height so that 0.2 Earth g is met at 42 s, "
    "bank profile 65 to 45 deg so that range control ends at 136 s; the height follows.",
    "as inferred: and the dead band of the bank reversals, not printed, 3.5 km to either side at no speed in "
    "place of 0.4, chosen for the RMS miss, which 2.5 to 3.5 km move between 2.2 and 3.0 km; the shares "
    "follow.",
    "density profile: the 20 % as an error correlated over so many km of height: no reading of it leaves "
    "half of the terminal altitudes within 0.1 km.",
    "flown: as printed, with the outer loop of eq. 12, for which the paper has no method.",
    "A datum of altitudes 3.7 km below the printed radius would meet 9.75 km in the printed air, and leave "
    "42 s and 136 s unexplained.",
)


def run(session: Session) -> Report:
    """Fly the same dispersed entries in every experiment. Fly the first entry of the first experiment once
    more, to record its telemetry for the findings on tracking and for the figures.
    """
    cases = all_cases(session.flights)
    session.total = len(cases)
    rows = session.fly(edl6dof.load(SCENARIO), cases, figures)
    shown = edl6dof.fly(SCENARIO, {**cases[0].overrides, "truth": dict(cases[0].truth)})
    printed = pick(rows, experiment=AS_PRINTED.name)
    miss = _km(pick(rows, experiment=FLOWN.name), "miss")
    note = "outer loop of eq. 12, one density factor a flight"
    findings = [
        *_against_the_print(AS_PRINTED, rows, NO_SUCH_DENSITY, THIN_AIR),
        *_against_the_print(INFERRED, rows, "", ""),
        Finding("flown: RMS miss", "km", rms(miss), note=note),
        Finding("flown: largest miss", "km", float(miss.max()), note=note),
        *_tracking(shown, printed),
    ]
    return Report(findings, rows, len(rows), [_grid(rows)], REMARKS, _pictures(history(shown), rows))


def all_cases(runs: int) -> list[Case]:
    """The same draws flown in each experiment, one experiment after the other."""
    flights = list(enumerate(draw(SPREADS, runs, SEED)))
    found: list[Case] = []
    for one in EXPERIMENTS:
        for number, values in flights:
            truth, label = one.truth(values), {"experiment": one.name}
            found.append(Case(len(found), truth, one.belief, number, label))
    return found


# ---- one flight ----------------------------------------------------------------------------------------


def figures(flight: Flight) -> dict[str, float]:
    """Tracking quality of one flight."""
    rows, control = flight.telemetry, range_control(flight)
    t, error = rows["t_s"][control], (rows["nav.drag_m_s2"] - rows["guide.reference_drag_m_s2"])[control]
    surface = rows["guide.surface_m_s3"][control]
    settled = _first_calm(t, np.abs(rows["guide.virtual_m_s3"][control]))
    found = {"control_start_s": t[0], "control_end_s": t[-1], "saturation_end_s": t[settled]}
    for name, unit, values in (("error", "m_s2", error), ("surface", "m_s3", surface)):
        found[f"peak_{name}_{unit}"] = np.max(np.abs(values))
        found[f"peak_{name}_settled_{unit}"] = np.max(np.abs(values[settled:]))
    return {name: float(value) for name, value in found.items()}


def _first_calm(t: np.ndarray, virtual: np.ndarray) -> int:
    """Row from which the virtual state stays converged: the saturation at the beginning is over."""
    for start in np.flatnonzero(virtual < CONVERGED):
        if np.all(virtual[start : np.searchsorted(t, t[start] + CALM_S)] < CONVERGED):
            return int(start)
    return len(t) - 1


def range_control(flight: Flight) -> np.ndarray:
    """Rows in which the law controls range: its phase, above the speed of heading alignment."""
    rows, entry = flight.telemetry, flight.scenario.flight_software.guidance.entry
    return flight.during(LIFT) & (rows["truth.speed_m_s"] > entry.heading_below_m_s)


def history(flight: Flight) -> dict[str, np.ndarray]:
    """Curves of one flight in range control, the true lumped disturbance among them.

    It is D'' - b_n cos(bank) with D'' by finite differences of the flown drag and b_n as known on board.
    """
    rows, control = flight.telemetry, range_control(flight)
    drag, authority = rows["nav.drag_m_s2"], drag_dynamics_of(flight, rows)[:, 1]
    acceleration = np.gradient(np.gradient(drag, rows["t_s"]), rows["t_s"])
    columns = {
        "t_s": rows["t_s"],
        "drag": drag,
        "reference": rows["guide.reference_drag_m_s2"],
        "estimate": rows["guide.drag_disturbance_m_s4"],
        "disturbance": acceleration - authority * np.cos(np.radians(rows["truth.bank_deg"])),
    }
    return {name: values[control] for name, values in columns.items()}


# ---- dispersed entries beside the print ----------------------------------------------------------------

NO_SUCH_DENSITY = "heights as printed leave no room for a density error; see 'no density error'"
THIN_AIR = "printed air too thin for 42 s at any bank; see 'denser air too'"


def _km(rows: list[Row], name: str) -> np.ndarray:
    return column(rows, f"parachute_{name}_m") / 1e3


def _grid(rows: list[Row]) -> Grid:
    """A line for every experiment, the published figures in the last."""
    heads = ("experiment", "RMS miss km", "in 3 km %", "in 5 km %", "sigma downrange km",
             "sigma crossrange km", "altitude km", "of half in km")  # fmt: skip
    lines: list[Line] = []
    for experiment in EXPERIMENTS:
        own = pick(rows, experiment=experiment.name)
        miss, altitude = _km(own, "miss"), _km(own, "altitude")
        quarter, three = np.percentile(altitude, (25.0, 75.0))
        lines.append((
            experiment.name, rms(miss), percentage(miss <= 3.0), percentage(miss <= 5.0),
            float(np.std(_km(own, "downrange"))), float(np.std(_km(own, "crossrange"))),
            float(np.median(altitude)), float(three - quarter),
        ))  # fmt: skip
    published = ("published", RMS, SHARE_3, SHARE_5, np.nan, np.nan, ALTITUDE, 2.0 * BAND_KM)
    return Grid("Dispersed entries, height above 3394.5 km", heads, [*lines, published])


def _against_the_print(
    experiment: Experiment, rows: list[Row], dispersed: str, thin: str
) -> Iterator[Finding]:
    """Compare an experiment with the paper; ``dispersed``, ``thin``: why spreads and levels do not agree."""
    name, own = experiment.name, pick(rows, experiment=experiment.name)
    miss, altitude = _km(own, "miss"), _km(own, "altitude")
    middle, flights = float(np.median(altitude)), len(own)
    start, end = (float(np.mean(column(own, f"control_{moment}_s"))) for moment in ("start", "end"))
    near = percentage(np.abs(altitude - middle) <= BAND_KM)
    within = tolerance(flights, sqrt(0.5))
    yield Finding(f"{name}: RMS miss", "km", rms(miss), RMS, within=within, why=dispersed)
    for limit, share in ((3.0, SHARE_3), (5.0, SHARE_5)):
        within = tolerance(flights, sqrt(100.0 / share - 1.0))
        label, inside = f"{name}: within {limit:g} km of the target", percentage(miss <= limit)
        yield Finding(label, "%", inside, share, within=within, why=dispersed)
    yield Finding(f"{name}: altitudes in a band of 0.1 km", "%", near, 50.0, ">=", why=dispersed)
    yield Finding(f"{name}: median altitude", "km", middle, ALTITUDE, within=HEIGHT, why=thin)
    yield Finding(f"{name}: lowest altitude", "km", float(altitude.min()), 7.0, ">=", why=thin)
    yield Finding(f"{name}: range control begins", "s", start, 42.0, within=TIME, why=thin)
    yield Finding(f"{name}: range control ends", "s", end, 136.0, within=TIME, why=thin)


def tolerance(runs: int, sampling: float) -> float | None:
    """Relative difference within which a statistic counts as reproduced; its relative sampling error is
    ``sampling`` over the root of ``runs``; ``None`` for too few flights.
    """
    return float(np.hypot(STATISTIC, 2.0 * sampling / sqrt(runs))) if runs >= ENOUGH else None


# ---- tracking: figures 3 to 5 ------------------------------------------------------------------


def _tracking(shown: Flight, printed: list[Row]) -> Iterator[Finding]:
    """Tracking of one dispersed flight as printed, and of the worst flight."""
    one, curves = figures(shown), history(shown)
    calm = slice(int(np.searchsorted(curves["t_s"], one["saturation_end_s"])), -2)
    true, off = curves["disturbance"][calm], (curves["estimate"] - curves["disturbance"])[calm]
    worst = float(column(printed, "peak_error_settled_m_s2").max())
    start = "the reference is tabulated 22 m/s apart: 0.16 m/s2 off at the start, |s| 0.33 undispersed"
    estimate = "run shown: disturbance estimate, RMS error over RMS"
    peak, surface = one["peak_error_settled_m_s2"], one["peak_surface_settled_m_s3"]
    yield Finding("run shown: saturation over", "s", one["saturation_end_s"], 75.0, within=HEIGHT)
    yield Finding("run shown: peak drag error", "m/s2", peak, 0.2, "<=", "settled")
    yield Finding("worst run: peak drag error", "m/s2", worst, 0.2, "<=", "settled")
    yield Finding("run shown: peak |s|", "m/s3", surface, 0.1, "<=", "settled; c_s")
    whole = one["peak_surface_m_s3"]
    yield Finding("run shown: peak |s| from the start", "m/s3", whole, 0.05, within=STATISTIC, why=start)
    yield Finding(estimate, "%", 100.0 * rms(off) / rms(true), note="settled")


def _pictures(h: dict[str, np.ndarray], rows: list[Row]) -> dict[str, list[Panel]]:
    """Figures 3 and 5 of one run as printed, figure 6 of three experiments."""
    t, time, angle = h["t_s"], "time (s)", np.linspace(0.0, 2.0 * np.pi, 200)
    drag = Curve(t, h["drag"], "flown"), Curve(t, h["reference"], "reference", "reference")
    true = Curve(t[50:-2], h["disturbance"][50:-2], "true", "reference")
    both = Curve(t, h["estimate"], "estimate"), true
    tracking = [Panel("Drag", time, "drag (m/s2)", drag), Panel("Lumped disturbance", time, "d (m/s4)", both)]
    circles = [Curve(r * np.cos(angle), r * np.sin(angle), f"{r:g} km", "reference") for r in (3.0, 5.0)]
    misses = []
    for name in (AS_PRINTED.name, INFERRED.name, FLOWN.name):
        own = pick(rows, experiment=name)
        dots = Curve(_km(own, "downrange"), _km(own, "crossrange"), "runs", "dots")
        misses.append(Panel(f"Miss, {name}", "downrange (km)", "crossrange (km)", [dots, *circles], SQUARE))
    return {"fig3_fig5_as_printed": tracking, "fig6_misses": misses}


TITLE = "Disturbance-observer sliding guidance with input saturation"
STUDY = Study(SCENARIO, TITLE, "Zheng & Cui 2015", run, runs=500, quick_runs=40)
