"""The navigation filters that ``flight_software.navigation.filter`` may name.

A member has two kernels. ``start(params, onboard, sensed, solution, memory)`` runs once, when ground tracking
and star tracker have started the ``solution`` (``SOLUTION``). ``correct(params, onboard, health, sensed,
motion, solution, memory)`` runs in every base cycle after the solution was propagated by ``motion``
(``MOTION``), and corrects it by the star fix of ``motion`` and the radar of ``sensed`` (``SENSED``), as far
as ``health`` (``INSTRUMENT_HEALTH``) trusts it; it also writes the standard deviations and the refused beams
into ``solution``. ``params`` and ``memory`` belong to the member. ``reads`` names the fields of the sensed
record that a member needs.
"""

from __future__ import annotations

from typing import Any

from edl6dof.config.base import group
from edl6dof.fsw.navigation.derived import DragFilterParams
from edl6dof.fsw.navigation.exclusions import BeamWatchParams
from edl6dof.fsw.navigation.filters import (
    dead_reckoning,
    error_state,
    given,
    radar_in_loop,
    two_filter,
)
from edl6dof.fsw.navigation.integrity import GuardParams
from edl6dof.fsw.navigation.landmark_fix import LandmarkFixParams
from edl6dof.fsw.navigation.parity_test import ParityParams
from edl6dof.fsw.navigation.recovery import RecoveryParams
from edl6dof.fsw.navigation.redundancy import SaturationParams
from edl6dof.fsw.navigation.star_fixes import StarWatchParams
from edl6dof.fsw.navigation.wind_estimate import WindEstimateParams
from edl6dof.registry import Family

NAVIGATION_FILTERS = Family(
    "navigation filter",
    (given.MEMBER, dead_reckoning.MEMBER, error_state.MEMBER, two_filter.MEMBER, radar_in_loop.MEMBER),
)

#: Index of the member that copies ideal instruments.
GIVEN = NAVIGATION_FILTERS.names.index("given")

_Filters: Any = NAVIGATION_FILTERS.params_model("Filters", "filter", "given", "Navigation.")


class NavigationParams(_Filters):
    """Navigation: the filter, and the settings that all filters share."""

    parity: ParityParams = group(ParityParams, "fault detection of redundant gyros and accelerometers")
    beam_watch: BeamWatchParams = group(BeamWatchParams, "exclusion of beams of the radar")
    star_watch: StarWatchParams = group(StarWatchParams, "exclusion of star trackers")
    saturation: SaturationParams = group(SaturationParams, "treatment of saturated gyros")
    recovery: RecoveryParams = group(RecoveryParams, "recovery of the vertical after the attitude was lost")
    guards: GuardParams = group(GuardParams, "guards of height and vertical")
    landmarks: LandmarkFixParams = group(LandmarkFixParams, "position fixes from landmarks of a map")
    drag_filter: DragFilterParams = group(DragFilterParams, "fading memory of the measured drag")
    wind: WindEstimateParams = group(WindEstimateParams, "estimate of the wind")


start_filter = NAVIGATION_FILTERS.role(
    "start", "params", "onboard", "sensed", "solution", "memory", own=("params", "memory")
)
correct_solution = NAVIGATION_FILTERS.role(
    "correct",
    *("params", "onboard", "health", "sensed", "motion", "solution", "memory"),
    own=("params", "memory"),
)
