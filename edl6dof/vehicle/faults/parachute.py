"""Faults of one parachute: a mortar that is late or dead, a torn canopy, a torn riser."""

from __future__ import annotations

from typing import ClassVar

from edl6dof.config.base import param
from edl6dof.interface.events import DEPLOY, Action
from edl6dof.kernels import kernel
from edl6dof.registry import Member
from edl6dof.vehicle.faults.commanded_events import prevent, put_off
from edl6dof.vehicle.faults.component import ParachuteFault
from edl6dof.vehicle.motion.staging import release


class ParachuteDelayParams(ParachuteFault):
    """The mortar fires late."""

    over_after: ClassVar[tuple[Action, ...]] = ("deploy",)

    delay_s: float = param(3.0, "time lost", gt=0.0, le=600.0)


class ParachuteDeadParams(ParachuteFault):
    """The mortar does not fire."""

    over_after: ClassVar[tuple[Action, ...]] = ("deploy",)


class CanopyTornParams(ParachuteFault):
    """The canopy loses part of its drag area, at once or as it opens."""

    area_factor: float = param(0.7, "drag area left", ge=0.0, lt=1.0)


class RiserTornParams(ParachuteFault):
    """The riser parts: the canopy goes, at once or when it is out."""


@kernel
def parachute_delay(fault, case, since, command, plant):
    """Put the deployment off when it is commanded."""
    delay = fault.params.parachute_delay.delay
    put_off(case, command, plant, action=DEPLOY, component=fault.component, delay=delay)


@kernel
def parachute_dead(fault, case, since, command, plant):
    """Let the deployment not happen."""
    prevent(case, plant, DEPLOY, fault.component)


@kernel
def canopy_torn(fault, case, since, command, plant):
    """Take part of the area away."""
    plant.canopy_lost[fault.component] = 1.0 - fault.params.canopy_torn.area_factor


@kernel
def riser_torn(fault, case, since, command, plant):
    """Let the canopy go."""
    release(case, plant, fault.component)


MEMBERS = (
    Member("parachute_delay", ParachuteDelayParams, {"inflict": parachute_delay}, "late mortar"),
    Member("parachute_dead", ParachuteDeadParams, {"inflict": parachute_dead}, "dead mortar"),
    Member(
        "canopy_torn",
        CanopyTornParams,
        {"inflict": canopy_torn},
        "torn gores, as of LDSD 2014 and 2015 and in drop tests of ExoMars 2019; from memory",
    ),
    Member("riser_torn", RiserTornParams, {"inflict": riser_torn}, "structural failure"),
)
