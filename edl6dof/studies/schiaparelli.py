"""The landing of Schiaparelli: the chain that lost it, the cliff that it fell from, and the guards that would
have held.

The flight is that of ``scenarios/schiaparelli.yaml``, in which no fault is injected.  Other flights enter
with nutation of any phase, each in its own gusts: the flag of saturation stays on for different times, and
one guard at a time is switched on.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from math import degrees, nan
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof import Case
from edl6dof.campaign.executor import Row
from edl6dof.metrics.published import published_figures
from edl6dof.sim.flight import Flight
from edl6dof.sim.outcome import LANDED, TIPPED_OVER
from edl6dof.studies.frame import Curve, Finding, Grid, Line, Panel, Report, Session, Study
from edl6dof.studies.samples import column, mean, pick

SCENARIO, SEED = "schiaparelli", 20161019
_NAVIGATION, _GYROS = "flight_software.navigation", "sensors.inertial_unit.gyros"
PERSISTENCE = f"{_GYROS}.persistence_s"
#: Time for which the flag of saturation stays on, s: what was believed, what was flown, and around them.
PERSISTENCES = (0.015, 0.1, 0.2, 0.3, 0.5, 1.0, 1.5)
#: Time (s) after mortar fire in which the canopy opens and the capsule swings; height (m) of a release that
#: is too early: twice the planned one.
SWINGING_S, EARLY_M = 15.0, 2400.0
#: Figures that must be reproduced.
HELD = ("backshell_height_m", "engine_burn_s", "touchdown_vertical_m_s")


def _five_gyros() -> str:
    """Override: three gyros along the axes, two between pitch and yaw; five can isolate a wrong one."""
    skew = (("gd", (0.0, 0.5**0.5, 0.5**0.5)), ("ge", (0.0, 0.5**0.5, -(0.5**0.5))))
    axes = [*zip(("gx", "gy", "gz"), np.eye(3).tolist(), strict=True), *skew]
    return f"{_GYROS}.axes={json.dumps([{'name': name, 'axis': list(axis)} for name, axis in axes])}"


#: Transitions, one at a time: the overrides that switch one on.
GUARDS = {
    "nothing": (),
    "sign": (f"{_NAVIGATION}.guards.below_ground=true",),  # a height below the ground
    "parity": (_five_gyros(),),  # five gyros that check each other
    "consistency": (f"{_NAVIGATION}.guards.speed=true",),  # speed against the beams
    "persistence": (f"{PERSISTENCE}=0.015",),  # flag on for 15 ms
    "vertical": (f"{_NAVIGATION}.guards.vertical=true",),  # echo from above the horizon
    "left out": (f"{_NAVIGATION}.saturation.left_out=true",),  # flagged gyro not used
    "jump": (f"{_NAVIGATION}.guards.jump=true",),  # height that jumps
}
REMARKS = (
    "Nothing is made to fail: gyros meet the end of their range as the canopy swings the capsule faster.",
    "The phase of the nutation at entry, which decides how hard it swings, is drawn; 3 deg are an estimate.",
    "parity: two gyros more, between pitch and yaw, each with the same range.",
    "A failed check is noted whether or not its guard is switched on.",
)


def run(session: Session) -> Report:
    """Fly some nutation phases for each persistence, and with each guard."""
    session.total = session.flights * (len(PERSISTENCES) + len(GUARDS))
    sweeps = [("persistence", "nothing", x, [f"{PERSISTENCE}={x}"]) for x in PERSISTENCES]
    sweeps += [("guard", name, nan, list(overrides)) for name, overrides in GUARDS.items()]
    rows: list[Row] = []
    for sweep, guard, persistence, overrides in sweeps:
        label = {"sweep": sweep, "guard": guard, "persistence_s": persistence}
        rows += session.fly(edl6dof.load(SCENARIO, overrides), phases(session.flights, label), swing)
    flight = edl6dof.fly(SCENARIO)
    grids = [_cliff(pick(rows, sweep="persistence")), _guards(pick(rows, sweep="guard"))]
    return Report(list(_chain(flight)), rows, session.total + 1, grids, REMARKS, _pictures(flight, rows))


def phases(flights: int, label: Mapping[str, Any]) -> list[Case]:
    """Return entries with other phases of nutation and gusts; case k does not depend on their number."""
    bank = np.random.default_rng(SEED).uniform(-180.0, 180.0, flights)
    turned = ({"initial.bank_deg": round(float(b), 3)} for b in bank)
    return [Case(k, truth=truth, profile=k, label=label) for k, truth in enumerate(turned)]


# ---- one flight ----------------------------------------------------------------------------------------


def swing(flight: Flight) -> dict[str, float]:
    """Return figures of a flight: swing of the capsule under the opening canopy, time for which a gyro's
    saturation flag is set, error of the vertical afterwards, time of the first failed check, and whether it
    crashed (neither landed nor only tipped over).
    """
    crashed = float(flight.code not in (LANDED, TIPPED_OVER))
    t, fired = flight.telemetry["t_s"], flight.figures.get("parachute_s", nan)
    after = (t > fired) & (t < fired + SWINGING_S)
    if not after.any():
        lost = ("swing_deg_s", "flagged_s", "vertical_deg", "check_fails_s")
        return {**dict.fromkeys(lost, nan), "crashed": crashed}
    rates = [np.abs(flight.telemetry[f"truth.rate_{axis}_deg_s"][after]) for axis in "qr"]
    flagged = flight.telemetry["sensed.gyros_saturated"][after] > 0
    failed = min((event["t_s"] for event in flight.events if event["key"] == "guard"), default=nan)
    axes, end = ("north", "east", "down"), int(np.flatnonzero(after)[-1])
    error = np.radians([flight.telemetry[f"nav.error_attitude_{axis}_deg"][end] for axis in axes])
    down = Rotation.from_rotvec(error).apply([0.0, 0.0, 1.0])  # the vertical on board, in the true frame
    return {
        "swing_deg_s": float(np.max(rates)),
        "flagged_s": float(np.count_nonzero(flagged)) * float(np.median(np.diff(t))),
        "vertical_deg": degrees(np.arctan2(np.hypot(down[0], down[1]), down[2])),
        "check_fails_s": failed - fired,
        "crashed": crashed,
    }


# ---- what came out -------------------------------------------------------------------------------------


def _chain(flight: Flight) -> Iterator[Finding]:
    """One flight of the scenario compared with published figures."""
    for figure, entry in published_figures(flight.scenario.published):
        own, about = flight.figures.get(figure.name, nan), (figure.meaning, figure.unit.label)
        within = entry.sigma / abs(entry.number) if figure.name in HELD and entry.sigma else None
        yield Finding(*about, own, entry.number, entry.bound, within=within)


def _saturated(rows: list[Row]) -> list[Row]:
    """Flights in which a gyro reached the end of its range."""
    return [row for row in rows if row["flagged_s"] > 0.0]


def _landed(rows: list[Row]) -> int:
    return sum(bool(row["success"]) for row in rows)


def _early(rows: list[Row]) -> int:
    return int(np.sum(column(rows, "backshell_height_m", 0.0) > EARLY_M))


def _cliff(rows: list[Row]) -> Grid:
    lines: list[Line] = []
    for persistence in PERSISTENCES:
        own = pick(rows, persistence_s=persistence)
        hit = _saturated(own)
        counts = (len(own), len(hit), _landed(hit), _early(hit))
        lines.append((f"{persistence:g} s", *counts, mean(hit, "vertical_deg")))
    heads = ("flag stays on", "flights", "beyond the range", "of these landed", "released early",
             "vertical off deg")  # fmt: skip
    return Grid("How long the flag stays on", heads, lines)


def _guards(rows: list[Row]) -> Grid:
    lines: list[Line] = []
    for guard in GUARDS:
        own = pick(rows, guard=guard)
        hit = _saturated(own)
        crashed = sum(bool(row["crashed"]) for row in hit)
        counts = (len(own), _landed(own), len(hit), _landed(hit), crashed, _early(hit))
        lines.append((guard, *counts, mean(pick(own, success=True), "propellant_used_kg")))
    heads = ("", "flights", "landings", "beyond the range", "of these landed", "crashed", "released early",
             "propellant kg")  # fmt: skip
    return Grid("One guard at a time", heads, lines)


def _pictures(flight: Flight, rows: list[Row]) -> dict[str, list[Panel]]:
    """The height of the one flight, true and on board; the cliff, by swing and persistence of the flag."""
    t, height = flight.telemetry["t_s"], flight.telemetry["truth.height_m"] / 1e3
    on_board = height + flight.telemetry["nav.error_height_m"] / 1e3
    late = t > flight.figures["parachute_s"]
    heights = [Curve(t[late], height[late], "true"), Curve(t[late], on_board[late], "on board")]
    end = flight.scenario.sensors.inertial_unit.gyros.range_deg_s
    cliff = [Curve([1.0, 1.0], [0.0, 1.6], "end of the range", "reference")]
    for name, good in (("within limits", True), ("lost", False)):
        own = pick(rows, sweep="persistence", success=good)
        cliff.append(Curve(column(own, "swing_deg_s") / end, column(own, "persistence_s"), name, "dots"))
    panels = [Panel("Height above ground", "time after entry (s)", "height (km)", heights)]
    panels.append(Panel("Landed and lost", "fastest swing over the gyros' range", "flag stays on (s)", cliff))
    return {"chain_and_cliff": panels}


TITLE = "The landing of Schiaparelli: the chain, the cliff and the guards"
SOURCE = "T. Tolker-Nielsen, EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN, 2017"
STUDY = Study(SCENARIO, TITLE, SOURCE, run, runs=40, quick_runs=3)
