"""Figures of an event from designed flights."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from edl6dof.campaign.covariance.events import EventFigures
from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.plan import Plan
from edl6dof.campaign.executor import Progress, fly_rows
from edl6dof.config.document.overrides import with_values
from edl6dof.config.errors import refusal
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario


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
