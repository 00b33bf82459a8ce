"""The Onboard record: everything the flight computer believes, and its settings.

It is filled from the nominal configuration; dispersions and faults change only the truth. The atmosphere is a
coarse table of density, speed of sound and expected mean wind; drag area and lift-to-drag ratio are one
number each, times factors over Mach number.
"""

from __future__ import annotations

from typing import Annotated, Any

from edl6dof.config.base import Capacity, Params, group, param
from edl6dof.config.dtype import dtype_of
from edl6dof.fsw.allocation.effectiveness import EFFECTIVENESS
from edl6dof.fsw.allocation.registry import ALLOCATION, DEMAND, AllocationParams
from edl6dof.fsw.check_out import CHECK_OUT, CHECK_OUT_MEMORY, CheckOutParams
from edl6dof.fsw.control.registry import CONTROL, CONTROLLERS
from edl6dof.fsw.diagnosis.diagnose import DIAGNOSIS, DiagnosisParams
from edl6dof.fsw.estimation.registry import DISTURBANCE, ESTIMATION, EstimationParams
from edl6dof.fsw.external import OWN
from edl6dof.fsw.guidance.entry.aim_point import HeadingAlignmentParams
from edl6dof.fsw.guidance.entry.air_data import AirDataParams, ExpectedWindParams
from edl6dof.fsw.guidance.entry.airframe import AIRFRAME
from edl6dof.fsw.guidance.entry.drag_velocity import EntryLimitParams
from edl6dof.fsw.guidance.entry.range_update import TrackingParams
from edl6dof.fsw.guidance.entry.reference import REFERENCE, ReferenceBankParams
from edl6dof.fsw.guidance.entry.registry import ENTRY_LAWS
from edl6dof.fsw.guidance.entry.reversal.registry import ReversalParams
from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.guidance.phase_guidance import GUIDANCE
from edl6dof.fsw.guidance.powered.registry import POWERED_LAWS
from edl6dof.fsw.guidance.powered.stopping import StuckThrottleDescentParams
from edl6dof.fsw.guidance.powered.target import PoweredTargetParams
from edl6dof.fsw.guidance.powered.terminal_descent import TerminalParams
from edl6dof.fsw.hazard.coarse_avoidance import DRIFTER
from edl6dof.fsw.hazard.detection import HAZARD
from edl6dof.fsw.hazard.registry import HazardParams
from edl6dof.fsw.hazard.site_selection import LANDING_POINT
from edl6dof.fsw.mission import MISSION, SEQUENCE
from edl6dof.fsw.modulation import MODULATION, ModulationParams
from edl6dof.fsw.navigation.derived import DRAG_FILTER, NAV
from edl6dof.fsw.navigation.filters.registry import NavigationParams
from edl6dof.fsw.navigation.instruments import INSTRUMENTS
from edl6dof.fsw.navigation.update import NAVIGATION
from edl6dof.fsw.navigation.wind_estimate import WIND_ESTIMATE
from edl6dof.fsw.vehicle_state import ENGINE_ABILITY, HEALTH, VEHICLE_STATE
from edl6dof.interface.capacities import MAX_ENGINES, MAX_PARACHUTES, MAX_PARTS, MAX_THRUSTERS
from edl6dof.interface.command import COMMAND, EXTERNAL
from edl6dof.interface.effectors import BRANCHES
from edl6dof.records import FLAG, record
from edl6dof.spatial.frames import LOCAL_FRAME

NODES = 128

_EntryLaws: Any = ENTRY_LAWS.params_model("EntryLawParams", "law", "drag_tracking", "Entry guidance.")
_PoweredLaws: Any = POWERED_LAWS.params_model("PoweredLawParams", "law", "polynomial", "Powered guidance.")


class EntryGuidanceParams(_EntryLaws):
    """Entry guidance: the law, and the settings that all laws share."""

    preset_bank_deg: float = param(
        55.0, "bank magnitude before lift control, towards the aim point", ge=0.0, le=180.0
    )
    trim_alpha_deg: float = param(
        -10.0,
        "goal of the angle of attack until lift control ends",
        status="published",
        source="S1",
        ge=-90.0,
        le=90.0,
    )
    bank_min_deg: float = param(
        15.0, "smallest bank magnitude, which preserves crossrange control", ge=0.0, le=90.0
    )
    bank_max_deg: float = param(105.0, "largest bank magnitude", ge=0.0, le=180.0)
    bank_rate_deg_s: float = param(
        20.0,
        "largest rate of the commanded bank angle",
        status="published",
        source="S1",
        gt=0.0,
        le=1e5,
        usual=(1, 20000, "attitude control to the instant turns of a paper"),
    )
    reference_bank: ReferenceBankParams = group(
        ReferenceBankParams, "open-loop bank of the reference trajectory"
    )
    tracking: TrackingParams = group(TrackingParams, "following the reference drag")
    limits: EntryLimitParams = group(EntryLimitParams, "entry flight corridor")
    reversal: ReversalParams = group(ReversalParams, "bank reversals")
    air_data: AirDataParams = group(AirDataParams, "measured drag and lift ratios")
    heading: HeadingAlignmentParams = group(HeadingAlignmentParams, "heading alignment")
    align_speed_m_s: float = param(
        640.0, "speed below which the bank angle is commanded to zero", status="estimate", ge=0.0
    )
    final_speed_m_s: float = param(
        420.0, "speed at which the reference range is met", status="derived", gt=0.0, le=4000.0
    )
    final_mach: float = param(
        0.0, "Mach number at which a prediction ends; 0: at final_speed_m_s", ge=0.0, le=10.0
    )
    expected_wind: ExpectedWindParams = group(
        ExpectedWindParams, "expected mean wind; the section wind is the true one", record=False
    )

    @property
    def heading_below_m_s(self) -> float:
        """Speed below which heading alignment replaces range control: that of the chosen law, if it has
        one.
        """
        own = getattr(getattr(self, self.law, None), "heading_speed_m_s", None)
        return self.heading.speed_m_s if own is None else float(own)


class PoweredGuidanceParams(_PoweredLaws):
    """Powered guidance: the deceleration law and the terminal phases."""

    full_time_s: float = param(1.0, "shortest time at full thrust after ignition", status="estimate", ge=0.0)
    full_again: float = param(
        1.5,
        "demand, divided by the upper end of the throttle band, from which full thrust is used again",
        status="estimate",
        ge=1.0,
        le=100.0,
    )
    target: PoweredTargetParams = group(PoweredTargetParams, "where powered deceleration ends")
    terminal: TerminalParams = group(TerminalParams, "hover, hazard avoidance, slow descent")
    held_thrust: StuckThrottleDescentParams = group(StuckThrottleDescentParams, "descent on a stuck throttle")


class GuidanceParams(Params):
    """Guidance laws."""

    entry: EntryGuidanceParams = group(EntryGuidanceParams, "entry guidance")
    powered: PoweredGuidanceParams = group(PoweredGuidanceParams, "powered guidance")


_Controllers: Any = CONTROLLERS.params_model("ControllerParams", None, "off", "Attitude controllers.")


class ControlParams(_Controllers):
    """Attitude controllers; each phase names the one it uses."""


class RateParams(Params):
    """Divisions of the base cycle at which the parts of the flight software run."""

    base_hz: int = param(50, "rate of the base cycle: sensing, navigation, mission sequence", ge=5, le=200)
    control_every: int = param(
        2, "base cycles for each cycle of attitude control, allocation and modulation", ge=1, le=50
    )
    entry_guidance_every: int = param(10, "base cycles for each cycle of entry guidance", ge=1, le=500)
    powered_guidance_every: int = param(5, "base cycles for each cycle of powered guidance", ge=1, le=500)


class FlightSoftwareParams(Params):
    """Settings of the flight software."""

    rates: RateParams = group(RateParams, "rate table")
    navigation: NavigationParams = group(NavigationParams, "navigation")
    hazard: HazardParams = group(HazardParams, "hazard detection and the choice of a spot")
    guidance: GuidanceParams = group(GuidanceParams, "guidance laws")
    check_out: CheckOutParams = group(CheckOutParams, "check-out of thrusters")
    control: ControlParams = group(ControlParams, "attitude controllers")
    estimation: EstimationParams = group(EstimationParams, "disturbance estimation")
    diagnosis: DiagnosisParams = group(DiagnosisParams, "thruster fault diagnosis")
    allocation: AllocationParams = group(AllocationParams, "thruster allocation")
    modulation: ModulationParams = group(ModulationParams, "pulse modulation")


class BelievedThruster(Params):
    """A thruster as the flight computer knows it."""

    position_m: tuple[float, float, float] = param(..., "position in B")
    direction: tuple[float, float, float] = param(..., "unit force direction in B")
    thrust_n: float = param(..., "thrust")
    specific_impulse_s: float = param(..., "specific impulse")
    minimum_pulse_s: float = param(..., "shortest pulse")
    group: int = param(..., "index of the thruster group")


class _Thrusters(Params):
    thrusters: Annotated[list[BelievedThruster], Capacity(MAX_THRUSTERS)] = param(
        ..., "thrusters of the on-board model"
    )


CONFIGURATION = record(
    ("mass", "f8"),  # kg: believed
    ("centre", "f8", (3,)),  # m, B: centre of mass, from the nose
    ("inertia", "f8", (3,)),  # kg m2, B: principal moments about the centre of mass
    ("hung_at", "f8", (3,)),  # m, B: attachment point of a riser; the centre of mass without one
)

ONBOARD = record(
    (
        "planet",
        record(
            ("mu", "f8"),  # m3/s2: gravitational parameter
            ("equatorial_radius", "f8"),  # m: of the reference ellipsoid
            ("flattening", "f8"),  # of the reference ellipsoid
            ("rotation_rate", "f8"),  # rad/s: about z of I and F, positive eastward
            ("j2", "f8"),  # oblateness, not normalised
            ("gravity_radius", "f8"),  # m: radius that the oblateness refers to
            ("sutton_graves_constant", "f8"),  # kg^0.5/m: of the convective heat flux
        ),
    ),
    (
        "atmosphere",
        record(
            ("bottom", "f8"),  # m: altitude of the first node
            ("top", "f8"),  # m: altitude of the last node
            ("spacing", "f8"),  # m: between nodes
            ("ln_density", "f8", (NODES,)),  # natural logarithm of the density in kg/m3
            ("speed_of_sound", "f8", (NODES,)),  # m/s: believed
            ("wind_north", "f8", (NODES,)),  # m/s: expected mean wind, towards north
            ("wind_east", "f8", (NODES,)),  # m/s: expected mean wind, towards east
        ),
    ),
    (
        "site",
        record(
            ("latitude", "f8"),  # rad: geodetic, of the landing site
            ("longitude", "f8"),  # rad: of the landing site, positive east
            ("altitude", "f8"),  # m: of the landing site, above the reference ellipsoid
            ("aim_latitude", "f8"),  # rad: geodetic, of the aim point of entry guidance
            ("aim_longitude", "f8"),  # rad: of the aim point, positive east
            ("frame", LOCAL_FRAME),  # frame L of the landing site
        ),
    ),
    (
        "vehicle",
        record(
            ("entry_mass", "f8"),  # kg: at entry
            ("drag_area", "f8"),  # m2: drag coefficient times reference area
            ("lift_to_drag", "f8"),  # lift-to-drag ratio at trim
            ("airframe", AIRFRAME),  # trim, drag and lift against the Mach number
            # one for each set of separated parts, a bit for each part
            ("configuration", CONFIGURATION, (2**MAX_PARTS,)),
            ("pack", "i8", (MAX_PARACHUTES,)),  # part that is the packed parachute; -1: none
            ("engines", ENGINE_ABILITY, (MAX_ENGINES,)),  # each engine by itself
            ("n_engines", "i8"),  # engines that the vehicle has
            *[(name, dtype_of(_Thrusters)[name]) for name in ("thrusters", "n_thrusters")],
            ("branches", BRANCHES),  # propellant branches
        ),
    ),
    ("rates", dtype_of(RateParams)),
    ("instruments", INSTRUMENTS),
    ("flow_meters", FLAG),  # propellant branches are metered
    ("navigation", dtype_of(NavigationParams)),
    ("hazard", dtype_of(HazardParams)),
    ("drifter", DRIFTER),
    ("guidance", dtype_of(GuidanceParams)),
    ("check_out", CHECK_OUT),
    ("control", dtype_of(ControlParams)),
    ("estimation", dtype_of(EstimationParams)),
    ("imu_delay", "f8"),  # s: age of a reading of the inertial unit when it arrives
    ("diagnosis", dtype_of(DiagnosisParams)),
    ("allocation", dtype_of(AllocationParams)),
    ("modulation", dtype_of(ModulationParams)),
    ("mission", MISSION),
    ("reference", REFERENCE),
    ("plan", ENTRY_LAWS.tables),
)

#: The memories of the modules of the flight software.  Only the cycle has access to all; each module gets its
#: own, and the others in its signature.
FSW = record(
    ("mission", SEQUENCE),
    ("landing_point", LANDING_POINT),
    ("guidance", GUIDANCE),
    ("control", CONTROL),
    ("health", HEALTH),
    ("vehicle", VEHICLE_STATE),
    ("nav", NAV),
    ("guide", GUIDE),
    ("disturbance", DISTURBANCE),
    ("demand", DEMAND),
    ("estimation", ESTIMATION),
    ("diagnosis", DIAGNOSIS),
    ("check_out", CHECK_OUT_MEMORY),
    ("navigation", NAVIGATION),
    ("drag_filter", DRAG_FILTER),
    ("wind", WIND_ESTIMATE),
    ("effectiveness", EFFECTIVENESS),
    ("allocation", ALLOCATION),
    ("modulation", MODULATION),
    ("command", COMMAND),
    ("external", EXTERNAL),
    ("own", OWN),
    ("hazard", HAZARD),  # by far the largest
)
