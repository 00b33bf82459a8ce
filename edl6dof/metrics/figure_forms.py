"""Forms that compute figures of a flight from its telemetry and the times of its events.

A form is called with a :class:`Flown` and returns the figure in the unit of its channels, or ``None`` if the
flight did not reach it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from edl6dof.interface.roles import LIFT, TRIM, span

if TYPE_CHECKING:
    from edl6dof.telemetry.columns import Telemetry  # whose kernels a report need not load

#: Last seconds of the trim phase, in which its limit cycle is looked at.
LIMIT_CYCLE_S = 30.0


class Flown(NamedTuple):
    """A flight: telemetry, time (s) of its events by key, and role of each phase."""

    telemetry: Telemetry
    when: Mapping[str, float]
    roles: Sequence[str]


Form = Callable[[Flown], float | None]


def at(event: str) -> Form:
    """Time of an event."""
    return lambda flown: flown.when.get(event)


def between(since: str, *until: str) -> Form:
    """Time from one event to the first of others."""

    def form(flown: Flown) -> float | None:
        ends = [flown.when[event] for event in until if event in flown.when]
        return min(ends) - flown.when[since] if ends and since in flown.when else None

    return form


def value(event: str, *channels: str, added: bool = False, before: bool = False) -> Form:
    """A channel at an event; of several the length of their vector, or the sum of two (``added``).

    ``before``: in the row before it: an estimate is a reading old, and has not seen how contact shakes the
    vehicle.
    """

    def form(flown: Flown) -> float | None:
        t, telemetry = flown.when.get(event), flown.telemetry
        if t is None:
            return None
        t = float(telemetry.beside(t)["t_s"][0]) if before else t
        if len(channels) > 1 and not added:
            return telemetry.length_at(t, *channels)
        first, *others = telemetry.at(t, *channels)
        return first + others[0] if added else first

    return form


class Part(NamedTuple):
    """Rows of a flight: those of the phases of a role, ``after_s`` or more (``later``: more) seconds after an
    event, and before another.  Events by their milestones, and ``touchdown``; without them the part begins
    and ends with the phases or the flight.  There is none unless the event ``needs`` has come.
    """

    role: str = ""
    since: str = ""
    after_s: float = 0.0
    later: bool = False
    until: str = ""
    needs: str = ""

    def rows(self, flown: Flown) -> Telemetry:
        """These rows."""
        telemetry, when, _ = flown
        if self.needs and self.needs not in when:
            return telemetry.rows(0, 0)
        if self.role:
            telemetry = telemetry.rows(*role_rows(flown, self.role))
        times = telemetry["t_s"]
        first = 0
        if self.since:
            side: Literal["left", "right"] = "right" if self.later else "left"
            first = int(np.searchsorted(times, when.get(self.since, inf) + self.after_s, side=side))
        last = int(np.searchsorted(times, when.get(self.until, inf))) if self.until else None
        return telemetry.rows(first, last)


def largest(part: Part, *columns: str) -> Form:
    """Largest magnitude of some columns."""
    return _over(part, lambda rows: rows.largest(*columns))


def longest(part: Part, *columns: str) -> Form:
    """Largest length of the vector of some columns."""
    return _over(part, lambda rows: rows.longest(*columns))


def nearest(part: Part, place: Sequence[str], other: Sequence[str]) -> Form:
    """Return the smallest distance between two positions."""
    return _over(part, lambda rows: rows.nearest(place, other))


def _over(part: Part, extreme: Callable[[Telemetry], float]) -> Form:
    """An extreme over some rows; none of no rows."""

    def form(flown: Flown) -> float | None:
        rows = part.rows(flown)
        return extreme(rows) if len(rows["t_s"]) else None

    return form


def swing(parts: Sequence[Part], rate: str, roll: str, angle: str) -> Form:
    """Largest magnitude of a rate without its part that is banking, in the lift phases alone."""

    def form(flown: Flown) -> float | None:
        found = [part.rows(flown).fastest_swing(rate, roll, angle) for part in parts]
        return float(np.fmax(*found)) if len(Part(LIFT).rows(flown)["t_s"]) else None

    return form


def role_rows(flown: Flown, role: str) -> tuple[int, int]:
    """First row of the phases of a role, none of which comes twice, and the row after their last."""
    first, end = np.searchsorted(flown.telemetry["guide.phase"], span(flown.roles, role)).tolist()
    return first, end


def _trim(flown: Flown) -> Telemetry | None:
    """The trim phase; ``None`` of a flight that did not come through it."""
    first, last = role_rows(flown, TRIM)
    whole = last - first > 1 and last < len(flown.telemetry["t_s"])
    return flown.telemetry.rows(first, last) if whole else None


def limit_cycle(flown: Flown) -> float | None:
    """Largest attitude error at the end of the trim phase; S1 asks for a deadband below 5 deg."""
    if (phase := _trim(flown)) is None:
        return None
    times = phase["t_s"]
    late = phase.rows(int(np.searchsorted(times, times[-1] - LIMIT_CYCLE_S, side="right")), None)
    return late.largest(*(f"control.error_{axis}_deg" for axis in ("roll", "pitch", "yaw")))


def trim_propellant(flown: Flown) -> float | None:
    """Propellant used in the trim phase."""
    return None if (phase := _trim(flown)) is None else propellant(Flown(phase, flown.when, flown.roles))


def propellant(flown: Flown) -> float:
    """Propellant used."""
    left = flown.telemetry["truth.propellant_kg"]
    return float(left[0] - left[-1])


def _bank(flown: Flown) -> tuple[np.ndarray, int]:
    """Commanded bank of the lift phases with the row before them, and how many rows before there are."""
    first, last = role_rows(flown, LIFT)
    before = min(first, 1)
    rows = flown.telemetry.rows(first - before, last)
    return rows["guide.bank_deg"] if last > first else np.empty(0), before


def bank_reversals(flown: Flown) -> float | None:
    """Return the number of sign changes of the commanded bank angle."""
    bank, _ = _bank(flown)
    return float(np.count_nonzero(bank[1:] * bank[:-1] < 0.0)) if len(bank) else None


def bank_zero(flown: Flown) -> float | None:
    """Time at which bank is first commanded to zero."""
    bank, before = _bank(flown)
    rows = np.flatnonzero(bank[before:] == 0.0)
    return float(Part(LIFT).rows(flown)["t_s"][rows[0]]) if len(rows) else None
