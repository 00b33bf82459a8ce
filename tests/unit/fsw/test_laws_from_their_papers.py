"""Every entry law's ``guide`` on a sequence of states, against plain Python written from its source.

Exponential air without wind and a constant drag area, as in the papers.  Corrections of the prints and
sampled forms of the observers are those that the files of the laws list.
"""

from math import acos, cos, exp, log, sin, sqrt

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from edl6dof.fsw.guidance.entry.airframe import mach_nodes
from edl6dof.fsw.guidance.entry.drag_dynamics import uncertain_drag
from edl6dof.fsw.guidance.entry.drag_energy import SHARE
from edl6dof.fsw.guidance.entry.drag_velocity import ceiling, profile_drag
from edl6dof.fsw.guidance.entry.predictor import in_plane_shifted, linear, predict
from edl6dof.fsw.guidance.entry.reference import reference_bank
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.scenario.planned_entry import planned_states

DT, SCALE_HEIGHT = 0.3, 9354.0
TOLERANCE = 1e-9
#: Nodes of the reference that the made-up states pass, near the peak of drag; a flight takes DT for each.
PASSED = (170, 169, 168, 167, 166, 165, 164)


class Law:
    """A law with its memory, on a copy of the belief."""

    def __init__(self, name, onboard, planned_rows):
        self.member, self.record = ENTRY_LAWS.member(name), onboard[0]
        if self.member.plan is not None:
            self.member.plan(onboard, planned_rows)
        air = self.record["atmosphere"]
        heights = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
        air["ln_density"], air["wind_north"], air["wind_east"] = (
            log(0.0158) - heights / SCALE_HEIGHT,
            0.0,
            0.0,
        )
        self.record["vehicle"]["airframe"]["drag"] = 1.0
        self.entry = self.record["guidance"]["entry"]
        self.entry["tracking"]["update"] = 0
        self.params, self.plan = self.entry[name], self.record["plan"][name]
        self.memory, self.out = np.zeros(1, self.member.memory)[0], np.zeros(1, GUIDE)[0]
        self.out["drag_ratio"], self.out["lift_ratio"] = 1.03, 0.9

    def __call__(self, nav):
        guide = self.member.kernels["guide"]
        return guide(self.params, self.plan, self.record, nav, self.memory, self.out)


@pytest.fixture
def law(onboard, planned_rows):
    return lambda name: Law(name, onboard, planned_rows)


def states(record):
    """Made-up states near the reference: energies at nodes of its table, drag and drag rate beside it."""
    reference = record["reference"]
    record["vehicle"]["lift_to_drag"] = 3.0  # so that few commands saturate
    navs = np.zeros(len(PASSED), NAV)
    for k, (nav, i) in enumerate(zip(navs, PASSED, strict=True)):
        u = reference["first"] + i * reference["spacing"]
        nav["t"], nav["energy"], nav["speed"] = 100.0 + DT * k, 0.5 * u * u, 0.99 * u
        nav["altitude"], nav["mach"] = 10e3 + 40.0 * i, 0.99 * u / 230.0
        nav["radius"] = record["planet"]["equatorial_radius"] + nav["altitude"]
        nav["gravity"] = record["planet"]["mu"] / nav["radius"] ** 2
        nav["drag"] = (1.005 + 2e-4 * k) * reference["drag"][i]
        rate = reference["drag_rate"][i] + 0.01 * (-1.0) ** k
        d, v, g = nav["drag"], nav["speed"], nav["gravity"]
        sine = -(rate / d + 2.0 * d / v) / (v / SCALE_HEIGHT + 2.0 * g / v)
        nav["flight_path_angle"], nav["bank"] = np.arcsin(sine), 0.8 + 0.1 * k
        nav["v_N"] = v * sqrt(1.0 - sine * sine), 0.0, -v * sine
    return navs


def lift_to_drag(record, nav):
    table = record["vehicle"]["airframe"]["lift"]
    return record["vehicle"]["lift_to_drag"] * np.interp(log(nav["mach"]), np.log(mach_nodes()), table)


def drag_terms(nav, ratio):
    """D', and a and b of D'' = a + b u: Zheng & Cui 2015, eqs. 13-14; Yan, Sun & Guo 2016, eqs. 13-14."""
    d, v, r, g, gamma = (float(nav[x]) for x in ("drag", "speed", "radius", "gravity", "flight_path_angle"))
    h, s, c = SCALE_HEIGHT, sin(gamma), cos(gamma)
    slowing, turning = d + g * s, g - v * v / r
    rate = -d * v * s / h - 2.0 * d * slowing / v
    a = -rate * v * s / h + d * slowing * s / h + d * c * c * turning / h - 2.0 * d * slowing**2 / v**2
    a += -2.0 * d * rate / v - 2.0 * rate * slowing / v + 4.0 * d * g * s * s / r
    a += 2.0 * d * g * c * c * turning / v**2
    return rate, a, -d * d * ratio * c * (2.0 * g / v**2 + 1.0 / h)


def energy_rates(nav, drag, drag_rate):
    """E' = -V D (Wu, Cui & Cui 2013, eq. 10) and E''."""
    speed_rate = -drag - nav["gravity"] * sin(nav["flight_path_angle"])
    return -nav["speed"] * drag, -speed_rate * drag - nav["speed"] * drag_rate


def followed(record, nav, i, scale, drag_rate):
    """Drag of node ``i`` of the reference times 1 + scale f(E) and its rates: Wu, Cui & Cui 2013, eq. 15."""
    reference = record["reference"]
    d, d1, d2 = (float(reference[x][i]) for x in ("drag", "drag_rate", "drag_acceleration"))
    top = reference["first"] + (len(reference["drag"]) - 1) * reference["spacing"]
    span = 0.5 * (top**2 - reference["first"] ** 2)
    off = (nav["energy"] - 0.5 * reference["first"] ** 2) / span - 0.5
    f0, f1 = 1.0 + scale * 2.0 * (1.0 - sqrt(2.0) * off**2), scale * -4.0 * sqrt(2.0) * off / span
    f2 = scale * -4.0 * sqrt(2.0) / span**2
    e1, e2 = energy_rates(nav, d, d1)
    by_e, by_ee = d1 / e1, (d2 - d1 / e1 * e2) / e1**2
    slope, bend = by_e * f0 + d * f1, by_ee * f0 + 2.0 * by_e * f1 + d * f2
    e1, e2 = energy_rates(nav, nav["drag"], drag_rate)
    return d * f0, slope * e1, bend * e1**2 + slope * e2


def is_within_reach(cosines):
    """Most of the states ask for less than all lift, so that a gain shows."""
    return np.count_nonzero(np.abs(cosines) < 1.0) >= len(PASSED) - 2


# ---- drag tracking -----------------------------------------------------------------------------------------


def test_drag_tracking_is_eq_19_with_frequency_and_damping(law):
    """Wu, Cui & Cui 2013, eqs. 12, 15, 16 and 19; measured lift."""
    flown, found = law("drag_tracking"), []
    flown.memory["tracking"]["scale"] = 0.05
    for nav, i in zip(states(flown.record), PASSED, strict=True):
        rate, a, b = drag_terms(nav, 0.9 * lift_to_drag(flown.record, nav))
        goal, goal_rate, goal_acceleration = followed(flown.record, nav, i, 0.05, rate)
        omega, zeta = flown.params["frequency"], flown.params["damping"]
        wanted = goal_acceleration + 2.0 * zeta * omega * (goal_rate - rate) + omega**2 * (goal - nav["drag"])
        found.append((wanted - a) / b)
        assert cos(flown(nav)) == pytest.approx(np.clip(found[-1], -1.0, 1.0), abs=TOLERANCE)
    assert is_within_reach(found)


def polynomial_goal(record, nav, start, drag, drag_rate):
    """Wu, Cui & Cui 2013, eqs. 10 and 13: the reference as a polynomial of the energy left at ``start``."""
    reference = record["reference"]
    terminal = 0.5 * reference["handover"] ** 2
    span, nodes = start - terminal, reference["first"] + reference["spacing"] * np.arange(256)
    samples = np.interp(np.sqrt(2.0 * (terminal + span * SHARE)), nodes, reference["drag"])
    fit = np.polynomial.Polynomial.fit(SHARE, samples, 6, domain=[0, 1], window=[0, 1])
    x = min(max((nav["energy"] - terminal) / span, 0.0), 1.0)
    e1, e2 = (rate / span for rate in energy_rates(nav, drag, drag_rate))
    return fit(x), fit.deriv()(x) * e1, fit.deriv(2)(x) * e1**2 + fit.deriv()(x) * e2


def test_fl_is_eq_19_along_the_polynomial(law):
    """Wu, Cui & Cui 2013, eqs. 12, 13, 16 and 19."""
    flown, found = law("fl"), []
    navs = states(flown.record)
    for nav in navs:
        rate, a, b = drag_terms(nav, lift_to_drag(flown.record, nav))
        goal, first, second = polynomial_goal(
            flown.record, nav, float(navs["energy"][0]), float(nav["drag"]), rate
        )
        k_error, k_rate = flown.params["error_gain"], flown.params["rate_gain"]
        found.append((second + k_rate * (first - rate) + k_error * (goal - nav["drag"]) - a) / b)
        assert cos(flown(nav)) == pytest.approx(np.clip(found[-1], -1.0, 1.0), abs=TOLERANCE)
    assert is_within_reach(found)


def test_ehgo_fl_is_eq_23_with_the_sampled_observer(law):
    """Wu, Cui & Cui 2013, eqs. 20, 21 and 23: poles of the observer at -1, -2 and -3 over epsilon."""
    flown, found, estimate, before = law("ehgo_fl"), [], None, (0.0, 0.0)
    flown.params["start_share"] = 0.98
    p, navs = flown.params, states(flown.record)
    chain = np.array([[1.0, DT, 0.5 * DT * DT], [0.0, 1.0, DT], [0.0, 0.0, 1.0]])
    seen = [chain[0], chain[0] @ chain, chain[0] @ chain @ chain]
    wanted = np.poly([exp(-n * DT / p["epsilon"]) for n in (1, 2, 3)])
    at_chain = sum(c * np.linalg.matrix_power(chain, 3 - n) for n, c in enumerate(wanted))
    gain = at_chain @ np.linalg.solve(seen, [0.0, 0.0, 1.0])
    for nav in navs:
        _, a, b = drag_terms(nav, lift_to_drag(flown.record, nav))
        if estimate is None:
            estimate = np.array([0.98 * nav["drag"], 0.0, 0.0])
        else:
            model = 0.5 * (before[0] + a + (before[1] + b) * cos(nav["bank"]))
            estimate = chain @ estimate + model * np.array([0.5 * DT * DT, DT, 0.0])
            estimate += gain * (nav["drag"] - estimate[0])
        before = a, b
        drag, rate, phi = estimate
        goal, first, second = polynomial_goal(flown.record, nav, float(navs["energy"][0]), drag, rate)
        cancelled = np.clip(phi, p["share"] * b, -p["share"] * b)
        command = second + p["rate_gain"] * (first - rate) + p["error_gain"] * (goal - drag)
        found.append((command - a - cancelled) / b)
        assert cos(flown(nav)) == pytest.approx(np.clip(found[-1], -1.0, 1.0), abs=TOLERANCE)
    assert np.count_nonzero(np.abs(found) < 1.0) >= 2


class PathObserver:
    """Yan, Sun & Guo 2016, eqs. 16-17, sampled: the error of a constant disturbance falls by exp(-l dt)."""

    def __init__(self, gain):
        self.estimate, self.share, self.last = 0.0, 1.0 - exp(-gain * DT), None

    def __call__(self, nav, lift):
        gamma, v = float(nav["flight_path_angle"]), float(nav["speed"])
        parts = lift / v, -(nav["gravity"] - v * v / nav["radius"]) * cos(gamma) / v
        if self.last is not None:
            mean = [0.5 * (now + then) for now, then in zip(parts, self.last[1], strict=True)]
            turned = (gamma - self.last[0]) / DT - mean[0] * cos(nav["bank"]) - mean[1]
            self.estimate += self.share * (turned - self.estimate)
        self.last = gamma, parts
        return self.estimate


@pytest.mark.parametrize("name", ["pd_dob", "ftc_dob"])
def test_disturbance_observer_laws_are_eq_22(law, name):
    """Yan, Sun & Guo 2016, eqs. 14, 19, 20 and 22; section 3 for PD+DOB, whose powers are one."""
    flown, found = law(name), []
    flown.memory["tracking"]["scale"] = 0.05
    # slow, since the path angle jumps from state to state
    flown.params["observer"]["gain"] = 1e-3
    p, observe = flown.params, PathObserver(1e-3)
    alpha = float(p["exponent"]) if name == "ftc_dob" else 1.0
    for nav, i in zip(states(flown.record), PASSED, strict=True):
        ratio = float(flown.record["vehicle"]["lift_to_drag"])
        rate, a, b = drag_terms(nav, ratio)
        goal, goal_rate, goal_acceleration = followed(flown.record, nav, i, 0.05, rate)
        x1, x2 = nav["drag"] - goal, rate - goal_rate
        f = b * nav["speed"] / (nav["drag"] * ratio)
        feedback = p["error_gain"] * np.sign(x1) * abs(x1) ** alpha
        feedback += p["rate_gain"] * np.sign(x2) * abs(x2) ** (2.0 * alpha / (1.0 + alpha))
        disturbance = observe(nav, nav["drag"] * ratio)
        found.append((-feedback - a - f * disturbance + goal_acceleration) / b)
        assert cos(flown(nav)) == pytest.approx(np.clip(found[-1], -1.0, 1.0), abs=TOLERANCE)
        assert flown.out["path_disturbance"] == pytest.approx(disturbance, abs=1e-12)
    assert is_within_reach(found) and disturbance != 0.0


def test_dob_sliding_is_eq_29(law):
    """Zheng & Cui 2015, eqs. 19, 23 and 25-29 between samples; c_0 from eq. 42, filter of Fig. 1."""
    flown, found = law("dob_sliding"), []
    flown.memory["tracking"]["scale"] = 0.05
    p, zeta, eta, disturbance, before = flown.params, 0.0, 0.0, 0.0, None
    for nav, i in zip(states(flown.record), PASSED, strict=True):
        rate, _, b = drag_terms(nav, float(flown.record["vehicle"]["lift_to_drag"]))
        goal, goal_rate, goal_acceleration = followed(flown.record, nav, i, 0.05, rate)
        e, e_rate = nav["drag"] - goal, rate - goal_rate
        if before is not None:
            last_s, last_v, last_feedback, last_b, decay = before
            kept = exp(-decay * DT)
            zeta = kept * zeta + (1.0 - kept) / decay * last_b * (cos(nav["bank"]) - last_v)
        s = e_rate + p["error_gain"] * e - zeta
        if before is not None:
            seen = (s - last_s) / DT - last_feedback
            disturbance += (1.0 - exp(-DT / p["filter_time"])) * (seen - disturbance)
            eta += p["adaptation"] * abs(s) * DT
        decay = p["virtual_gain"] + 0.25 * b * b
        feedback = -disturbance - p["surface_gain"] * s - 2.0 * eta * s / (abs(s) + p["boundary"])
        v = (goal_acceleration - p["error_gain"] * e_rate - decay * zeta + feedback) / b
        before = s, v, feedback, b, decay
        found.append(v)
        assert cos(flown(nav)) == pytest.approx(np.clip(v, -1.0, 1.0), abs=TOLERANCE)
    assert np.count_nonzero(np.abs(found) < 1.0) >= 3


def test_adaptive_hinf_is_eqs_12_to_20(law):
    """Lu & Bayard, eqs. 12, 16 and 20, sections 3.3 and 3.4: u is linear in the reference acceleration."""
    flown, found = law("adaptive_hinf"), []
    p, profile, radius = flown.params, flown.plan, float(flown.record["planet"]["equatorial_radius"])
    gain, rho = float(p["disturbance_gain"]), float(p["control_weight"])
    a, b, c = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
    riccati = solve_continuous_are(a, np.hstack([b, b]), c.T @ c, np.diag([-(gain**2), rho]))
    r, c2, sine = p["coefficient_rate_limit"], p["coefficient_acceleration_limit"], sin(p["path_limit"])
    low = np.array([-r, -c2, 0.0, 0.0, 0.0])
    high = np.array([r, c2, sine**2, 1.0 - cos(p["path_limit"]), sine**2])
    theta, since = 0.5 * (low + high), 0.0
    for nav in states(flown.record):
        ratio, v, g = lift_to_drag(flown.record, nav), float(nav["speed"]), float(nav["gravity"])
        gamma, drag, (rate, _, _) = (
            float(nav["flight_path_angle"]),
            float(nav["drag"]),
            drag_terms(nav, ratio),
        )
        goal, slope, bend = profile_drag(profile, v)
        share = min(1.0, ceiling(flown.record, v) / goal)
        goal, slope, bend = share * goal, share * slope, share * bend
        v1 = -drag - g * sin(gamma)
        z = np.array([drag - goal, rate - slope * v1])
        surface = float(flown.record["planet"]["mu"]) / radius**2
        g0, g1, g2 = uncertain_drag(drag, rate, v, surface, radius, SCALE_HEIGHT)
        regressor = np.array([*g1[:3], g2 * ratio * cos(nav["bank"]), g1[4]])
        step = 5.0 * (high - low) ** 2 / p["adaptation_energy"] * regressor * (riccati @ z)[1]
        theta, since = np.clip(theta - since * step, low, high), DT

        less = []  # D'' of the model less the wanted one, at u = 0 and 1
        for u in (0.0, 1.0):
            turn = drag * u / v + (v / nav["radius"] - g / v) * cos(gamma)
            v2 = -rate - g * cos(gamma) * turn + 2.0 * g * v * sin(gamma) ** 2 / nav["radius"]
            model = -g0 - np.dot([*g1[:3], g2 * u, g1[4]], theta) + g2 * u
            less.append(model - slope * v2 - bend * v1 * v1 + 0.5 / rho * (riccati @ z)[1])
        u = less[0] / (less[0] - less[1])
        found.append(u / ratio)
        assert cos(flown(nav)) == pytest.approx(np.clip(found[-1], -1.0, 1.0), abs=TOLERANCE)
        assert flown.memory["theta"] == pytest.approx(theta, abs=1e-12)
    assert np.count_nonzero(np.abs(found) < 1.0) >= 3


# ---- terminal point control, and open loop -----------------------------------------------------------------


def test_etpc_changes_the_lift_by_the_predicted_miss(law):
    """Carman, Ives & Geller 1998: range by the influence coefficients, overcontrol; at nodes of the plan."""
    flown = law("etpc")
    table, p = flown.plan, flown.params
    for k, error in zip((50, 40, 30, 20), (0.02, -0.01, 0.015, -0.02), strict=True):
        nav = states(flown.record)[0]
        nav["speed"] = table["first"] + k * table["spacing"]
        nav["drag"], nav["mach"] = (1.0 + error) * table["drag"][k], nav["speed"] / 230.0
        nav["flight_path_angle"] = np.arcsin((table["climb"][k] + 3.0) / nav["speed"])
        flown.out["range_to_go"] = table["range"][k] + 500.0
        predicted = (
            table["range"][k] + table["by_drag"][k] * error * table["drag"][k] + 3.0 * table["by_climb"][k]
        )
        wanted = (
            table["lift"][k]
            + p["overcontrol"] * (table["range"][k] + 500.0 - predicted) / table["by_lift"][k]
        )
        cosine = wanted / (0.9 * lift_to_drag(flown.record, nav))
        assert cos(flown(nav)) == pytest.approx(np.clip(cosine, -1.0, 1.0), abs=1e-8)
        assert abs(cosine) < 1.0


def test_constant_bank_is_the_parameter(law):
    """``bank_profile`` is tested in test_open_loop_and_prediction.py."""
    flown = law("constant_bank")
    flown.params["bank"] = 0.7
    assert [flown(nav) for nav in states(flown.record)] == [0.7] * len(PASSED)


# ---- predictor-correctors ----------------------------------------------------------------------------------


def on_the_plan(flown, scenario, *shares):
    """States at these shares of the plan, whose aim point is a little nearer than planned."""
    navs, guides = planned_states(np.array([flown.record]), scenario)
    flown.record["site"]["aim_latitude"] += 3e-3
    for share in shares:
        k = int(share * len(navs))
        for name in ("crossrange", "range_to_go", "least_bank"):
            flown.out[name] = guides[name][k]
        yield navs[k]


def test_npc_is_newtons_method_on_the_predicted_range(law, scenario):
    """Lu 2014, section IV: one parameter, slope by a difference, until the miss is within the tolerance."""
    flown = law("npc")
    record, entry, p = flown.record, flown.entry, flown.params
    shift, turns = float(record["reference"]["shift"]), flown.plan["turn"]
    flown.out["side"] = 1.0

    def miss(nav, x):
        return predict(record, nav, flown.out, in_plane_shifted(x, turns[0], turns[1]))[0]

    for nav in on_the_plan(flown, scenario, 0.25, 0.3, 0.4):
        own = cos(reference_bank(record, 0.0, nav["speed"]))
        low, high = cos(entry["bank_max"]) - own, cos(entry["bank_min"]) - own
        shift, steps = min(max(shift, low), high), 0
        while abs(miss(nav, shift)) > p["tolerance"] and steps < p["iterations"]:
            slope = (miss(nav, shift + 0.02) - miss(nav, shift)) / 0.02
            shift, steps = min(max(shift - miss(nav, shift) / slope, low), high), steps + 1
        assert flown(nav) == pytest.approx(acos(own + shift), abs=TOLERANCE)
        assert flown.memory["shift"] == pytest.approx(shift, abs=TOLERANCE)
    assert steps < p["iterations"] and shift != record["reference"]["shift"]


def test_fnpeg_is_one_halved_gauss_newton_step_for_bank_and_one_for_the_reversal(law, scenario):
    """Lu 2014, section IV.A-B; Smith 2016: from the first drag on, and not before."""
    flown = law("fnpeg")
    record, entry, p = flown.record, flown.entry, flown.params
    p["stretch"], p["start_drag"], slowest = 0, 2.0, float(entry["align_speed"])
    most = entry["bank_max"] + max(entry["bank_max"] - p["last_bank"], 0.0)
    flown.out["bank"], first = 0.9, True

    def ends(nav, bank, turn):
        now = min(bank, entry["bank_max"])
        last = p["last_bank"] + (bank - now)
        return predict(record, nav, flown.out, linear(now, last, nav["speed"], 1.0, turn, later))[:2]

    for nav in on_the_plan(flown, scenario, 0.12, 0.2, 0.25, 0.3):
        if first:  # on the side of the commanded bank, reversals at a fixed ratio of speeds
            bank, turn, first = abs(float(nav["bank"])), float(p["spacing"] * nav["speed"]), False
            later = p["spacing"] * turn
            early = nav["drag"] < p["start_drag"]
            assert early

        if nav["drag"] >= p["start_drag"]:
            miss = ends(nav, bank, turn)
            slope = (ends(nav, bank + 0.02, turn)[0] - miss[0]) / 0.02
            way = min(max(-miss[0] / slope, -0.5), 0.5)
            for half in (1.0, 0.5, 0.25, 0.125):
                trial = min(max(bank + half * way, entry["bank_min"]), most)
                if abs(miss[0]) > p["tolerance"] and abs(ends(nav, trial, turn)[0]) < abs(miss[0]):
                    bank, miss = trial, ends(nav, trial, turn)
                    break
            slope = (ends(nav, bank, turn + 20.0)[1] - miss[1]) / 20.0
            way = min(max(-miss[1] / slope, -500.0), 500.0) if slope < 0.0 else 0.0
            for half in (1.0, 0.5, 0.25, 0.125):
                trial = min(max(turn + half * way, later, slowest), nav["speed"])
                if abs(miss[1]) > p["tolerance"] and abs(ends(nav, bank, trial)[1]) < abs(miss[1]):
                    turn = trial
                    break
        assert flown(nav) == pytest.approx(
            min(max(bank, entry["bank_min"]), entry["bank_max"]), abs=TOLERANCE
        )
        assert (flown.memory["bank"], flown.memory["turn"]) == pytest.approx((bank, turn), abs=1e-7)
    assert turn < nav["speed"] and bank != abs(float(nav["bank"]))
