"""Faults of one reading (gyro, accelerometer, beam, star tracker, flow meter) and of whole instruments.

Their effects are written to ``INSTRUMENT_FAULTS`` (:mod:`edl6dof.vehicle.plant`), which the sensors read in
the next cycle.
"""

from __future__ import annotations

from typing import ClassVar

from edl6dof.config.base import param
from edl6dof.interface.capacities import MAX_GYROS
from edl6dof.interface.roles import PARACHUTE, Role
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.component import COMPONENTS, Component, ComponentFault
from edl6dof.vehicle.plant import FALSE_LOCK, HARDOVER, OUTAGE, SATURATED, STUCK

GYRO, ACCELEROMETER, FLOW_METER = map(COMPONENTS.index, ("gyro", "accelerometer", "flow_meter"))
RADAR, STAR_TRACKER = map(COMPONENTS.index, ("radar", "star_tracker"))
CAMERA, LIDAR, STEREO = map(COMPONENTS.index, ("landing_camera", "lidar", "stereo"))


class ReadingFault(ComponentFault):
    """Parameters of a fault of one reading."""

    components: ClassVar[tuple[Component, ...]] = (
        *("gyro", "accelerometer", "beam", "star_tracker", "flow_meter"),
    )


#: First words of the names of the parameters that are the size of a fault, for each kind of component.
READINGS: dict[Component, tuple[str, ...]] = {
    "gyro": ("rate",),
    "accelerometer": ("acceleration",),
    "beam": ("range", "speed"),
    "star_tracker": ("attitude",),
    "flow_meter": ("flow",),
}


class SizedFault(ReadingFault):
    """Parameters of a fault of one reading by some amount."""

    #: Sizes of a sweep over the default value: three for each factor of ten.
    swept: ClassVar[tuple[float, ...]] = (1.0, 0.464, 0.215, 0.1, 0.0464, 0.0215, 0.01)

    @classmethod
    def sizes(cls, component: Component) -> list[dict[str, float]]:
        """Values of each parameter of a reading in turn, the others zero."""
        first = {name: field.default for name, field in cls.model_fields.items()
                 if name.split("_")[0] in READINGS[component]}  # fmt: skip
        return [
            {**dict.fromkeys(first, 0.0), name: float(f"{share * value:.3g}")}
            for name, value in first.items()
            for share in cls.swept
        ]


class CounterFault(ComponentFault):
    """Parameters of a fault of an instrument with a limited range."""

    components: ClassVar[tuple[Component, ...]] = ("gyro", "accelerometer")


class ReadingBiasParams(SizedFault):
    """The reading is too large by a constant."""

    rate_deg_s: float = param(0.05, "bias of a gyro", ge=-1e3, le=1e3)
    acceleration_m_s2: float = param(0.05, "bias of an accelerometer", ge=-1e3, le=1e3)
    range_m: float = param(20.0, "bias of the range of a beam", ge=-1e4, le=1e4)
    speed_m_s: float = param(2.0, "bias of the speed of a beam", ge=-1e3, le=1e3)
    attitude_deg: float = param(0.2, "bias of the attitude of a star tracker", ge=-90.0, le=90.0)
    flow_kg_s: float = param(0.02, "bias of a flow meter", ge=-10.0, le=10.0)


class ReadingDriftParams(SizedFault):
    """The reading has an error that grows linearly with time."""

    rate_deg_s2: float = param(0.01, "drift of a gyro", ge=-1e3, le=1e3)
    acceleration_m_s3: float = param(0.01, "drift of an accelerometer", ge=-1e3, le=1e3)
    range_m_s: float = param(2.0, "drift of the range of a beam", ge=-1e4, le=1e4)
    speed_m_s2: float = param(0.2, "drift of the speed of a beam", ge=-1e3, le=1e3)
    attitude_deg_s: float = param(0.05, "drift of the attitude of a star tracker", ge=-90.0, le=90.0)
    flow_kg_s2: float = param(0.002, "drift of a flow meter", ge=-10.0, le=10.0)


class ReadingNoiseParams(SizedFault):
    """The reading has more noise, independent from cycle to cycle; parameters: standard deviations."""

    rate_deg_s: float = param(0.5, "noise of a gyro", ge=0.0, le=1e3)
    acceleration_m_s2: float = param(0.5, "noise of an accelerometer", ge=0.0, le=1e3)
    range_m: float = param(20.0, "noise of the range of a beam", ge=0.0, le=1e4)
    speed_m_s: float = param(2.0, "noise of the speed of a beam", ge=0.0, le=1e3)
    attitude_deg: float = param(0.2, "noise of the attitude of a star tracker", ge=0.0, le=90.0)
    flow_kg_s: float = param(0.02, "noise of a flow meter", ge=0.0, le=10.0)


class ReadingStuckParams(ReadingFault):
    """The reading stays at its last value."""


class ReadingOutageParams(ReadingFault):
    """There is no reading: a counter stops, a star tracker sees no stars, a beam (or every beam of a radar)
    has no echo.
    """

    components: ClassVar[tuple[Component, ...]] = (*ReadingFault.components, "radar")


class HardoverParams(CounterFault):
    """The reading goes to the end of its range, without the flag of saturation."""


class SaturationParams(CounterFault):
    """The reading is at the end of its range, on the side of the true motion, with the flag of saturation."""


class GyrosSaturatedParams(ComponentFault):
    """All gyros are at the end of their range at once, as when a parachute opens."""

    components: ClassVar[tuple[Component, ...]] = ("inertial_unit",)
    happens_in: ClassVar[tuple[Role, ...]] = (PARACHUTE,)
    usual_duration_s: ClassVar[float] = 1.0


class FalseLockParams(ComponentFault):
    """The beam has an echo that is not of the ground."""

    components: ClassVar[tuple[Component, ...]] = ("beam",)

    range_m: float = param(100.0, "range that it reads", ge=0.0, le=1e5)
    speed_m_s: float = param(0.0, "speed that it reads", ge=-1e3, le=1e3)


class ImagesLostParams(ComponentFault):
    """The imager makes no images any more; a scan in progress ends."""

    components: ClassVar[tuple[Component, ...]] = ("landing_camera", "lidar", "stereo", "landmark_camera")


class MirrorStuckParams(ComponentFault):
    """The mirror of the lidar does not move: all rows of a scan show the same ground."""

    components: ClassVar[tuple[Component, ...]] = ("lidar",)


@kernel
def set_mode(fault, plant, mode):
    """Set the mode of the reading."""
    i, instruments = fault.component, plant.instruments
    if fault.of == GYRO:
        instruments.gyro[i].mode = mode
    elif fault.of == ACCELEROMETER:
        instruments.accelerometer[i].mode = mode
    elif fault.of == FLOW_METER:
        instruments.flow[i].mode = mode
    elif fault.of == STAR_TRACKER:
        instruments.stars[i].mode = mode
    else:
        instruments.range[i].mode = mode
        instruments.speed[i].mode = mode


@kernel
def set_offset(fault, plant, p, factor):
    """Offset the readings of the component by ``factor`` times the parameters ``p`` of its kind."""
    i, instruments = fault.component, plant.instruments
    if fault.of == GYRO:
        instruments.gyro[i].offset = factor * p.rate
    elif fault.of == ACCELEROMETER:
        instruments.accelerometer[i].offset = factor * p.acceleration
    elif fault.of == FLOW_METER:
        instruments.flow[i].offset = factor * p.flow
    elif fault.of == STAR_TRACKER:
        instruments.stars[i].offset = factor * p.attitude
    else:
        instruments.range[i].offset = factor * p.range
        instruments.speed[i].offset = factor * p.speed


@kernel
def reading_bias(fault, case, since, command, plant):
    """Add a constant."""
    set_offset(fault, plant, fault.params.reading_bias, 1.0)


@kernel
def reading_drift(fault, case, since, command, plant):
    """Add an error that has grown since the fault began."""
    set_offset(fault, plant, fault.params.reading_drift, plant.t - since)


@kernel
def reading_noise(fault, case, since, command, plant):
    """Add noise."""
    p, i, instruments = fault.params.reading_noise, fault.component, plant.instruments
    if fault.of == GYRO:
        instruments.gyro[i].noise = p.rate
    elif fault.of == ACCELEROMETER:
        instruments.accelerometer[i].noise = p.acceleration
    elif fault.of == FLOW_METER:
        instruments.flow[i].noise = p.flow
    elif fault.of == STAR_TRACKER:
        instruments.stars[i].noise = p.attitude
    else:
        instruments.range[i].noise = p.range
        instruments.speed[i].noise = p.speed


@kernel
def reading_stuck(fault, case, since, command, plant):
    """Hold the reading."""
    set_mode(fault, plant, STUCK)


@kernel
def reading_outage(fault, case, since, command, plant):
    """Read nothing."""
    if fault.of != RADAR:
        set_mode(fault, plant, OUTAGE)
        return
    radar, instruments = case.sensors.params.radar, plant.instruments
    for i in range(radar.n_beams):
        if radar.beams[i].radar == fault.component + 1:
            instruments.range[i].mode = OUTAGE
            instruments.speed[i].mode = OUTAGE


@kernel
def hardover(fault, case, since, command, plant):
    """Go to the end of the range."""
    set_mode(fault, plant, HARDOVER)


@kernel
def saturation(fault, case, since, command, plant):
    """Go to the end of the range, with the flag of saturation."""
    set_mode(fault, plant, SATURATED)


@kernel
def gyros_saturated(fault, case, since, command, plant):
    """Saturate every gyro."""
    for i in range(MAX_GYROS):
        plant.instruments.gyro[i].mode = SATURATED


@kernel
def false_lock(fault, case, since, command, plant):
    """Read something else than the ground."""
    p, i, instruments = fault.params.false_lock, fault.component, plant.instruments
    set_mode(fault, plant, FALSE_LOCK)
    instruments.range[i].offset, instruments.speed[i].offset = p.range, p.speed


@kernel
def images_lost(fault, case, since, command, plant):
    """Lose the images of an imager."""
    if fault.of == CAMERA:
        plant.instruments.camera_lost = 1
    elif fault.of == LIDAR:
        plant.instruments.lidar_lost = 1
    elif fault.of == STEREO:
        plant.instruments.stereo_lost = 1
    else:
        plant.instruments.landmarks_lost = 1


@kernel
def mirror_stuck(fault, case, since, command, plant):
    """Hold the mirror."""
    plant.instruments.mirror_stuck = 1


MEMBERS = (
    Member("reading_bias", ReadingBiasParams, {"inflict": reading_bias}, "drift of electronics"),
    Member("reading_drift", ReadingDriftParams, {"inflict": reading_drift}, "drift of electronics"),
    Member("reading_noise", ReadingNoiseParams, {"inflict": reading_noise}, "bad contact"),
    Member("reading_stuck", ReadingStuckParams, {"inflict": reading_stuck}, "latched electronics"),
    Member("reading_outage", ReadingOutageParams, {"inflict": reading_outage}, "lost supply or link"),
    Member("hardover", HardoverParams, {"inflict": hardover}, "short circuit"),
    Member("saturation", SaturationParams, {"inflict": saturation}, "motion beyond the range"),
    Member(
        "gyros_saturated",
        GyrosSaturatedParams,
        {"inflict": gyros_saturated},
        "Tolker-Nielsen, EXOMARS 2016 Schiaparelli Anomaly Inquiry, ESA DG-I/2017/546/TTN (2017)",
    ),
    Member("false_lock", FalseLockParams, {"inflict": false_lock}, "echo of a jettisoned part"),
    Member("images_lost", ImagesLostParams, {"inflict": images_lost}, "lost supply or link"),
    Member("mirror_stuck", MirrorStuckParams, {"inflict": mirror_stuck}, "jammed drive"),
)
