"""Hazard avoidance with a dead horizontal thruster (S1 6.3, Fig. 7): what it does to the roll axis, diagnosed
and not, under the control of the paper and under others.

Of its control the paper gives the estimator in place of the integral (eq. 9), two thrusters to a direction
and the selection by the size of the demand: the table of thrusters here.  It prints neither gains nor
lambda, and on them its argument rests: a dead thruster leaves the torque d of its partner, the estimator is
worth a proportional gain P + lambda D, and so roll errs by about d / (J (P + lambda D)).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from edl6dof.campaign.executor import in_threads
from edl6dof.campaign.rows import Row
from edl6dof.config.wording import counted
from edl6dof.interface.roles import HAZARD_AVOIDANCE, begun
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import Flight, fly
from edl6dof.studies.hu2022.rigs import AGAINST_STEP, INTEGRAL, LANDER, SCENARIO, carry_on, state_at
from edl6dof.studies.study import Grid
from edl6dof.telemetry.timeline import first_times

_TABLE = "flight_software.allocation.method=table"
_POLE = "flight_software.estimation.first_order.torque_pole_rad_s"
#: What controls attitude, and who shares its demand out: first what the paper tells of the real one.
FLOWN = "eq. 9, table"
CONTROL: dict[str, tuple[str, ...]] = {
    FLOWN: (_TABLE,),
    "PID, table": (_TABLE, *AGAINST_STEP["integral"], f"{LANDER}.roll.integral=0.4"),
    "eq. 9, least squares": (),
}
DIAGNOSED: dict[bool, tuple[str, ...]] = {True: (), False: ("flight_software.diagnosis.enabled=false",)}
#: When the thruster dies, s into the phase: before its first push, and in it.
MOMENTS_S = (0.0, 1.0, 2.0)
#: Way to the safe spot, in the direction in which the thruster pushes, m.
WAY_M = 20.0
#: Convergence speeds lambda of the estimator, rad/s: that of the scenario and slower ones.
POLES_RAD_S = (8.0, 4.0, 2.0, 1.0, 0.5)
#: Thruster of the paper's figure.
SHOWN = "D7"
#: Dispersed entries for each start of the avoidance.
_ENTRIES_FOR_A_START = 33
_HEADS = (
    "control",
    "foreseen (deg)",
    "all sound (deg)",
    *(
        f"{told} {what}"
        for told in ("undiagnosed", "diagnosed")
        for what in ("mean (deg)", "worst (deg)", "miss (m)")
    ),
)
_TERMINAL = "flight_software.guidance.powered.terminal"


@dataclass(frozen=True)
class Case:
    """One avoidance: from which start, under which control, and which thruster dies; none where it is
    empty.
    """

    start: int
    control: str
    diagnosed: bool
    thruster: str = ""
    moment_s: float = 0.0
    pole_rad_s: float = POLES_RAD_S[0]


def starts(entries: int) -> list[State]:
    """States shortly before the avoidance of flights on instruments, each with errors of its own."""
    return [_start(profile) for profile in range(max(1, entries // _ENTRIES_FOR_A_START))]


def _start(profile: int) -> State:
    own = (f"profile={profile}",)
    begin = first_times(fly(load_scenario(SCENARIO, own)).events)[begun(HAZARD_AVOIDANCE)]
    return state_at(begin - 0.5, own)


def cases(states: list[State], scenario: Scenario) -> Iterator[Case]:
    """Every control with all thrusters sound, and with each horizontal one dead at every moment, diagnosed
    and not; and the slower estimators.
    """
    for start in range(len(states)):
        for control in CONTROL:
            yield Case(start, control, True)
            for name in pushes(scenario):
                for moment in MOMENTS_S:
                    for diagnosed in DIAGNOSED:
                        yield Case(start, control, diagnosed, name, moment)
    for pole in POLES_RAD_S[1:]:
        yield Case(0, FLOWN, False, SHOWN, 0.0, pole)


def pushes(scenario: Scenario) -> dict[str, tuple[float, float]]:
    """Direction north and east in which each horizontal thruster pushes the upright lander, whose y axis
    points south and whose z axis west.
    """
    thrusters = scenario.vehicle.rcs.thrusters
    return {
        one.name: (-one.direction[1], -one.direction[2]) for one in thrusters if one.group == "horizontal"
    }


def flown(states: list[State], scenario: Scenario, case: Case) -> Flight:
    """Fly a case."""
    north, east = pushes(scenario)[case.thruster or SHOWN]
    phase = scenario.phase_names[scenario.phase_roles.index(HAZARD_AVOIDANCE)]
    when = f"{{phase: {phase}, plus_s: {case.moment_s}}}"
    dead = f"faults=[{{thruster: {case.thruster}, kind: stuck_off, at: {when}}}]"
    changes = (
        *CONTROL[case.control],
        *DIAGNOSED[case.diagnosed],
        *((dead,) if case.thruster else ()),
        f"{_TERMINAL}.safe_spot_north_m={WAY_M * north}",
        f"{_TERMINAL}.safe_spot_east_m={WAY_M * east}",
        f"{_POLE}={case.pole_rad_s}",
    )
    return carry_on(states[case.start], changes)


def avoidance_rows(states: list[State], scenario: Scenario) -> Iterator[Row]:
    """A row for each case."""
    return in_threads(
        lambda case: _row(flown(states, scenario, case), scenario, case), list(cases(states, scenario))
    )


def _row(flight: Flight, scenario: Scenario, case: Case) -> Row:
    table, rows = flight.telemetry, np.flatnonzero(flight.during(HAZARD_AVOIDANCE))
    first, last = rows[0], rows[-1]
    north, east = (WAY_M * part for part in pushes(scenario)[case.thruster or SHOWN])
    places = [table[f"truth.site_{axis}_m"] for axis in ("north", "east")]
    way = [place[last] - place[first] for place in places]
    return {
        "experiment": "avoidance",
        "variant": case.control,
        "case": case.start,
        "landed": bool(flight.landed),
        "outcome": flight.outcome,
        "thruster": case.thruster,
        "moment_s": case.moment_s,
        "diagnosed": case.diagnosed,
        "pole_rad_s": case.pole_rad_s,
        "named": [one.thruster for one in flight.isolated_faults] == [case.thruster],
        "peak_error_deg": float(np.max(np.abs(table["control.error_roll_deg"][rows]))),
        "peak_rate_deg_s": float(np.max(np.abs(table["truth.rate_p_deg_s"][rows]))),
        "miss_m": float(np.hypot(way[0] - north, way[1] - east)),
    }


def foreseen_deg(scenario: Scenario, inertia: float, pole_rad_s: float) -> float:
    """Roll error that a dead thruster is to cause under eq. 9, d / (J (P + lambda D)): d by its partner at
    the largest lateral force.

    Args:
        scenario: the nominal one.
        inertia: about roll, kg m2.
        pole_rad_s: lambda; 0 for a PID law, whose integral is slow.
    """
    partner = next(one for one in scenario.vehicle.rcs.thrusters if one.name == SHOWN)
    arm = abs(partner.position_m[1])
    duty = scenario.flight_software.guidance.powered.terminal.lateral_force_n / (2.0 * partner.thrust_n)
    gains = scenario.flight_software.control.thrust_vector.roll
    stiffness = gains.proportional + pole_rad_s * gains.derivative
    return float(np.degrees(duty * partner.thrust_n * arm / (inertia * stiffness)))


def grids(scenario: Scenario, inertia: float, rows: list[Row]) -> tuple[Grid, Grid]:
    """The argument of Fig. 7 as tables: roll errors foreseen and flown with the fault undiagnosed and
    diagnosed, and how far from the safe spot that ends; and undiagnosed with slower estimators.
    """
    avoided = [row for row in rows if row["experiment"] == "avoidance"]
    lines = [_line(scenario, inertia, control, avoided) for control in CONTROL]
    each = counted(len(flights_of(avoided, FLOWN, diagnosed=False)), "flight")
    title = f"Fig. 7: roll error with a horizontal thruster dead in hazard avoidance, {each} each"
    slower = [
        (f"{row['pole_rad_s']:g}", foreseen_deg(scenario, inertia, row["pole_rad_s"]), row["peak_error_deg"])
        for row in avoided
        if (row["variant"], row["thruster"], row["moment_s"], row["diagnosed"]) == (FLOWN, SHOWN, 0.0, False)
        and row["case"] == 0
    ]
    return Grid(title, _HEADS, tuple(lines)), Grid(
        f"{SHOWN} dead, undiagnosed, {FLOWN}",
        ("lambda (rad/s)", "foreseen (deg)", "flown (deg)"),
        tuple(slower),
    )


def _line(scenario: Scenario, inertia: float, control: str, avoided: list[Row]) -> tuple[str | float, ...]:
    pole = 0.0 if INTEGRAL in CONTROL[control] else POLES_RAD_S[0]
    sound = [row["peak_error_deg"] for row in avoided if (row["variant"], row["thruster"]) == (control, "")]
    line: list[str | float] = [control, foreseen_deg(scenario, inertia, pole), float(np.mean(sound))]
    for diagnosed in (False, True):
        dead = flights_of(avoided, control, diagnosed)
        errors, miss = ([row[name] for row in dead] for name in ("peak_error_deg", "miss_m"))
        line += [float(np.mean(errors)), float(np.max(errors)), float(np.mean(miss))]
    return tuple(line)


def flights_of(avoided: list[Row], control: str, diagnosed: bool) -> list[Row]:
    """Rows with a dead thruster under a control and the estimator of the scenario."""
    return [
        row
        for row in avoided
        if row["thruster"]
        and (row["variant"], row["diagnosed"], row["pole_rad_s"]) == (control, diagnosed, POLES_RAD_S[0])
    ]


def shown(states: list[State], scenario: Scenario) -> dict[str, Flight]:
    """The flights of the drawing: the thruster of the paper's figure dead from the start."""
    return {
        f"{control}, {'diagnosed' if diagnosed else 'undiagnosed'}": flown(
            states, scenario, Case(0, control, diagnosed, SHOWN)
        )
        for control in CONTROL
        for diagnosed in DIAGNOSED
    }
