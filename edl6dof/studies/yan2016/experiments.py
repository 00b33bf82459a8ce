"""What is flown: both laws from all corners of a box of initial deviations, under the printed disturbance and
under one that the lift can cancel, with several gains.

The paper prints neither deviations nor gains nor exponent: those here are this software's, the same for both
laws.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from edl6dof.campaign.design.case import Case

LAWS = {"ftc_dob": "FTC+DOB", "pd_dob": "PD+DOB"}
ENTRY = "flight_software.guidance.entry"
#: Deviations of the initial state: path, nominal, half width of the box.
DEVIATIONS = (
    ("initial.altitude_m", 60e3, 500.0),
    ("initial.speed_m_s", 5700.0, 25.0),
    ("initial.flight_path_angle_deg", -14.0, 0.1),
)
CORNERS = tuple(product((1.0, -1.0), repeat=3))
#: k_1 = k_P (1/s2) and k_2 = k_D (1/s) of the comparison, and others that show how much it rests on them.
GAINS, OTHER_GAINS = (0.25, 0.8), ((0.1, 0.6), (0.5, 1.2), (1.0, 2.0))


@dataclass(frozen=True)
class Experiment:
    """A disturbance, amplitude in rad/s, and gains."""

    name: str
    amplitude_rad_s: float
    gains: tuple[float, float] = GAINS


PRINTED = Experiment("the printed disturbance, 0.01 sin(t) rad/s", 0.01)
WITHIN = Experiment("a disturbance within the authority, 0.002 sin(t) rad/s", 0.002)
UNDISTURBED = Experiment("no disturbance", 0.0)
OTHERS = tuple(
    Experiment(f"the printed disturbance, gains {error:g} and {rate:g}", 0.01, (error, rate))
    for error, rate in OTHER_GAINS
)
EXPERIMENTS = (PRINTED, WITHIN, UNDISTURBED, *OTHERS)


def cases() -> list[Case]:
    """The cases of all experiments, law by law, corner by corner."""
    return [case(number, *choice) for number, choice in enumerate(product(EXPERIMENTS, LAWS, CORNERS))]


def case(number: int, experiment: Experiment, law: str, signs: tuple[float, ...]) -> Case:
    """One law from one corner; the flight computer is told of neither deviation nor disturbance."""
    truth = {
        path: nominal + sign * width for (path, nominal, width), sign in zip(DEVIATIONS, signs, strict=True)
    }
    truth["point_mass.disturbance.amplitude_rad_s"] = experiment.amplitude_rad_s
    belief = {
        f"{ENTRY}.law": law,
        f"{ENTRY}.{law}.error_gain": experiment.gains[0],
        f"{ENTRY}.{law}.rate_gain": experiment.gains[1],
    }
    return Case(number, truth=truth, belief=belief, label={"law": law, "experiment": experiment.name})
