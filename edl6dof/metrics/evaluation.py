"""Figures of a flight from its telemetry, events and peaks, and the limits that they must keep;
``edl6dof.metrics.figures`` declares them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from edl6dof.config.units import split_unit
from edl6dof.interface.roles import HOVER_IMAGING, LIFT, PARACHUTE, TRIM, begun
from edl6dof.metrics.extremes import CALM, EXTREMES, SWINGS, role_rows
from edl6dof.metrics.figures import BALANCES, LIMITS, figure_of_merit
from edl6dof.telemetry.columns import Telemetry
from edl6dof.vehicle.plant import HEAT

#: Last seconds of the trim phase, in which its limit cycle is looked at.
LIMIT_CYCLE_S = 30.0
#: What its limit cycle shows in.
TRIM_ERRORS = tuple(f"control.error_{axis}_deg" for axis in ("roll", "pitch", "yaw"))


@dataclass(frozen=True)
class Check:
    """One limit: the figure that it bounds by name and in words, this flight's value and the largest value
    allowed, in ``unit``.
    """

    figure: str
    label: str
    value: float
    limit: float
    unit: str

    @property
    def ok(self) -> bool:
        """Whether the limit is kept; a value that could not be formed does not keep it."""
        return bool(self.value <= self.limit)

    @property
    def of_balance(self) -> bool:
        """Whether it judges the simulator and not the mission."""
        return figure_of_merit(self.figure).source == "balance"

    @property
    def told(self) -> str:
        """What stands for it in the outcome: a broken balance with its numbers."""
        unit = f" {self.unit}" if self.unit else ""
        return (
            f"{self.label}: {self.value:.1e}, limit {self.limit:g}{unit}" if self.of_balance else self.label
        )


def checks(limits: Any, figures: dict[str, float]) -> list[Check]:
    """Every limit that is set and whose point this flight reached, and every balance that it does not
    keep.
    """
    bounds = [(figure, getattr(limits, figure.limit)) for figure in LIMITS]
    found = [
        Check(figure.name, figure.meaning, figures[figure.name], bound, figure.unit.label)
        for figure, bound in (*bounds, *((figure, figure.allowed) for figure in BALANCES))
        if figure.name in figures and bound is not None
    ]
    return [check for check in found if not (check.of_balance and check.ok)]


def metrics(telemetry: Telemetry, when: dict[str, float], roles: list[str]) -> dict[str, float]:
    """Figures that telemetry tells of what the flight went through.

    Args:
        telemetry: its rows.
        when: time (s) of its events by key, see :func:`edl6dof.telemetry.timeline.first_times`.
        roles: role of each phase.
    """
    figures: dict[str, float] = {}
    figures.update(_event_figures(telemetry, when))
    figures.update(_trim_figures(telemetry, roles))
    figures.update(_entry_figures(telemetry, when, roles))
    figures.update(_descent_figures(telemetry, when, roles))
    propellant = telemetry["truth.propellant_kg"]
    figures["propellant_used_kg"] = float(propellant[0] - propellant[-1])
    return figures


def _beyond(rising: np.ndarray, value: float) -> int:
    """Index of the first element above ``value``."""
    return int(np.searchsorted(rising, value, side="right"))


def _event_figures(telemetry: Telemetry, when: dict[str, float]) -> dict[str, float]:
    figures: dict[str, float] = {}
    if (t := when.get(begun(LIFT))) is not None:
        figures["lift_start_s"] = t
    if (t := when.get("trim_wing")) is not None:
        figures["trim_wing_s"], (figures["trim_wing_mach"],) = t, telemetry.at(t, "truth.mach")
    if (t := when.get("mortar")) is not None:
        figures["parachute_s"] = t
        names = (
            *("mach", "dynamic_pressure_pa", "total_alpha_deg"),
            *("altitude_m", "height_above_areoid_m", "height_m", "speed_m_s"),
        )
        values = telemetry.at(t, *(f"truth.{name}" for name in names))
        figures.update({f"parachute_{name}": value for name, value in zip(names, values, strict=True)})
    if (t := when.get("heat_shield")) is not None:
        figures["heat_shield_s"] = t
    if (t := when.get("backshell")) is not None:
        figures["backshell_s"] = t
        figures["backshell_height_m"], figures["backshell_speed_m_s"] = telemetry.at(
            t, "truth.height_m", "truth.speed_m_s"
        )
    if "mortar" in when and "backshell" in when:
        figures["parachute_duration_s"] = when["backshell"] - when["mortar"]
    if "backshell" in when and "touchdown" in when:
        figures["powered_duration_s"] = when["touchdown"] - when["backshell"]
    if "ignition" in when and (over := [when[end] for end in ("cut_off", "touchdown") if end in when]):
        figures["engine_burn_s"] = min(over) - when["ignition"]
    if "backshell" in when and begun(HOVER_IMAGING) in when:
        figures["powered_deceleration_s"] = when[begun(HOVER_IMAGING)] - when["backshell"]
    return figures


def _trim_figures(telemetry: Telemetry, roles: list[str]) -> dict[str, float]:
    """Limit cycle and propellant of the trim phase; S1 asks for a deadband below 5 deg."""
    first, last = role_rows(telemetry, roles, TRIM)
    if last - first < 2 or last == len(telemetry["t_s"]):
        return {}
    phase = telemetry.rows(first, last)
    times, propellant = phase["t_s"], phase["truth.propellant_kg"]
    late = phase.rows(_beyond(times, times[-1] - LIMIT_CYCLE_S), None)
    return {
        "trim_aoa_limit_cycle_deg": float(np.max(late.largest(*TRIM_ERRORS))),
        "trim_aoa_propellant_kg": float(propellant[0] - propellant[-1]),
    }


def _entry_figures(telemetry: Telemetry, when: dict[str, float], roles: list[str]) -> dict[str, float]:
    first, last = role_rows(telemetry, roles, LIFT)
    if first == last:
        return {}
    t = telemetry.rows(first, last)["t_s"]
    pitch, yaw = np.fmax(
        *(part.rows(telemetry, when, roles).fastest_swings(SWINGS) for part in CALM)
    ).tolist()
    before = min(first, 1)
    with_entry = telemetry.rows(first - before, last)["guide.bank_deg"]
    figures = {
        "bank_reversals": float(np.count_nonzero(with_entry[1:] * with_entry[:-1] < 0.0)),
        **_extremes(telemetry, when, roles, "max_bank_rate_deg_s"),
        "max_pitch_rate_lift_deg_s": pitch,
        "max_yaw_rate_lift_deg_s": yaw,
    }
    zero = with_entry[before:] == 0.0
    if zero[first_zero := zero.argmax()]:
        figures["bank_zero_s"] = float(t[first_zero])
    return figures


def _extremes(
    telemetry: Telemetry, when: dict[str, float], roles: list[str], *names: str
) -> dict[str, float]:
    return {name: EXTREMES[name].of(EXTREMES[name].part.rows(telemetry, when, roles)) for name in names}


def _descent_figures(telemetry: Telemetry, when: dict[str, float], roles: list[str]) -> dict[str, float]:
    figures: dict[str, float] = {}
    if PARACHUTE in roles and "mortar" in when:
        figures.update(_extremes(telemetry, when, roles, "max_rate_parachute_deg_s"))
    if "ignition" in when:
        figures.update(_powered_figures(telemetry, when, roles))
    return figures


def _powered_figures(telemetry: Telemetry, when: dict[str, float], roles: list[str]) -> dict[str, float]:
    """Figures between the times of ignition and of touchdown."""
    figures = _extremes(telemetry, when, roles, "max_rate_powered_deg_s", "max_attitude_error_powered_deg")
    figures["roll_error_at_ignition_deg"] = telemetry.at(when["ignition"], "control.error_roll_deg")[0]
    figures.update(_extremes(telemetry, when, roles, "max_disturbance_torque_nm", "max_estimated_torque_nm"))
    for name in ("max_roll_error_powered_deg", "min_backshell_distance_m"):
        if len((rows := EXTREMES[name].part.rows(telemetry, when, roles))["t_s"]):
            figures[name] = EXTREMES[name].of(rows)
    return figures


def peak_figures(plant: np.void, peaks: np.void, when: dict[str, float]) -> dict[str, float]:
    """Largest loads since the initial state, and the heat load, in the units of their names."""
    found = {
        "peak_load_g0": peaks["entry_load"],
        "peak_dynamic_pressure_pa": peaks["dynamic_pressure"],
        "peak_heat_flux_w_cm2": peaks["heat_flux"],
        "heat_load_j_cm2": plant["y"][HEAT],
    }
    if "mortar" in when:
        found["max_load_parachute_g0"] = peaks["parachute_load"]
        found["max_riser_tension_n"] = peaks["riser_tension"]
    return {name: float(value) / split_unit(name)[1].to_si for name, value in found.items()}
