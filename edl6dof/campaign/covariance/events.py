"""Events at which covariance is asked for, and the figures of merit that tell the state there."""

from __future__ import annotations

from typing import NamedTuple

from edl6dof.config.errors import refusal


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
