"""The figures of merit of a flight, declared once: name with unit suffix, meaning, source, the form that
computes it from telemetry and events, and the limit that bounds it.

From this table follow the figures of telemetry, the limits, the names of published values, and the labels of
reports and campaigns.  A form is called with a :class:`Flown` and returns the figure in the unit of its
channels, or ``None`` if the flight did not reach it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from edl6dof.config.units import Unit, split_unit
from edl6dof.interface.roles import HOVER_IMAGING, LIFT, PARACHUTE, TRIM, begun, span
from edl6dof.telemetry.reversals import reversal_rows

if TYPE_CHECKING:
    from edl6dof.telemetry.columns import Telemetry  # a report need not load its kernels

#: Last seconds of the trim phase, in which its limit cycle is measured.
LIMIT_CYCLE_S = 30.0


class Flown(NamedTuple):
    """A flight: telemetry, time (s) of its events by key, and role of each phase."""

    telemetry: Telemetry
    when: Mapping[str, float]
    roles: Sequence[str]


Form = Callable[[Flown], float | None]


def at(event: str) -> Form:
    """Return the form of a figure that is the time (s) of an event."""
    return lambda flown: flown.when.get(event)


def between(since: str, *until: str) -> Form:
    """Return the form of a figure that is the time (s) from one event to the first of others."""

    def form(flown: Flown) -> float | None:
        ends = [flown.when[event] for event in until if event in flown.when]
        return min(ends) - flown.when[since] if ends and since in flown.when else None

    return form


def value(event: str, *channels: str, added: bool = False, before: bool = False) -> Form:
    """Return the form of a figure that is a channel at an event; of several channels the length of their
    vector, or the sum of two (``added``).

    ``before``: take the row before the event, in which the estimate contains no shock of the contact.
    """

    def form(flown: Flown) -> float | None:
        t, telemetry = flown.when.get(event), flown.telemetry
        if t is None:
            return None
        t = float(telemetry.around(t)["t_s"][0]) if before else t
        if len(channels) > 1 and not added:
            return telemetry.length_at(t, *channels)
        first, *others = telemetry.at(t, *channels)
        return first + others[0] if added else first

    return form


class Part(NamedTuple):
    """Rows of a flight: those of the phases of a role, from ``after_s`` seconds after the event ``since``
    (``later``: without a row at exactly that time) until the event ``until``.  Events are named by
    milestones.  The default is the whole flight; without the event ``needs`` there are no rows.
    """

    role: str = ""
    since: str = ""
    after_s: float = 0.0
    later: bool = False
    until: str = ""
    needs: str = ""

    def rows(self, flown: Flown) -> Telemetry:
        """Return the telemetry of these rows."""
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


def over(part: Part, extreme: Literal["largest", "longest", "nearest"], *channels: Any) -> Form:
    """Return the form of an extreme of channels over rows; ``extreme``: method of
    :class:`edl6dof.telemetry.columns.Telemetry`.
    """

    def form(flown: Flown) -> float | None:
        rows = part.rows(flown)
        return getattr(rows, extreme)(*channels) if len(rows["t_s"]) else None

    return form


def swing(parts: Sequence[Part], rate: str, roll: str, angle: str) -> Form:
    """Return the form of the largest body rate (magnitude) without the part due to banking, in lift."""

    def form(flown: Flown) -> float | None:
        found = [part.rows(flown).fastest_swing(rate, roll, angle) for part in parts]
        return float(np.fmax(*found)) if len(Part(LIFT).rows(flown)["t_s"]) else None

    return form


def role_rows(flown: Flown, role: str) -> tuple[int, int]:
    """First row of the phases of a role, and the row after their last."""
    first, end = np.searchsorted(flown.telemetry["guide.phase"], span(flown.roles, role)).tolist()
    return first, end


def _trim(flown: Flown) -> Telemetry | None:
    """Rows of the trim phase; ``None`` if the flight did not complete it."""
    first, last = role_rows(flown, TRIM)
    whole = last - first > 1 and last < len(flown.telemetry["t_s"])
    return flown.telemetry.rows(first, last) if whole else None


def limit_cycle(flown: Flown) -> float | None:
    """Largest attitude error (deg) at the end of the trim phase; S1 requires a deadband below 5 deg."""
    if (phase := _trim(flown)) is None:
        return None
    times = phase["t_s"]
    late = phase.rows(int(np.searchsorted(times, times[-1] - LIMIT_CYCLE_S, side="right")), None)
    return late.largest(*(f"control.error_{axis}_deg" for axis in ("roll", "pitch", "yaw")))


def trim_propellant(flown: Flown) -> float | None:
    """Propellant (kg) used in the trim phase."""
    return None if (phase := _trim(flown)) is None else propellant(Flown(phase, flown.when, flown.roles))


def propellant(flown: Flown) -> float:
    """Propellant used."""
    left = flown.telemetry["truth.propellant_kg"]
    return float(left[0] - left[-1])


def _bank(flown: Flown) -> tuple[np.ndarray, int]:
    """Commanded bank of the lift phases with the row before them, and the number of rows before."""
    first, last = role_rows(flown, LIFT)
    before = min(first, 1)
    rows = flown.telemetry.rows(first - before, last)
    return rows["guide.bank_deg"] if last > first else np.empty(0), before


def bank_reversals(flown: Flown) -> float | None:
    """Return the number of reversals of the commanded bank angle."""
    bank, _ = _bank(flown)
    return float(len(reversal_rows(bank))) if len(bank) else None


def bank_zero(flown: Flown) -> float | None:
    """Time (s) at which bank is first commanded to zero."""
    bank, before = _bank(flown)
    rows = np.flatnonzero(bank[before:] == 0.0)
    return float(Part(LIFT).rows(flown)["t_s"][rows[0]]) if len(rows) else None


#: Source of a figure, see :class:`FigureOfMerit`.
Source = Literal[
    "events", "telemetry", "navigation", "peaks", "contact", "footing", "diagnosis", "exclusions", "balance"
]
#: Duration (s) of the transient after the trim wing opens and of that of roll after engine ignition, and time
#: from ignition until backshell and vehicle count as separated.
WING_TRANSIENT_S, ROLL_TRANSIENT_S, SEPARATED_S = 10.0, 8.0, 5.0


class FigureOfMerit(NamedTuple):
    """One figure of a flight.

    Attributes:
        name: name with unit suffix, also of ``published`` values and of columns of campaigns.
        meaning: its name in reports.
        source: ``events``: time of an event, or state at it; ``telemetry``: rows of a part of the flight;
            ``navigation``: error of the estimate; ``peaks``: largest loads of all steps; ``contact``: located
            first ground contact; ``footing``: rough ground under the landed vehicle; ``diagnosis``: fault
            isolation; ``exclusions``: instruments out of use; ``balance``: change of the state compared with
            the sum of its causes.
        limit: parameter of the scenario's ``limits`` that is its upper bound, or the lower bound of a
            clearance; empty for none.
        allowed: upper bound in every scenario, for a figure that tests the simulator and not the mission.
        form: function that computes it from a :class:`Flown`, if telemetry and events suffice.
        clearance: True if the smallest value is the worst; otherwise the value of largest magnitude is.
    """

    name: str
    meaning: str
    source: Source
    limit: str = ""
    allowed: float = inf
    form: Form | None = None
    clearance: bool = False

    @property
    def unit(self) -> Unit:
        """Unit of the name's suffix."""
        return split_unit(self.name)[1]

    def violates(self, values: np.ndarray, limit: float) -> np.ndarray:
        """Return where ``values`` are beyond the limit, shape (n,), bool; NaN is not."""
        return values < limit if self.clearance else values > limit

    def used(self, value: float, limit: float) -> float:
        """Return the share of the limit that a value uses: above 1, the limit is violated."""
        return limit / max(value, 1e-9) if self.clearance else value / limit

    def toward_limit(self, share: float) -> float:
        """Return the quantile that a ``share`` of all flights is at, or farther from the limit than."""
        return 1.0 - share if self.clearance else share


def _axes(channel: str, axes: str = "x y z") -> tuple[str, ...]:
    return tuple(channel.format(axis) for axis in axes.split())


def _ned(channel: str) -> tuple[str, ...]:
    return _axes(channel, "north east down")


def _place(body: str) -> tuple[str, ...]:
    return _axes(f"truth.{body}_{{}}_m", "east north up")


_RATES = _axes("truth.rate_{}_deg_s", "p q r")
_ERRORS = _axes("control.error_{}_deg", "roll pitch yaw")
_POWERED, _SETTLED, _SEPARATED = (
    Part(since="ignition", after_s=after, later=after > 0.0, until="touchdown")
    for after in (0.0, ROLL_TRANSIENT_S, SEPARATED_S)
)
#: Parts of lift control in which the swings of pitch and yaw count.
_CALM = (Part(LIFT, until="trim_wing"), Part(LIFT, since="trim_wing", after_s=WING_TRANSIENT_S))
_F = FigureOfMerit

# fmt: off
FIGURES: tuple[FigureOfMerit, ...] = (
    _F("peak_load_g0", "peak load of the entry", "peaks", limit="entry_load_g0"),
    _F("peak_dynamic_pressure_pa", "peak dynamic pressure", "peaks", limit="entry_dynamic_pressure_pa"),
    _F("peak_heat_flux_w_cm2", "peak heat flux", "peaks", limit="entry_heat_flux_w_cm2"),
    _F("peak_radiative_heat_flux_w_cm2", "peak radiative heat flux", "peaks"),
    _F("peak_wall_temperature_k", "peak temperature of a wall that radiates all heat", "peaks"),
    _F("heat_load_j_cm2", "heat load", "peaks"),
    _F("trim_aoa_limit_cycle_deg", "limit cycle in trim", "telemetry", form=limit_cycle),
    _F("trim_aoa_propellant_kg", "propellant used in trim", "telemetry", form=trim_propellant),
    _F("lift_start_s", "lift control begins", "events", form=at(begun(LIFT))),
    _F("bank_reversals", "bank reversals", "telemetry", form=bank_reversals),
    _F("max_bank_rate_deg_s", "peak bank rate", "telemetry", form=over(Part(LIFT), "largest", _RATES[0])),
    _F("max_pitch_rate_lift_deg_s", "peak pitch rate in lift, less banking", "telemetry",
       form=swing(_CALM, _RATES[1], _RATES[0], "truth.beta_deg")),
    _F("max_yaw_rate_lift_deg_s", "peak yaw rate in lift, less banking", "telemetry",
       form=swing(_CALM, _RATES[2], _RATES[0], "truth.alpha_deg")),
    _F("bank_zero_s", "bank commanded to zero", "telemetry", form=bank_zero),
    _F("trim_wing_s", "trim wing commanded", "events", form=at("trim_wing")),
    _F("trim_wing_mach", "Mach at trim wing command", "events", form=value("trim_wing", "truth.mach")),
    _F("parachute_s", "mortar fire", "events", form=at("mortar")),
    _F("parachute_mach", "Mach at mortar fire", "events", limit="parachute_mach_max",
       form=value("mortar", "truth.mach")),
    _F("parachute_dynamic_pressure_pa", "dynamic pressure at mortar fire", "events",
       limit="parachute_dynamic_pressure_pa", form=value("mortar", "truth.dynamic_pressure_pa")),
    _F("parachute_total_alpha_deg", "total angle of attack at mortar fire", "events",
       limit="parachute_total_alpha_deg", form=value("mortar", "truth.total_alpha_deg")),
    _F("parachute_altitude_m", "altitude above the ellipsoid at mortar fire", "events",
       form=value("mortar", "truth.altitude_m")),
    _F("parachute_height_above_areoid_m", "height above the areoid at mortar fire", "events",
       form=value("mortar", "truth.height_above_areoid_m")),
    _F("parachute_height_m", "height above the ground at mortar fire", "events",
       form=value("mortar", "truth.height_m")),
    _F("parachute_speed_m_s", "speed at mortar fire", "events", form=value("mortar", "truth.speed_m_s")),
    _F("parachute_miss_m", "distance from the aim point at mortar fire", "events"),
    _F("parachute_downrange_m", "downrange miss at mortar fire", "events"),
    _F("parachute_crossrange_m", "crossrange miss at mortar fire", "events"),
    _F("max_load_parachute_g0", "peak load under parachute", "peaks"),
    _F("max_riser_tension_n", "peak riser tension", "peaks"),
    _F("max_rate_parachute_deg_s", "peak body rate under parachute", "telemetry",
       form=over(Part(PARACHUTE, needs="mortar"), "largest", *_RATES)),
    _F("heat_shield_s", "heat shield jettisoned", "events", form=at("heat_shield")),
    _F("parachute_duration_s", "time under parachute", "events", form=between("mortar", "backshell")),
    _F("backshell_s", "backshell released", "events", form=at("backshell")),
    _F("backshell_speed_m_s", "speed at backshell release", "events", limit="backshell_speed_m_s",
       form=value("backshell", "truth.speed_m_s")),
    _F("backshell_height_m", "height above the ground at backshell release", "events",
       limit="backshell_height_m", form=value("backshell", "truth.height_m")),
    _F("min_backshell_distance_m", "least distance from the backshell", "telemetry",
       form=over(_SEPARATED, "nearest", _place("site"), _place("backshell")), clearance=True),
    _F("min_drift_distance_m", "least distance from backshell and canopy once they have parted", "telemetry",
       limit="backshell_distance_m", clearance=True),
    _F("min_overhead_m", "least horizontal distance of parts above the lander, from hover on", "telemetry",
       clearance=True),
    _F("coarse_parts", "parts into which the landing image was divided", "telemetry"),
    _F("coarse_obstacles", "share of obstacles in the chosen part of the landing image", "telemetry"),
    _F("coarse_clear_m", "distance of the coarse point from where backshell and canopy may be", "telemetry",
       clearance=True),
    _F("spot_found", "whether a safe spot was found", "telemetry", clearance=True),
    _F("spot_clearance_m", "distance of the chosen spot from the nearest unsafe one", "telemetry",
       clearance=True),
    _F("spots_rejected", "spots rejected before the chosen one", "telemetry"),
    _F("map_safe_share", "share of the map that is safe", "telemetry", clearance=True),
    _F("spot_largest_rock_m", "largest rock under the chosen spot", "telemetry"),
    _F("spot_false_safe", "chosen as safe with a rock of half a metre under it", "telemetry"),
    _F("spot_miss_m", "distance of the touchdown from the chosen spot", "telemetry"),
    _F("site_miss_m", "distance from the chosen site of the map at the end of the flight", "telemetry"),
    _F("constraints_relaxed", "constraints that powered guidance relaxed, in their order", "telemetry"),
    _F("landing_error_m", "expected landing error with the relaxed constraints", "telemetry"),
    _F("powered_deceleration_s", "time in powered deceleration", "events",
       form=between("backshell", begun(HOVER_IMAGING))),
    _F("powered_duration_s", "time in powered descent", "events", form=between("backshell", "touchdown")),
    _F("engine_burn_s", "engine lit", "events", form=between("ignition", "cut_off", "touchdown")),
    _F("max_attitude_error_powered_deg", "peak attitude error under power", "telemetry",
       form=over(_POWERED, "longest", *_ERRORS[1:])),
    _F("max_rate_powered_deg_s", "peak body rate under power", "telemetry",
       form=over(_POWERED, "largest", *_RATES)),
    _F("max_roll_error_powered_deg", "peak roll error under power", "telemetry",
       form=over(_SETTLED, "largest", _ERRORS[0])),
    _F("roll_error_at_ignition_deg", "roll error at ignition", "events",
       form=value("ignition", "control.error_roll_deg")),
    _F("max_disturbance_torque_nm", "peak disturbance torque, true", "telemetry",
       form=over(_POWERED, "largest", *_axes("truth.disturbance_{}_nm"))),
    _F("max_estimated_torque_nm", "peak disturbance torque, estimated", "telemetry",
       form=over(_POWERED, "largest", *_axes("estimate.torque_{}_nm"))),
    _F("propellant_used_kg", "propellant used", "telemetry", form=propellant),
    _F("touchdown_s", "touchdown", "contact"),
    _F("touchdown_vertical_m_s", "vertical speed at touchdown", "contact", limit="touchdown_vertical_m_s"),
    _F("touchdown_horizontal_m_s", "horizontal speed at touchdown", "contact",
       limit="touchdown_horizontal_m_s"),
    _F("touchdown_roll_error_deg", "roll error at touchdown", "contact"),
    _F("touchdown_pitch_error_deg", "pitch error at touchdown", "contact"),
    _F("touchdown_yaw_error_deg", "yaw error at touchdown", "contact"),
    _F("touchdown_tilt_deg", "tilt at touchdown", "contact", limit="touchdown_tilt_deg"),
    _F("touchdown_roll_rate_deg_s", "roll rate at touchdown", "contact"),
    _F("touchdown_pitch_rate_deg_s", "pitch rate at touchdown", "contact"),
    _F("touchdown_yaw_rate_deg_s", "yaw rate at touchdown", "contact"),
    _F("touchdown_rate_deg_s", "body rate at touchdown", "contact", limit="touchdown_rate_deg_s"),
    _F("touchdown_slope_deg", "ground slope", "contact", limit="slope_deg"),
    _F("rocks_under_lander", "rocks of half a metre and more under the lander", "footing"),
    _F("largest_rock_m", "largest rock under the lander", "footing", limit="largest_rock_m"),
    _F("largest_rock_height_m", "height of the largest rock under the lander", "footing"),
    _F("ground_under_belly_m", "ground under the belly above the plane of the footpads", "footing",
       limit="ground_under_belly_m"),
    _F("belly_clearance_m", "least clearance of the belly", "footing", clearance=True),
    _F("landing_latitude_deg", "latitude of the landing point", "contact"),
    _F("landing_longitude_deg", "longitude of the landing point", "contact"),
    _F("landing_east_m", "landing point, east", "contact"),
    _F("landing_north_m", "landing point, north", "contact"),
    _F("landing_distance_m", "distance from the landing site", "contact", limit="landing_distance_m"),
    _F("parachute_nav_position_m", "error of the estimated position at mortar fire", "navigation",
       form=value("mortar", *_ned("nav.error_{}_m"))),
    _F("backshell_nav_horizontal_m", "horizontal error of the estimated position at backshell release",
       "navigation", form=value("backshell", *_ned("nav.error_{}_m")[:2])),
    _F("backshell_nav_attitude_deg", "error of the estimated attitude at backshell release", "navigation",
       form=value("backshell", *_ned("nav.error_attitude_{}_deg"))),
    _F("backshell_told_height_m", "height on board at backshell release", "navigation",
       form=value("backshell", "truth.height_m", "nav.error_height_m", added=True)),
    _F("ignition_nav_height_m", "error of the estimated height at ignition", "navigation",
       form=value("ignition", "nav.error_height_m")),
    _F("ignition_nav_velocity_m_s", "error of the estimated velocity at ignition", "navigation",
       form=value("ignition", *_ned("nav.error_v_{}_m_s"))),
    _F("touchdown_nav_height_m", "error of the estimated height at touchdown", "navigation",
       form=value("touchdown", "nav.error_height_m", before=True)),
    _F("touchdown_nav_velocity_m_s", "error of the estimated velocity at touchdown", "navigation",
       form=value("touchdown", *_ned("nav.error_v_{}_m_s"), before=True)),
    _F("touchdown_nav_vertical_deg", "error of the estimated vertical at touchdown", "navigation",
       form=value("touchdown", *_ned("nav.error_attitude_{}_deg")[:2], before=True)),
    _F("missed_isolations", "failed thrusters that were not isolated", "diagnosis"),
    _F("false_alarms", "isolations of healthy thrusters or of a wrong kind of fault", "diagnosis"),
    _F("time_to_detect_s", "time from a thruster's fault to its diagnosis", "diagnosis"),
    _F("instrument_false_alarms", "healthy instruments excluded", "exclusions"),
    _F("time_to_exclude_s", "time from an instrument's fault to its exclusion", "exclusions"),
    # the time at which a force jumps, as of a riser or a leg, is known to half a step: errors are up to
    # 1.1e-5 and 0.6 m/s in landings, against 1e-8 and 1e-4 m/s in entries
    _F("energy_balance", "balance of energy", "balance", allowed=1e-4),
    _F("momentum_balance_m_s", "balance of momentum", "balance", allowed=2.0),
    # momentum is kept to rounding, 1e-12 m/s
    _F("separation_balance_m_s", "balance of momentum at separations", "balance", allowed=1e-6),
    # specific impulse that changes with the throttle within a step: up to 5e-8
    _F("mass_balance", "balance of mass", "balance", allowed=1e-5),
)
# fmt: on
#: Figures that have a limit, in the order of messages.
LIMITS = tuple(figure for figure in FIGURES if figure.limit)
#: Figures that have to be small in every flight.
BALANCES = tuple(figure for figure in FIGURES if figure.source == "balance")
_BY_NAME = {figure.name: figure for figure in FIGURES}
#: Names of the declared figures.
DECLARED = frozenset(_BY_NAME)


def figure_of_merit(name: str) -> FigureOfMerit:
    """Return the figure of a name; an undeclared one, as from another version, is described by its name."""
    return _BY_NAME.get(name) or FigureOfMerit(name, split_unit(name)[0].replace("_", " "), "telemetry")


def from_si(source: Source, values: Iterable[float]) -> dict[str, float]:
    """Return all figures of a source, in their order and units, from their values in SI."""
    named = zip((figure for figure in FIGURES if figure.source == source), values, strict=True)
    return {figure.name: value * (1.0 / figure.unit.to_si) for figure, value in named}
