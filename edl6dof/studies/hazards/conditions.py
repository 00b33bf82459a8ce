"""The ground, the ways to land on it, and the flights."""

from __future__ import annotations

from dataclasses import replace
from math import exp, inf, pi, sqrt

from scipy.integrate import quad

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import load_plan
from edl6dof.fsw.hazard.registry import HAZARD_DETECTION
from edl6dof.metrics.footing import COUNTED, FOOTPRINT
from edl6dof.scenario.loading import LoadedScenario, load_scenario

SCENARIO, DISPERSIONS = "tianwen1_hazards", "tianwen1_mc"
#: Share of the ground that rocks cover.
ABUNDANCES = (0.04, 0.1, 0.2)
#: Hazard detection; the first, which detects nothing, is blind.
WAYS = HAZARD_DETECTION.names
BLIND = WAYS[0]


def over(abundance: float, way: str) -> LoadedScenario:
    """The landing one way over ground with that many rocks."""
    return load_scenario(
        SCENARIO,
        [
            "simulation.log_every=5",
            "atmosphere.perturbation.enabled=true",
            "wind.gust.enabled=true",
            f"terrain.landing_area.rock_abundance={abundance:g}",
            f"flight_software.hazard.detection={way}",
        ],
    )


def cases(abundance: float, way: str, flights: int) -> list[Case]:
    """The first cases of the campaign; the number of a case is that of its ground, too."""
    label = {"abundance": abundance, "way": way}
    return [replace(one, label=label) for one in load_plan(DISPERSIONS).cases(0, flights)]


def blind_share(abundance: float) -> float:
    """Share of footprints with a rock that counts, of rocks that lie anywhere: 1 - exp(-N A).

    Golombek & Rapp, J. Geophys. Res. 102 (1997) 4117-4129: rocks of diameter D and more cover k exp(-q D) of
    the ground, q = 1.79 + 0.152 / k.
    """
    q = 1.79 + 0.152 / abundance

    def each(diameter: float) -> float:
        return 4.0 * q * abundance * exp(-q * diameter) / (pi * diameter**2)

    return 1.0 - exp(-quad(each, COUNTED, inf)[0] * pi * FOOTPRINT**2)


def standard_error(share: float, flights: int) -> float:
    """Of a share that is counted in so many flights."""
    return sqrt(share * (1.0 - share) / flights)
