"""Figures of a flight, the limits it must keep, and the published figures beside it.

A figure is a name with unit suffix and a number computed from this flight's telemetry and events.  The scenario's ``published`` section
uses the same names.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from edl6dof.config.units import split_unit

#: Seconds after the trim wing opens that count as its transient.
WING_TRANSIENT_S = 10.0
#: Seconds after engine ignition that count as the initial transient of roll.
ROLL_TRANSIENT_S = 8.0


@dataclass(frozen=True)
class Check:
    """One limit: its name, this flight's value and the largest value allowed, in ``unit``."""

    label: str
    value: float
    limit: float
    unit: str

    @property
    def ok(self) -> bool:
        """Whether the limit is kept; a value that could not be formed does not keep it."""
        return bool(self.value <= self.limit)


#: Limit name in the scenario, figure it bounds, label.
_LIMITS = (
    ("parachute_mach_max", "parachute_mach", "Mach at mortar fire"),
    ("parachute_dynamic_pressure_pa", "parachute_dynamic_pressure_pa", "dynamic pressure at mortar fire"),
    ("parachute_total_alpha_deg", "parachute_total_alpha_deg", "total angle of attack at mortar fire"),
    ("backshell_speed_m_s", "backshell_speed_m_s", "speed at backshell release"),
    ("backshell_height_m", "backshell_height_m", "height at backshell release"),
    ("touchdown_vertical_m_s", "touchdown_vertical_m_s", "vertical speed at touchdown"),
    ("touchdown_horizontal_m_s", "touchdown_horizontal_m_s", "horizontal speed at touchdown"),
    ("touchdown_tilt_deg", "touchdown_tilt_deg", "tilt at touchdown"),
    ("touchdown_rate_deg_s", "touchdown_rate_deg_s", "body rate at touchdown"),
    ("slope_deg", "touchdown_slope_deg", "ground slope"),
    ("landing_distance_m", "landing_distance_m", "distance from the landing site"),
)


def checks(limits: Any, figures: dict[str, float]) -> list[Check]:
    """Every limit that this flight reached the point to be judged by."""
    return [
        Check(label, figures[figure], getattr(limits, name), split_unit(name)[1].label)
        for name, figure, label in _LIMITS
        if figure in figures
    ]


def metrics(
    telemetry: dict[str, np.ndarray], events: list[dict[str, Any]], phases: list[str], touchdown: dict[str, float]
) -> dict[str, float]:
    """All figures of a flight that can be formed from what it flew through."""
    when = {event["key"]: event["t_s"] for event in reversed(events)}
    figures: dict[str, float] = {}
    figures.update(_event_figures(telemetry, when))
    figures.update(_entry_figures(telemetry, when, phases))
    figures.update(_descent_figures(telemetry, when, phases))
    figures.update(_overall_figures(telemetry))
    figures.update(touchdown)
    if touchdown:
        rates = [touchdown[f"touchdown_{axis}_rate_deg_s"] for axis in ("roll", "pitch", "yaw")]
        figures["touchdown_rate_deg_s"] = float(np.linalg.norm(rates))
    return figures


def _at(telemetry: dict[str, np.ndarray], name: str, t: float) -> float:
    return float(np.interp(t, telemetry["t_s"], telemetry[name]))


def _event_figures(telemetry: dict[str, np.ndarray], when: dict[str, float]) -> dict[str, float]:
    figures: dict[str, float] = {}
    if "phase.lift" in when:
        figures["lift_start_s"] = when["phase.lift"]
    if (t := when.get("trim_wing")) is not None:
        figures["trim_wing_s"], figures["trim_wing_mach"] = t, _at(telemetry, "truth.mach", t)
    if (t := when.get("mortar")) is not None:
        figures["parachute_s"] = t
        for name in ("mach", "dynamic_pressure_pa", "total_alpha_deg", "altitude_m", "height_m"):
            figures[f"parachute_{name}"] = _at(telemetry, f"truth.{name}", t)
    if (t := when.get("heat_shield")) is not None:
        figures["heat_shield_s"] = t
    if (t := when.get("backshell")) is not None:
        figures["backshell_s"] = t
        figures["backshell_height_m"] = _at(telemetry, "truth.height_m", t)
        figures["backshell_speed_m_s"] = _at(telemetry, "truth.speed_m_s", t)
    if "mortar" in when and "backshell" in when:
        figures["parachute_duration_s"] = when["backshell"] - when["mortar"]
    if "backshell" in when and "touchdown" in when:
        figures["powered_duration_s"] = when["touchdown"] - when["backshell"]
    if "backshell" in when and "phase.hover_imaging" in when:
        figures["powered_deceleration_s"] = when["phase.hover_imaging"] - when["backshell"]
    return figures


def _entry_figures(telemetry: dict[str, np.ndarray], when: dict[str, float], phases: list[str]) -> dict[str, float]:
    if "lift" not in phases:
        return {}
    t = telemetry["t_s"]
    lift = telemetry["guide.phase"] == phases.index("lift")
    if not lift.any():
        return {}
    wing = when.get("trim_wing", np.inf)
    calm = lift & ~((t >= wing) & (t < wing + WING_TRANSIENT_S))
    bank = telemetry["guide.bank_deg"]
    figures = {
        "bank_reversals": float(np.sum(bank[1:][lift[1:]] * bank[:-1][lift[1:]] < 0.0)),
        "max_bank_rate_deg_s": _peak(telemetry["truth.rate_p_deg_s"], lift),
        "max_pitch_rate_lift_deg_s": _peak(_swing(telemetry, "q"), calm),
        "max_yaw_rate_lift_deg_s": _peak(_swing(telemetry, "r"), calm),
    }
    zero = np.flatnonzero(lift & (bank == 0.0))
    if len(zero):
        figures["bank_zero_s"] = float(t[zero[0]])
    return figures


def _swing(telemetry: dict[str, np.ndarray], axis: str) -> np.ndarray:
    """Pitch or yaw rate (deg/s) without the part of it that is banking about the velocity.

    A bank about the velocity at angle of attack alpha shows as a yaw rate p tan(alpha) in the body (beta: in pitch); S1 counts the rates
    of the angle-of-attack and sideslip channels.
    """
    p = telemetry["truth.rate_p_deg_s"]
    if axis == "q":
        return telemetry["truth.rate_q_deg_s"] - p * np.tan(np.radians(telemetry["truth.beta_deg"]))
    return telemetry["truth.rate_r_deg_s"] - p * np.tan(np.radians(telemetry["truth.alpha_deg"]))


def _peak(values: np.ndarray, where: np.ndarray) -> float:
    return float(np.max(np.abs(values[where]))) if where.any() else float("nan")


def _descent_figures(telemetry: dict[str, np.ndarray], when: dict[str, float], phases: list[str]) -> dict[str, float]:
    figures: dict[str, float] = {}
    t = telemetry["t_s"]
    rates = np.stack([telemetry[f"truth.rate_{c}_deg_s"] for c in "pqr"])
    largest = np.max(np.abs(rates), axis=0)
    if "parachute" in phases and "mortar" in when:
        figures["max_rate_parachute_deg_s"] = _peak(largest, telemetry["guide.phase"] == phases.index("parachute"))
        figures["max_riser_tension_n"] = float(telemetry["truth.riser_tension_n"].max())
    if "ignition" in when:
        start, end = when["ignition"], when.get("touchdown", np.inf)
        powered = (t >= start) & (t < end)
        figures["max_rate_powered_deg_s"] = _peak(largest, powered)
        error = np.hypot(telemetry["control.error_pitch_deg"], telemetry["control.error_yaw_deg"])
        figures["max_attitude_error_powered_deg"] = _peak(error, powered)
        figures["roll_error_at_ignition_deg"] = _at(telemetry, "control.error_roll_deg", start)
        settled = powered & (t > start + ROLL_TRANSIENT_S)
        figures["max_roll_error_powered_deg"] = _peak(telemetry["control.error_roll_deg"], settled)
        moments = np.stack([telemetry[f"truth.disturbance_{c}_nm"] for c in "xyz"])
        figures["max_disturbance_torque_nm"] = _peak(np.max(np.abs(moments), axis=0), powered)
        apart = np.sqrt(sum((telemetry[f"truth.site_{c}_m"] - telemetry[f"truth.backshell_{c}_m"]) ** 2 for c in ("east", "north", "up")))
        if (separated := powered & (t > start + 5.0)).any():
            figures["min_backshell_distance_m"] = float(np.nanmin(apart[separated]))
    return figures


def _overall_figures(telemetry: dict[str, np.ndarray]) -> dict[str, float]:
    propellant = telemetry["truth.propellant_kg"]
    before_ground = telemetry["truth.footpads"] == 0
    return {
        "peak_load_g0": _peak(telemetry["truth.load_g0"], before_ground),
        "peak_dynamic_pressure_pa": float(telemetry["truth.dynamic_pressure_pa"].max()),
        "peak_heat_flux_w_cm2": float(telemetry["truth.heat_flux_w_cm2"].max()),
        "heat_load_j_cm2": float(telemetry["truth.heat_load_j_cm2"][-1]),
        "propellant_used_kg": float(propellant[0] - propellant[-1]),
    }
