"""Hu et al. 2022 (S1): the attitude control of Tianwen-1, its flight results and its claims, recomputed.

Published figures of the flight are compared with the mean of neighbouring flights.  The claims are tested in
flights from its saved states: thrust-direction tracking of the two error formulations from dispersed starts
of the powered descent (section 6.2), a 100 N m step against the disturbance estimator and against integral
action (section 6.2), hazard avoidance with a dead horizontal thruster (section 6.3, Fig. 7), and a trim wing
that fails (section 4.3).  The paper prints curves and maxima, and no tables.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from math import nan
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof import State
from edl6dof.campaign.ensemble import FLIGHTS, SPEED_STEP_M_S, fly_neighbours, sample_means
from edl6dof.campaign.executor import Row, in_threads
from edl6dof.config.wording import counted
from edl6dof.fsw.control.attitude_error import goal_attitude
from edl6dof.interface.roles import HAZARD_AVOIDANCE, HOVER_IMAGING, begun
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight
from edl6dof.spatial.quaternion import about_axis, multiply
from edl6dof.studies.frame import Curve, Finding, Grid, Line, Panel, Report, Session, Study
from edl6dof.studies.samples import beside_published, column, last_time, percentage, pick, with_quantile
from edl6dof.telemetry.timeline import first_times
from edl6dof.vehicle.plant import ATTITUDE, RATE

SCENARIO, SEED = "tianwen1", 2022
#: Perfect sensors: control is tested, and the flight computer has to know a state that was set.
_PERFECT = "sensors.set=perfect"
LANDER = "flight_software.control.thrust_vector"
REMARKS = (
    "Published values are followed by mean and standard deviation over flights that differ by "
    f"{SPEED_STEP_M_S:g} m/s in entry speed, {FLIGHTS} where the study flies in full.",
    "S1's pitch is the channel of sideslip and its yaw that of the angle of attack: the yaw and pitch of "
    "this body frame. The paper does not state the signs of its axes: magnitudes are compared.",
    "Rates in lift are those of the channels of angle of attack and sideslip: without the yaw p tan(alpha) "
    "that banking about the velocity is in the body.",
    "Rates and errors are the largest; the thrust direction counts as found within 5 deg, a "
    "step as settled within 0.5 deg; roll in the powered descent is looked at from 8 s on.",
    "Equal PID: the gains that the estimator is worth in its linear range, P + lambda D, lambda P and "
    "D + lambda.",
    "Fig. 7: each horizontal thruster dies before its first push, or 1 or 2 s into it, 20 m to go, on "
    "instruments. Where a PID law alone works against the disturbance, that spoils the roll axis, and "
    "diagnosis saves it, as the paper says. The paper's estimator at the lambda of the scenario saves it by "
    "itself, with P + lambda D in place of P, and diagnosis leaves three quarters of it on average; the "
    "worst flight with the table of thrusters is worse with it, as a latch valve is moved to distinguish a "
    "dead thruster from a leak. The safe spot is reached either way, as the missing force is fed forward. "
    "The paper prints neither gains nor lambda; foreseen is d / (J (P + lambda D)). Diagnosis uses force "
    "and torque, as in the paper; with flow meters it is faster: scenario tianwen1_meters.",
    "Fig. 12: the 40 N are the estimate of a disturbance with healthy thrusters, not the force of avoidance, "
    "of which a pair has 500 N. As printed, eq. 12 takes the commanded force as delivered, which makes pulse "
    "modulation part of the estimate; here the estimator sees the valves.",
    "Fig. 11: the largest torque of the real flight was about its yaw, here it is about the yaw of this body "
    "frame, where the tanks are out of balance: sizes compare.",
)


def run(session: Session) -> Report:
    """Fly the nominal flight and its neighbours, dispersed powered descents, and the single experiments."""
    nominal = edl6dof.fly(SCENARIO, [_PERFECT])
    around = min(FLIGHTS, max(2, session.flights))
    release = state_at(nominal.figures["backshell_s"] + AFTER_RELEASE_S)
    before = avoidance_starts(session.flights)
    tasks: list[Callable[[], Row]] = []
    for number, entry in enumerate(draw_entries(session.flights, SEED)):
        tasks += [partial(entry_row, release, number, entry, formulation) for formulation in FORMULATIONS]
    avoided = avoidance_cases(len(before), nominal.scenario)
    tasks += [partial(avoidance_row, before, nominal.scenario, one) for one in avoided]
    single = len(AGAINST_STEP) + len(WING)
    session.total = 1 + around + len(tasks) + single
    means = sample_means(fly_neighbours(nominal.loaded, around), nominal.scenario.published)
    session.step(1 + around)
    rows: list[Row] = []
    for row in in_threads(lambda task: task(), tasks):
        rows.append(row)
        session.step()
    rows += [step_row(name, flight) for name, flight in torque_steps(nominal).items()]
    rows += [wing_row(name, held) for name, held in WING.items()]
    session.step(single)
    findings = [*beside_published(nominal.scenario.published, means, _FLIGHT), _lateral_force(nominal)]
    findings += [*_of_entries(pick(rows, experiment="entry")), *_of_experiments(rows)]
    grids = _avoidance_grids(nominal, pick(rows, experiment="avoidance"))
    return Report(findings, rows, session.total, grids, REMARKS, _pictures(nominal, before))


def state_at(time_s: float, changes: Sequence[str] = (_PERFECT,)) -> State:
    """State at a time of the Tianwen-1 scenario with ``PATH=VALUE`` changes."""
    limit = f"simulation.time_limit_s={time_s + 1.0}"
    saved = edl6dof.fly(SCENARIO, [*changes, limit], save_at_s=time_s).saved
    if saved is None:
        raise ValueError(f"the flight is over before {time_s:g} s")
    return saved


def carry_on(state: State, changes: Sequence[str], until_s: float = 900.0) -> Flight:
    """Fly on from a state under changed settings."""
    return edl6dof.fly(start=state, overrides=[*changes, f"simulation.time_limit_s={until_s}"])


def _head(experiment: str, variant: str, flight: Flight, index: int = 0) -> Row:
    head = {"experiment": experiment, "variant": variant, "case": index}
    return {**head, "landed": bool(flight.landed), "outcome": flight.outcome}


# ---- the flight beside the published one ---------------------------------------------------------------

#: Figures of the flight, and their places in Figs. 8 to 12 and the text.
_NO_PLACE = ("lift_start_s", "trim_wing_s", "parachute_s", "backshell_s", "touchdown_s")
_TOUCHDOWN = [f"touchdown_{axis}" for axis in ("roll", "pitch", "yaw")]
_FLIGHT = {
    **dict.fromkeys(_NO_PLACE, ""),
    "trim_aoa_limit_cycle_deg": "sect. 3",
    "bank_reversals": "Fig. 8",
    "max_bank_rate_deg_s": "Fig. 8",
    "max_pitch_rate_lift_deg_s": "Fig. 10",
    "max_yaw_rate_lift_deg_s": "Fig. 9",
    "parachute_total_alpha_deg": "sect. 4",
    "max_rate_parachute_deg_s": "Figs. 8-10",
    "roll_error_at_ignition_deg": "Fig. 8, size",
    "max_attitude_error_powered_deg": "Fig. 10",
    "max_rate_powered_deg_s": "Figs. 8-10",
    "max_roll_error_powered_deg": "Fig. 8",
    "max_estimated_torque_nm": "Fig. 11",
    **{f"{name}_{what}": "Figs. 8-10" for name in _TOUCHDOWN for what in ("error_deg", "rate_deg_s")},
}


def _lateral_force(flight: Flight) -> Finding:
    table = flight.telemetry
    rows = (table["t_s"] > flight.figures["backshell_s"] + 1.0) & flight.during(HAZARD_AVOIDANCE)
    rows &= table["t_s"] < flight.figures["touchdown_s"]
    own = max(float(np.max(np.abs(table[f"estimate.force_{axis}_n"][rows]))) for axis in "yz")
    return Finding("estimated force", "N", own, 40.0, note="Fig. 12, one flight")


# ---- section 6.2: two formulations of the attitude error -----------------------------------------------

FORMULATIONS = ("decoupled", "shortest_path")
#: Time after backshell release at which dispersed entries of the powered descent begin, s.
AFTER_RELEASE_S = 0.06
#: Thrust-direction error below which a commanded direction counts as found, and the time in which it is
#: looked for.  In the divert the command turns by some 2.5 deg/s, and the controller, which does not know
#: this rate, follows it later by derivative over proportional gain: 1.4 s.
FOUND_DEG, WATCHED_S = 5.0, 12.0


class Entry(NamedTuple):
    """Roll error, tilt towards an azimuth of the body, and body rate where powered descent begins."""

    roll_deg: float
    tilt_deg: float
    towards_deg: float
    rate_deg_s: tuple[float, ...]


def draw_entries(count: int, seed: int) -> Iterator[Entry]:
    """Draw starts: roll up to 120 deg, tilts of 10 to 40 deg, rates of 5 deg/s (1 sigma)."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        roll, tilt, towards = rng.uniform((-120.0, 10.0, 0.0), (120.0, 40.0, 360.0)).tolist()
        yield Entry(roll, tilt, towards, tuple((5.0 * rng.standard_normal(3)).tolist()))


def hung_like(state: State, entry: Entry) -> State:
    """A copy of a state with the attitude and rate of ``entry``, consistent in sensors and estimators."""
    plant, sensors, fsw = state.plant.copy(), state.sensors.copy(), state.fsw.copy()
    nav = fsw["nav"][0]
    axes = (tuple(nav[f"{name}_I"]) for name in ("north", "east", "up", "up"))
    towards = np.radians(entry.towards_deg)
    tilt = about_axis((0.0, np.cos(towards), np.sin(towards)), np.radians(entry.tilt_deg))
    roll, rate = about_axis((1.0, 0.0, 0.0), np.radians(entry.roll_deg)), np.radians(entry.rate_deg_s)
    plant["y"][0, ATTITUDE : ATTITUDE + 4] = multiply(multiply(goal_attitude(*axes), tilt), roll)
    plant["y"][0, RATE : RATE + 3] = rate
    sensors["imu"]["rate"][:] = rate
    fsw["estimation"]["rate"] = rate
    return replace(state, plant=plant, sensors=sensors, fsw=fsw)


def entry_row(release: State, index: int, entry: Entry, formulation: str) -> Row:
    """Fly one dispersed entry with one error formulation: time to reach the commanded thrust direction."""
    flight = carry_on(hung_like(release, entry), [f"{LANDER}.error={formulation}"])
    t = flight.telemetry["t_s"] - flight.telemetry["t_s"][0]
    watched = t < WATCHED_S
    t, error = t[watched], thrust_error_deg(flight)[watched]
    return {
        **_head("entry", formulation, flight, index),
        **{"roll_deg": entry.roll_deg, "tilt_deg": entry.tilt_deg},
        **{"first_error_deg": float(error[0]), "peak_error_deg": float(error.max())},
        "settled_s": last_time(t, error > FOUND_DEG),
        "mean_error_deg": float(np.trapezoid(error, t)) / WATCHED_S,
    }


def thrust_error_deg(flight: Flight) -> np.ndarray:
    """Angle between thrust axis and commanded thrust direction, by row of telemetry."""
    rows = flight.telemetry
    spin = flight.scenario.planet.rotation_rate_rad_s
    east_of_I = rows["truth.longitude_deg"] + np.degrees(spin * rows["t_s"])
    turns = np.column_stack([east_of_I, -rows["truth.latitude_deg"] - 90.0])  # that turn I north, east, down
    asked = np.stack([rows[f"guide.thrust_direction_{axis}"] for axis in ("north", "east", "down")], axis=1)
    wanted = Rotation.from_euler("ZY", turns, degrees=True).apply(asked)
    attitude = np.stack([rows[f"truth.q_I2B_{c}"] for c in "wxyz"], axis=1)
    thrust = Rotation.from_quat(attitude, scalar_first=True).apply([-1.0, 0.0, 0.0])
    across = np.linalg.norm(np.cross(thrust, wanted), axis=1)
    return np.degrees(np.arctan2(across, np.sum(thrust * wanted, axis=1)))


def _of_entries(rows: list[Row]) -> Iterator[Finding]:
    found = {name: column(pick(rows, variant=name), "settled_s") for name in FORMULATIONS}
    for name in FORMULATIONS:
        word, error = name.replace("_", " "), column(pick(rows, variant=name), "mean_error_deg")
        yield with_quantile(Finding(f"thrust found, {word}", "s", nan, note="median"), found[name], 0.5)
        yield with_quantile(Finding(f"worst tenth, {word}", "s", nan, note="90 %"), found[name], 0.9)
        yield with_quantile(Finding(f"mean error, {word}", "deg", nan, note="median"), error, 0.5)
    quicker = percentage(found["decoupled"] <= found["shortest_path"] + 0.05)
    yield Finding("decoupled is no slower in", "%", quicker, note="sect. 6.2")
    yield Finding("dispersed entries landed", "%", percentage(row["landed"] for row in rows), note="both")


# ---- sections 6.2 and 4.3: a torque step in the hover, a trim wing that stays shut ---------------------

#: Torque of the step, N m, and settings of control against it by name.
STEP_NM = 100.0
_PITCH_YAW, INTEGRAL = f"{LANDER}.pitch_yaw", f"{LANDER}.against_disturbance=integral"
AGAINST_STEP: dict[str, tuple[str, ...]] = {
    "estimator": (),
    # the integral that settles soonest with the same P and D, in a PID zone wide enough for it
    "integral": (INTEGRAL, f"{_PITCH_YAW}.integral=0.4", f"{_PITCH_YAW}.near_deg=12"),
    # PID gains equal to the estimator in its linear range: P + lambda D, lambda P, D + lambda; P 1.4, D 1.9,
    # lambda 8
    "equal PID": (
        *(INTEGRAL, f"{_PITCH_YAW}.proportional=16.6", f"{_PITCH_YAW}.integral=11.2"),
        f"{_PITCH_YAW}.derivative=9.9",
    ),
}
#: Time into the hover at which the step comes, and time watched after it, s.
STEP_AFTER_S, STEP_WATCHED_S = 11.0, 25.0
#: Attitude error below which a torque step counts as settled: above the limit cycle of the thrusters.
SETTLED_DEG = 0.5
#: Thrusters hold the angle of attack after the wing failed, or it is left to trim.
HELD = "alpha held"
WING = {HELD: True, "left to trim": False}


def torque_steps(flight: Flight) -> dict[str, Flight]:
    """Fly the hover with a sudden offset of the engine from the centre of mass: a torque about z of B."""
    start = first_times(flight.events)[begun(HOVER_IMAGING)] + STEP_AFTER_S
    state = state_at(start)
    thrust = float(np.interp(start, flight.telemetry["t_s"], flight.telemetry["truth.engine_thrust_n"]))
    x, y, z = flight.scenario.vehicle.engines[0].nozzle_m
    off = f"truth={json.dumps({'vehicle.engines.main.nozzle_m': [x, y + STEP_NM / thrust, z]})}"
    hover = flight.scenario.phase_roles.index(HOVER_IMAGING)
    changes = [off, f"mission.phases.{hover}.until.value={STEP_AFTER_S + STEP_WATCHED_S + 5.0}"]
    end = start + STEP_WATCHED_S
    return {name: carry_on(state, [*changes, *own], end) for name, own in AGAINST_STEP.items()}


def step_row(name: str, flight: Flight) -> Row:
    """Peak and settling of the yaw error after the torque step."""
    t = flight.telemetry["t_s"] - flight.telemetry["t_s"][0]
    error = np.abs(flight.telemetry["control.error_yaw_deg"])
    figures = {"peak_error_deg": float(error.max()), "settled_s": last_time(t, error > SETTLED_DEG)}
    return {**_head("torque step", name, flight), **figures}


def wing_row(name: str, held: bool) -> Row:
    """Fly an entry whose trim wing stays shut: total angle of attack when the parachute opens."""
    phases, alpha = edl6dof.load(SCENARIO).scenario.mission.phases, "parachute_total_alpha_deg"
    branch = [phase.hold_alpha for phase in phases].index(True)
    holding = f"mission.phases.{branch}.hold_alpha={str(held).lower()}"
    flight = edl6dof.fly(SCENARIO, [_PERFECT, "faults=[{kind: wing_stuck, at: {time_s: 0}}]", holding])
    return {**_head("trim wing", name, flight), alpha: flight.figures[alpha]}


def _of_experiments(rows: list[Row]) -> Iterator[Finding]:
    for row in pick(rows, experiment="torque step"):
        words = f"{STEP_NM:g} N m, {row['variant']}"
        yield Finding(f"{words}: peak", "deg", row["peak_error_deg"], note="sect. 6.2")
        yield Finding(f"{words}: settled", "s", row["settled_s"])
    for row in pick(rows, experiment="trim wing"):
        name, alpha = row["variant"], row["parachute_total_alpha_deg"]
        yield Finding(f"wing failed, {name}", "deg", alpha, 7.0, "<=" if name == HELD else "", "sect. 4.3")


# ---- section 6.3, Fig. 7: hazard avoidance with a dead horizontal thruster -----------------------------
#
# Of its control the paper gives the estimator in place of the integral (eq. 9), two thrusters to a direction
# and the selection by the size of the demand: the table of thrusters here.  It prints neither gains nor
# lambda, which its argument depends on: a dead thruster leaves the torque d of its partner, the estimator is
# worth a proportional gain P + lambda D, and so roll errs by about d / (J (P + lambda D)).

_TABLE = "flight_software.allocation.method=table"
#: Attitude control and control allocation: first those that the paper describes.
FLOWN = "eq. 9, table"
CONTROL: dict[str, tuple[str, ...]] = {
    FLOWN: (_TABLE,),
    "PID, table": (_TABLE, *AGAINST_STEP["integral"], f"{LANDER}.roll.integral=0.4"),
    "eq. 9, least squares": (),
}
#: Times of the failure, s into the phase: before the first push of the thruster, and in it.
MOMENTS_S = (0.0, 1.0, 2.0)
#: Distance of the safe spot, in the direction in which the thruster pushes, m.
WAY_M = 20.0
#: Convergence speeds lambda of the estimator, rad/s: that of the scenario and slower ones.
POLES_RAD_S = (8.0, 4.0, 2.0, 1.0, 0.5)
#: Thruster of the paper's figure; dispersed entries for each start of the avoidance.
SHOWN, _ENTRIES_FOR_A_START = "D7", 33


class Avoidance(NamedTuple):
    """One hazard avoidance: its start, its control, and the thruster that fails, if any."""

    start: int
    control: str
    diagnosed: bool
    thruster: str = ""
    moment_s: float = 0.0
    pole_rad_s: float = POLES_RAD_S[0]


def avoidance_starts(entries: int) -> list[State]:
    """States shortly before hazard avoidance in flights by instruments, each with its own sensor errors."""
    found = []
    for profile in range(max(1, entries // _ENTRIES_FOR_A_START)):
        own = (f"profile={profile}",)
        begin = first_times(edl6dof.fly(SCENARIO, own).events)[begun(HAZARD_AVOIDANCE)]
        found.append(state_at(begin - 0.5, own))
    return found


def avoidance_cases(starts: int, scenario: Scenario) -> Iterator[Avoidance]:
    """Yield every control with all thrusters intact and each horizontal one dead; then slower estimators."""
    for start, control in product(range(starts), CONTROL):
        yield Avoidance(start, control, True)
        for name, moment, diagnosed in product(pushes(scenario), MOMENTS_S, (True, False)):
            yield Avoidance(start, control, diagnosed, name, moment)
    for pole in POLES_RAD_S[1:]:
        yield Avoidance(0, FLOWN, False, SHOWN, 0.0, pole)


def pushes(scenario: Scenario) -> dict[str, tuple[float, float]]:
    """North and east parts of the push of each horizontal thruster on an upright lander (y south, z west)."""
    horizontal = [one for one in scenario.vehicle.rcs.thrusters if one.group == "horizontal"]
    return {one.name: (-one.direction[1], -one.direction[2]) for one in horizontal}


def avoid(states: list[State], scenario: Scenario, case: Avoidance) -> Flight:
    """Fly a hazard avoidance."""
    north, east = pushes(scenario)[case.thruster or SHOWN]
    phase = scenario.phase_names[scenario.phase_roles.index(HAZARD_AVOIDANCE)]
    when = f"{{phase: {phase}, plus_s: {case.moment_s}}}"
    dead = f"faults=[{{thruster: {case.thruster}, kind: stuck_off, at: {when}}}]"
    terminal = "flight_software.guidance.powered.terminal"
    changes = (
        *CONTROL[case.control],
        f"flight_software.diagnosis.enabled={str(case.diagnosed).lower()}",
        *((dead,) if case.thruster else ()),
        f"{terminal}.safe_spot_north_m={WAY_M * north}",
        f"{terminal}.safe_spot_east_m={WAY_M * east}",
        f"flight_software.estimation.first_order.torque_pole_rad_s={case.pole_rad_s}",
    )
    return carry_on(states[case.start], changes)


def avoidance_row(states: list[State], scenario: Scenario, case: Avoidance) -> Row:
    """Effect of a hazard avoidance on the roll axis, and its distance from the safe spot at the end."""
    flight = avoid(states, scenario, case)
    table, rows = flight.telemetry, np.flatnonzero(flight.during(HAZARD_AVOIDANCE))
    terminal = flight.scenario.flight_software.guidance.powered.terminal
    off = []
    for axis, wanted in (("north", terminal.safe_spot_north_m), ("east", terminal.safe_spot_east_m)):
        place = table[f"truth.site_{axis}_m"]
        off.append(place[rows[-1]] - place[rows[0]] - wanted)
    return {
        **_head("avoidance", case.control, flight, case.start),
        **{name: getattr(case, name) for name in ("thruster", "moment_s", "diagnosed", "pole_rad_s")},
        "named": [one.thruster for one in flight.isolated_faults] == [case.thruster],
        "peak_error_deg": float(np.max(np.abs(table["control.error_roll_deg"][rows]))),
        "peak_rate_deg_s": float(np.max(np.abs(table["truth.rate_p_deg_s"][rows]))),
        "miss_m": float(np.hypot(*off)),
    }


def foreseen_deg(scenario: Scenario, inertia: float, pole_rad_s: float) -> float:
    """Roll error by a dead thruster under eq. 9, d / (J (P + lambda D)), with d the torque of its partner at
    the largest lateral force, roll ``inertia`` J (kg m2), and lambda = 0 for a PID law, whose integral is
    slow.
    """
    partner = next(one for one in scenario.vehicle.rcs.thrusters if one.name == SHOWN)
    duty = scenario.flight_software.guidance.powered.terminal.lateral_force_n / (2.0 * partner.thrust_n)
    gains = scenario.flight_software.control.thrust_vector.roll
    stiffness = gains.proportional + pole_rad_s * gains.derivative
    torque = duty * partner.thrust_n * abs(partner.position_m[1])
    return float(np.degrees(torque / (inertia * stiffness)))


def _avoidance_grids(nominal: Flight, avoided: list[Row]) -> list[Grid]:
    """The argument of Fig. 7 as tables: roll errors foreseen and flown with the fault undiagnosed and
    diagnosed, and the final distance from the safe spot; and undiagnosed with slower estimators.
    """
    scenario, inertia = nominal.scenario, float(nominal.outputs["inertia"][0, 0])
    what = ("mean (deg)", "worst (deg)", "miss (m)")
    heads = ("control", "foreseen (deg)", "all sound (deg)",
             *(f"{told} {one}" for told in ("undiagnosed", "diagnosed") for one in what))  # fmt: skip
    lines: list[Line] = []
    for control in CONTROL:
        pole = 0.0 if INTEGRAL in CONTROL[control] else POLES_RAD_S[0]
        sound = column(pick(avoided, variant=control, thruster=""), "peak_error_deg")
        line: Line = (control, foreseen_deg(scenario, inertia, pole), float(np.mean(sound)))
        for diagnosed in (False, True):
            dead = with_dead_thruster(avoided, control, diagnosed)
            error, miss = column(dead, "peak_error_deg"), column(dead, "miss_m")
            line += (float(np.mean(error)), float(np.max(error)), float(np.mean(miss)))
        lines.append(line)
    each = counted(len(with_dead_thruster(avoided, FLOWN, diagnosed=False)), "flight")
    slower: list[Line] = []
    for row in pick(avoided, variant=FLOWN, thruster=SHOWN, moment_s=0.0, diagnosed=False, case=0):
        pole = row["pole_rad_s"]
        slower.append((f"{pole:g}", foreseen_deg(scenario, inertia, pole), row["peak_error_deg"]))
    title = f"Fig. 7: roll error with a horizontal thruster dead in hazard avoidance, {each} each"
    foreseen = ("lambda (rad/s)", "foreseen (deg)", "flown (deg)")
    return [Grid(title, heads, lines), Grid(f"{SHOWN} dead, undiagnosed, {FLOWN}", foreseen, slower)]


def with_dead_thruster(avoided: list[Row], control: str, diagnosed: bool) -> list[Row]:
    """Rows with a dead thruster under a control and the estimator of the scenario."""
    own = pick(avoided, variant=control, diagnosed=diagnosed, pole_rad_s=POLES_RAD_S[0])
    return [row for row in own if row["thruster"]]


def _pictures(nominal: Flight, states: list[State]) -> dict[str, list[Panel]]:
    """Fig. 7: roll with the paper's thruster dead from the start; Fig. 11: estimated torque."""
    roll, own, figures = [], nominal.telemetry, nominal.figures
    for control, diagnosed in product(CONTROL, (True, False)):
        flight = avoid(states, nominal.scenario, Avoidance(0, control, diagnosed, SHOWN))
        rows = flight.during(HAZARD_AVOIDANCE)
        t, error = flight.telemetry["t_s"][rows], flight.telemetry["control.error_roll_deg"][rows]
        roll.append(Curve(t - t[0], error, f"{control}, {'' if diagnosed else 'un'}diagnosed"))
    powered = (own["t_s"] > figures["backshell_s"]) & (own["t_s"] < figures["touchdown_s"])
    torque = [Curve(own["t_s"][powered], own[f"estimate.torque_{a}_nm"][powered], a) for a in "xyz"]
    panels = [Panel("Roll error", "time into hazard avoidance (s)", "error (deg)", roll)]
    panels.append(Panel("Estimated disturbance torque", "time (s)", "torque (N m)", torque))
    return {"fig7_fig11": panels}


TITLE = "Attitude control of Tianwen-1 from entry to touchdown"
STUDY = Study("hu2022", TITLE, "Hu et al. 2022", run, runs=100, quick_runs=6)
