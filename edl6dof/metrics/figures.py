"""The figures of merit of a flight, declared once: name with unit suffix, what it is, where it comes from,
and which limit bounds it.

From this table follow the limits, the names of published values, and the labels of reports and campaigns.
"""

from __future__ import annotations

from math import inf
from typing import Literal, NamedTuple

from edl6dof.config.units import Unit, split_unit

#: What a figure is formed from.
Source = Literal["events", "telemetry", "peaks", "contact", "footing", "diagnosis", "exclusions", "balance"]


class FigureOfMerit(NamedTuple):
    """One figure of a flight.

    Attributes:
        name: with unit suffix; figures of a flight, ``published`` values and columns of campaigns have it.
        meaning: what it is, in the words of reports.
        source: ``events`` for the state at an event or the time of it, ``telemetry`` for the rows of a part
            of the flight, ``peaks`` for what the plant keeps at every step, ``contact`` for the located first
            ground contact, ``footing`` for the rough ground that it came to stand on, ``diagnosis`` for fault
            isolation, ``exclusions`` for instruments out of use, ``balance`` for what the state has become
            beside what it was given.
        limit: parameter of the scenario's ``limits`` that bounds it from above; empty for none.
        allowed: what bounds it from above in every scenario, as it judges the simulator and not the mission.
    """

    name: str
    meaning: str
    source: Source
    limit: str = ""
    allowed: float = inf

    @property
    def unit(self) -> Unit:
        """Unit of the name's suffix."""
        return split_unit(self.name)[1]


FIGURES: tuple[FigureOfMerit, ...] = (
    FigureOfMerit("peak_load_g0", "peak load of the entry", "peaks", limit="entry_load_g0"),
    FigureOfMerit(
        "peak_dynamic_pressure_pa", "peak dynamic pressure", "peaks", limit="entry_dynamic_pressure_pa"
    ),
    FigureOfMerit("peak_heat_flux_w_cm2", "peak heat flux", "peaks", limit="entry_heat_flux_w_cm2"),
    FigureOfMerit("heat_load_j_cm2", "heat load", "peaks"),
    FigureOfMerit("trim_aoa_limit_cycle_deg", "limit cycle in trim", "telemetry"),
    FigureOfMerit("trim_aoa_propellant_kg", "propellant used in trim", "telemetry"),
    FigureOfMerit("lift_start_s", "lift control begins", "events"),
    FigureOfMerit("bank_reversals", "bank reversals", "telemetry"),
    FigureOfMerit("max_bank_rate_deg_s", "peak bank rate", "telemetry"),
    FigureOfMerit("max_pitch_rate_lift_deg_s", "peak pitch rate in lift, less banking", "telemetry"),
    FigureOfMerit("max_yaw_rate_lift_deg_s", "peak yaw rate in lift, less banking", "telemetry"),
    FigureOfMerit("bank_zero_s", "bank commanded to zero", "telemetry"),
    FigureOfMerit("trim_wing_s", "trim wing commanded", "events"),
    FigureOfMerit("trim_wing_mach", "Mach at trim wing command", "events"),
    FigureOfMerit("parachute_s", "mortar fire", "events"),
    FigureOfMerit("parachute_mach", "Mach at mortar fire", "events", limit="parachute_mach_max"),
    FigureOfMerit(
        "parachute_dynamic_pressure_pa",
        "dynamic pressure at mortar fire",
        "events",
        limit="parachute_dynamic_pressure_pa",
    ),
    FigureOfMerit(
        "parachute_total_alpha_deg",
        "total angle of attack at mortar fire",
        "events",
        limit="parachute_total_alpha_deg",
    ),
    FigureOfMerit("parachute_altitude_m", "altitude above the ellipsoid at mortar fire", "events"),
    FigureOfMerit("parachute_height_above_areoid_m", "height above the areoid at mortar fire", "events"),
    FigureOfMerit("parachute_height_m", "height above the ground at mortar fire", "events"),
    FigureOfMerit("parachute_speed_m_s", "speed at mortar fire", "events"),
    FigureOfMerit("parachute_miss_m", "distance from the aim point at mortar fire", "events"),
    FigureOfMerit("parachute_downrange_m", "way beyond the aim point at mortar fire", "events"),
    FigureOfMerit("parachute_crossrange_m", "way right of the aim point at mortar fire", "events"),
    FigureOfMerit("max_load_parachute_g0", "peak load under parachute", "peaks"),
    FigureOfMerit("max_riser_tension_n", "peak riser tension", "peaks"),
    FigureOfMerit("max_rate_parachute_deg_s", "peak body rate under parachute", "telemetry"),
    FigureOfMerit("heat_shield_s", "heat shield jettisoned", "events"),
    FigureOfMerit("parachute_duration_s", "time under parachute", "events"),
    FigureOfMerit("backshell_s", "backshell released", "events"),
    FigureOfMerit("backshell_speed_m_s", "speed at backshell release", "events", limit="backshell_speed_m_s"),
    FigureOfMerit(
        "backshell_height_m",
        "height above the ground at backshell release",
        "events",
        limit="backshell_height_m",
    ),
    FigureOfMerit("min_backshell_distance_m", "least distance from the backshell", "telemetry"),
    FigureOfMerit(
        "min_drift_distance_m", "least distance from backshell and canopy once they have parted", "telemetry"
    ),
    FigureOfMerit(
        "min_overhead_m", "least way aside of what is above the lander, from hover on", "telemetry"
    ),
    FigureOfMerit("coarse_parts", "parts that the landing image was cut into", "telemetry"),
    FigureOfMerit("coarse_obstacles", "share of obstacles in the part that was taken", "telemetry"),
    FigureOfMerit(
        "coarse_clear_m", "coarse point from the predicted drift of backshell and canopy", "telemetry"
    ),
    FigureOfMerit("spot_found", "whether a safe spot was found", "telemetry"),
    FigureOfMerit("spot_clearance_m", "chosen spot from the nearest unsafe one", "telemetry"),
    FigureOfMerit("spots_rejected", "spots passed over on the way to the chosen one", "telemetry"),
    FigureOfMerit("map_safe_share", "share of the map that is safe", "telemetry"),
    FigureOfMerit("spot_largest_rock_m", "largest rock under the chosen spot", "telemetry"),
    FigureOfMerit("spot_false_safe", "chosen as safe with a rock of half a metre under it", "telemetry"),
    FigureOfMerit("spot_miss_m", "touchdown from the chosen spot on the ground", "telemetry"),
    FigureOfMerit(
        "constraints_relaxed", "constraints that powered guidance relaxed, in their order", "telemetry"
    ),
    FigureOfMerit("landing_error_m", "expected landing error with these relaxed", "telemetry"),
    FigureOfMerit("powered_deceleration_s", "time in powered deceleration", "events"),
    FigureOfMerit("powered_duration_s", "time in powered descent", "events"),
    FigureOfMerit("engine_burn_s", "engine lit", "events"),
    FigureOfMerit("max_attitude_error_powered_deg", "peak attitude error under power", "telemetry"),
    FigureOfMerit("max_rate_powered_deg_s", "peak body rate under power", "telemetry"),
    FigureOfMerit("max_roll_error_powered_deg", "peak roll error under power", "telemetry"),
    FigureOfMerit("roll_error_at_ignition_deg", "roll error at ignition", "events"),
    FigureOfMerit("max_disturbance_torque_nm", "peak disturbance torque, true", "telemetry"),
    FigureOfMerit("max_estimated_torque_nm", "peak disturbance torque, estimated", "telemetry"),
    FigureOfMerit("propellant_used_kg", "propellant used", "telemetry"),
    FigureOfMerit("touchdown_s", "touchdown", "contact"),
    FigureOfMerit(
        "touchdown_vertical_m_s", "vertical speed at touchdown", "contact", limit="touchdown_vertical_m_s"
    ),
    FigureOfMerit(
        "touchdown_horizontal_m_s",
        "horizontal speed at touchdown",
        "contact",
        limit="touchdown_horizontal_m_s",
    ),
    FigureOfMerit("touchdown_roll_error_deg", "roll error at touchdown", "contact"),
    FigureOfMerit("touchdown_pitch_error_deg", "pitch error at touchdown", "contact"),
    FigureOfMerit("touchdown_yaw_error_deg", "yaw error at touchdown", "contact"),
    FigureOfMerit("touchdown_tilt_deg", "tilt at touchdown", "contact", limit="touchdown_tilt_deg"),
    FigureOfMerit("touchdown_roll_rate_deg_s", "roll rate at touchdown", "contact"),
    FigureOfMerit("touchdown_pitch_rate_deg_s", "pitch rate at touchdown", "contact"),
    FigureOfMerit("touchdown_yaw_rate_deg_s", "yaw rate at touchdown", "contact"),
    FigureOfMerit("touchdown_rate_deg_s", "body rate at touchdown", "contact", limit="touchdown_rate_deg_s"),
    FigureOfMerit("touchdown_slope_deg", "ground slope", "contact", limit="slope_deg"),
    FigureOfMerit("rocks_under_lander", "rocks of half a metre and more under the lander", "footing"),
    FigureOfMerit("largest_rock_m", "largest rock under the lander", "footing", limit="largest_rock_m"),
    FigureOfMerit("largest_rock_height_m", "height of the largest rock under the lander", "footing"),
    FigureOfMerit(
        "ground_under_belly_m",
        "ground under the belly above the plane of the footpads",
        "footing",
        limit="ground_under_belly_m",
    ),
    FigureOfMerit("belly_clearance_m", "least clearance of the belly", "footing"),
    FigureOfMerit("landing_latitude_deg", "latitude of the landing point", "contact"),
    FigureOfMerit("landing_longitude_deg", "longitude of the landing point", "contact"),
    FigureOfMerit("landing_east_m", "landing point, east", "contact"),
    FigureOfMerit("landing_north_m", "landing point, north", "contact"),
    FigureOfMerit(
        "landing_distance_m", "distance from the landing site", "contact", limit="landing_distance_m"
    ),
    FigureOfMerit("parachute_nav_position_m", "error of the estimated position at mortar fire", "events"),
    FigureOfMerit(
        "backshell_nav_attitude_deg", "error of the estimated attitude at backshell release", "events"
    ),
    FigureOfMerit("backshell_told_height_m", "height on board at backshell release", "events"),
    FigureOfMerit("ignition_nav_height_m", "error of the estimated height at ignition", "events"),
    FigureOfMerit("ignition_nav_velocity_m_s", "error of the estimated velocity at ignition", "events"),
    FigureOfMerit("touchdown_nav_height_m", "error of the estimated height at touchdown", "events"),
    FigureOfMerit("touchdown_nav_velocity_m_s", "error of the estimated velocity at touchdown", "events"),
    FigureOfMerit("touchdown_nav_vertical_deg", "error of the estimated vertical at touchdown", "events"),
    FigureOfMerit("missed_isolations", "failed thrusters that were not isolated", "diagnosis"),
    FigureOfMerit("false_alarms", "isolations of sound thrusters or of a wrong kind of fault", "diagnosis"),
    FigureOfMerit("time_to_detect_s", "time from a thruster's fault to its diagnosis", "diagnosis"),
    FigureOfMerit("instrument_false_alarms", "sound instruments excluded", "exclusions"),
    FigureOfMerit("time_to_exclude_s", "time from an instrument's fault to its exclusion", "exclusions"),
    # a force that jumps inside a step, as where a riser pulls or a leg pushes, is known to half a step: that
    # makes up to 1.1e-5 and 0.6 m/s in landings, against 1e-8 and 1e-4 m/s in entries
    FigureOfMerit("energy_balance", "balance of energy", "balance", allowed=1e-4),
    FigureOfMerit("momentum_balance_m_s", "balance of momentum", "balance", allowed=2.0),
    # momentum is kept to rounding, 1e-12 m/s
    FigureOfMerit("separation_balance_m_s", "balance of momentum at separations", "balance", allowed=1e-6),
    # specific impulse that changes with the throttle within a step: up to 5e-8
    FigureOfMerit("mass_balance", "balance of mass", "balance", allowed=1e-5),
)
#: Figures that have a limit, in the order in which they are told of.
LIMITS = tuple(figure for figure in FIGURES if figure.limit)
#: Figures that have to be small in every flight.
BALANCES = tuple(figure for figure in FIGURES if figure.source == "balance")
_BY_NAME = {figure.name: figure for figure in FIGURES}
#: Their names.
DECLARED = frozenset(_BY_NAME)


def figure_of_merit(name: str) -> FigureOfMerit:
    """The figure of a name; one that is not declared, as in the files of another version, speaks for
    itself.
    """
    return _BY_NAME.get(name) or FigureOfMerit(name, split_unit(name)[0].replace("_", " "), "telemetry")
