"""Events at which covariance is asked for, the figures of merit that tell the state there, and their values
from designed flights.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import Progress, fly_rows
from edl6dof.config.document.overrides import with_values
from edl6dof.config.errors import refusal
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario


class EventFigures(NamedTuple):
    """Figures of an event.

    Attributes:
        position: the two that span the ellipse, first along and then across, or east and north; none where
            the place is not told.
        others: more of the state.
    """

    position: tuple[str, ...]
    others: tuple[str, ...]

    @property
    def all(self) -> tuple[str, ...]:
        """Every figure."""
        return self.position + self.others


EVENTS = {
    "entry": EventFigures(
        (), ("peak_load_g0", "peak_dynamic_pressure_pa", "peak_heat_flux_w_cm2", "heat_load_j_cm2")
    ),
    "parachute": EventFigures(
        ("parachute_downrange_m", "parachute_crossrange_m"),
        (
            "parachute_altitude_m",
            "parachute_speed_m_s",
            "parachute_mach",
            "parachute_dynamic_pressure_pa",
            "parachute_s",
        ),
    ),
    "trim_wing": EventFigures((), ("trim_wing_s", "trim_wing_mach")),
    "backshell": EventFigures((), ("backshell_height_m", "backshell_speed_m_s", "backshell_s")),
    "touchdown": EventFigures(
        ("landing_east_m", "landing_north_m"), ("touchdown_s", "touchdown_vertical_m_s", "propellant_used_kg")
    ),
}


def figures_at(event: str) -> EventFigures:
    """Figures of an event.

    Raises:
        ConfigError: there is no such event.
    """
    if event not in EVENTS:
        raise refusal("--at", f"must be {', '.join(EVENTS)} (got {event!r})")
    return EVENTS[event]


def figures_of(
    plan: Plan,
    cases: Iterable[Case],
    event: EventFigures,
    workers: int | None = None,
    progress: Progress | None = None,
) -> np.ndarray:
    """Figures of all flights, shape (flights, figures).

    Raises:
        ConfigError: a flight does not come to the event.
    """
    rows = list(fly_rows(plan.loaded, cases, workers=workers, progress=progress))
    values = np.array([[row.get(name, np.nan) for name in event.all] for row in rows], dtype=float)
    if (short := ~np.isfinite(values).all(axis=1)).any():
        outcome = rows[int(np.argmax(short))]["outcome"]
        raise refusal(
            plan.name, f"{short.sum()} of {len(rows)} flights do not come to the event; one: {outcome}"
        )
    return values


def ending_at_deployment(plan: Plan) -> Plan:
    """The same flights, ended when the parachute is deployed."""
    document = with_values(plan.loaded.document, {"mission.goal": "deployment"}, Scenario)
    return replace(plan, loaded=check_document(document))
