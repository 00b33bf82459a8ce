"""The plots of the replay: which telemetry, under which title, on which page."""

from __future__ import annotations

from typing import NamedTuple

RGB = tuple[int, int, int]

#: Colours that stay apart on a dark ground, for the colour-blind too.
SERIES: tuple[RGB, ...] = (
    (86, 180, 233),
    (240, 160, 60),
    (120, 220, 140),
    (230, 110, 170),
    (240, 228, 90),
    (160, 140, 240),
)


class Plot(NamedTuple):
    """One plot: its entity, title with unit, telemetry columns with their names, and the events between which
    it means something.

    Attributes:
        sigma: column of a standard deviation, three of which are drawn on both sides of zero.
    """

    entity: str
    title: str
    series: dict[str, str]
    scale: float = 1.0
    until: str = ""
    since: str = ""
    sigma: str = ""

    @property
    def columns(self) -> tuple[str, ...]:
        """Telemetry columns that it shows."""
        return (*self.series, *[self.sigma] * bool(self.sigma))


def _axes(stem: str, suffix: str, axes: str, name: str = "{}") -> dict[str, str]:
    return {f"{stem}_{axis}_{suffix}": name.format(axis) for axis in axes.split()}


ALTITUDE = Plot(
    "altitude_km",
    "Height (km)",
    {"truth.altitude_m": "above ellipsoid", "truth.height_m": "above ground"},
    1e-3,
)
MACH = Plot("mach", "Mach number (1)", {"truth.mach": "Mach"}, until="backshell")
PRESSURE = Plot(
    "dynamic_pressure_kpa",
    "Dynamic pressure (kPa)",
    {"truth.dynamic_pressure_pa": "dynamic pressure"},
    1e-3,
    "backshell",
)
LOAD = Plot("load_g0", "Load (Earth g)", {"truth.load_g0": "sensed acceleration"})
HEAT = Plot(
    "heat_flux_w_cm2", "Heat flux (W/cm²)", {"truth.heat_flux_w_cm2": "stagnation point"}, until="mortar"
)
SPEED = Plot("speed_km_s", "Speed over ground (km/s)", {"truth.speed_m_s": "speed"}, 1e-3)
RATES = Plot("body_rate_deg_s", "Body rate (deg/s)", _axes("truth.rate", "deg_s", "p q r"))
BANK = Plot(
    "bank_deg", "Bank (deg)", {"guide.bank_deg": "commanded", "truth.bank_deg": "flown"}, until="mortar"
)
AIR_ANGLES = Plot(
    "air_angles_deg", "Air angles (deg)", {"truth.alpha_deg": "α", "truth.beta_deg": "β"}, until="backshell"
)
DRAG = Plot(
    "drag_m_s2",
    "Drag (m/s²)",
    {"guide.reference_drag_m_s2": "reference", "nav.drag_m_s2": "measured"},
    until="mortar",
)
RANGE = Plot("range_to_go_km", "Range to go (km)", {"guide.range_to_go_km": "range to go"}, until="mortar")
CROSSRANGE = Plot(
    "crossrange_km", "Crossrange (km)", {"guide.crossrange_km": "crossrange, right +"}, until="mortar"
)
TENSION = Plot(
    "riser_tension_kn",
    "Riser tension (kN)",
    {"truth.riser_tension_n": "tension"},
    1e-3,
    "backshell",
    "mortar",
)
TOTAL_ALPHA = Plot(
    "total_alpha_deg",
    "Total angle of attack (deg)",
    {"truth.total_alpha_deg": "total"},
    until="backshell",
    since="mortar",
)
HEIGHT = Plot("height_m", "Height above ground (m)", {"truth.height_m": "height"}, since="backshell")
VELOCITY = Plot(
    "velocity_m_s", "Velocity (m/s)", _axes("truth.v", "m_s", "north east down"), since="backshell"
)
THRUST = Plot(
    "engine_thrust_kn",
    "Engine thrust (kN)",
    {"guide.thrust_n": "commanded", "truth.engine_thrust_n": "delivered"},
    1e-3,
    since="backshell",
)
TILT = Plot(
    "tilt_deg", "Tilt of the thrust axis (deg)", {"truth.tilt_deg": "from the vertical"}, since="backshell"
)
OFFSET = Plot(
    "site_offset_m", "Distance from the site (m)", _axes("truth.site", "m", "east north"), since="backshell"
)
TO_GO = Plot("time_to_go_s", "Time to go (s)", {"guide.time_to_go_s": "powered guidance"}, since="backshell")
PROPELLANT = Plot("propellant_kg", "Propellant (kg)", {"truth.propellant_kg": "left"})
MASS = Plot("mass_kg", "Mass (kg)", {"truth.mass_kg": "true", "nav.mass_kg": "believed"}, since="backshell")
ERROR = Plot("attitude_error_deg", "Attitude error (deg)", _axes("control.error", "deg", "roll pitch yaw"))
DEMAND = Plot(
    "torque_demand_nm", "Demanded torque (N m)", _axes("control.torque", "nm", "x y z"), until="touchdown"
)
UNALLOCATED = Plot(
    "torque_unallocated_nm",
    "Unallocated torque (N m)",
    _axes("control.unallocated", "nm", "x y z"),
    until="touchdown",
)
DIAGNOSIS = Plot(
    "diagnosis",
    "Thruster diagnosis: confidence (0 to 1), found",
    {"diagnosis.confidence": "confidence", "diagnosis.isolated": "isolated"},
)


def _estimate(axis: str) -> Plot:
    series = {f"estimate.torque_{axis}_nm": "estimated", f"truth.disturbance_{axis}_nm": "true"}
    return Plot(
        f"disturbance_torque_{axis}_nm", f"Disturbance torque {axis} (N m)", series, until="touchdown"
    )


TORQUES = tuple(_estimate(axis) for axis in "xyz")
FORCE = Plot(
    "disturbance_force_n",
    "Disturbance force (N)",
    _axes("estimate.force", "n", "y z", "{} estimated")
    | _axes("truth.aero_force", "n", "y z", "{} true, aerodynamic"),
    until="mortar",
)

#: The errors of an estimate far from the ground are a thousand times those at touchdown: each has its plot.
POSITION_ERROR = Plot(
    "nav_position_m", "Position, estimated less true (m)", _axes("nav.error", "m", "north east down")
)
VELOCITY_ERROR = Plot(
    "nav_velocity_m_s", "Velocity, estimated less true (m/s)", _axes("nav.error_v", "m_s", "north east down")
)
ATTITUDE_ERROR = Plot(
    "nav_attitude_deg",
    "Attitude, estimated less true (deg)",
    _axes("nav.error_attitude", "deg", "north east down"),
)
HEIGHT_ERROR = Plot(
    "nav_height_m",
    "Height, estimated less true (m)",
    {"nav.error_height_m": "error"},
    since="backshell",
    sigma="nav.sigma_height_m",
)
INNOVATION = Plot(
    "nav_innovation",
    "Largest innovation of a beam (sigma)",
    {"nav.range_innovation": "range", "nav.speed_innovation": "speed"},
    since="heat_shield",
)


def _velocity_error(axis: str) -> Plot:
    return Plot(
        f"nav_velocity_{axis}_m_s",
        f"Velocity {axis}, estimated less true (m/s)",
        {f"nav.error_v_{axis}_m_s": "error"},
        since="backshell",
        sigma=f"nav.sigma_v_{axis}_m_s",
    )


#: Of flights that navigate with instruments.
NAVIGATION = "Navigation"

#: Plots by page.
PAGES: dict[str, tuple[Plot, ...]] = {
    "Flight": (ALTITUDE, SPEED, LOAD, PROPELLANT),
    "Entry": (BANK, AIR_ANGLES, DRAG, HEAT, RANGE, CROSSRANGE, MACH, PRESSURE),
    "Parachute": (ALTITUDE, MACH, TENSION, PRESSURE, TOTAL_ALPHA, RATES),
    "Powered descent": (HEIGHT, VELOCITY, THRUST, TILT, OFFSET, PROPELLANT, TO_GO, MASS),
    "Control": (ERROR, RATES, *TORQUES, FORCE, DEMAND, UNALLOCATED),
    NAVIGATION: (
        *(POSITION_ERROR, VELOCITY_ERROR, ATTITUDE_ERROR, INNOVATION, HEIGHT_ERROR),
        *(_velocity_error(axis) for axis in ("down", "north", "east")),
    ),
    "Thrusters": (DIAGNOSIS, PROPELLANT),
}
PLOTS = tuple({plot.entity: plot for page in PAGES.values() for plot in page}.values())

#: Titles of the thruster plots by group.
GROUPS = {"horizontal": "Horizontal", "axial": "Axial", "attitude": "Attitude", "fine": "Fine"}
