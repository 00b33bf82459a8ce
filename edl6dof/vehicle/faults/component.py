"""Component of the vehicle that a fault acts on, such as a thruster or a gyro."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf
from typing import ClassVar, Literal, get_args

from edl6dof.config.base import Params
from edl6dof.interface.effectors import Action, ThrusterFailure
from edl6dof.interface.roles import Role
from edl6dof.vehicle.vehicle import VehicleParams

#: Kinds of component; a fault names its component under the key of that kind, such as ``thruster: D7``.
Component = Literal[
    "thruster",
    "branch",
    "rcs",
    "surface",
    "engine",
    "parachute",
    "tank",
    "gyro",
    "accelerometer",
    "inertial_unit",
    "beam",
    "radar",
    "star_tracker",
    "flow_meter",
    "landing_camera",
    "lidar",
    "stereo",
    "landmark_camera",
]
COMPONENTS: tuple[Component, ...] = get_args(Component)
#: Kinds of component that measure.
INSTRUMENTS: tuple[Component, ...] = (
    *("gyro", "accelerometer", "inertial_unit", "beam", "radar", "star_tracker"),
    *("flow_meter", "landing_camera", "lidar", "stereo", "landmark_camera"),
)
#: Names of the components of each kind, in the order of their indices; kinds left out have none.
Components = Mapping[Component, Sequence[str]]


def vehicle_components(vehicle: VehicleParams) -> dict[Component, list[str]]:
    """Names of the components of a vehicle that may fail, instruments left out."""
    return {
        "thruster": [jet.name for jet in vehicle.rcs.thrusters],
        "branch": [branch.name for branch in vehicle.rcs.laid_branches],
        "rcs": ["rcs"] if vehicle.rcs.thrusters else [],
        "surface": [surface.name for surface in vehicle.surfaces],
        "engine": [engine.name for engine in vehicle.own_engines],
        "parachute": [chute.name for chute in vehicle.parachutes],
        "tank": [tank.name for tank in vehicle.tanks],
    }


class ComponentFault(Params):
    """Parameters of a fault of one component, whose kind is one of ``components``."""

    components: ClassVar[tuple[Component, ...]]
    #: Actions on the component, or on the part that carries it, after which the fault has no effect.
    over_after: ClassVar[tuple[Action, ...]] = ()
    #: Roles of the phases in which the fault can happen; empty: in all.
    happens_in: ClassVar[tuple[Role, ...]] = ()
    #: Failure that a correct fault isolation finds in each thruster; none for a fault of no thruster.
    failure: ClassVar[ThrusterFailure | None] = None
    #: Duration where a fault gives none, s; infinite: to the end of the flight.
    usual_duration_s: ClassVar[float] = inf
    #: False for a fault that cannot end, such as a lost part.
    ends: ClassVar[bool] = True

    @classmethod
    def sizes(cls, component: Component) -> list[dict[str, float]]:
        """Values of parameters that a matrix of faults sweeps for a kind of component; an empty item stands
        for the default values.
        """
        return [{}]


class ThrusterFault(ComponentFault):
    """Parameters of a fault of one thruster."""

    components: ClassVar[tuple[Component, ...]] = ("thruster",)


class BranchFault(ComponentFault):
    """Parameters of a fault of one propellant branch."""

    components: ClassVar[tuple[Component, ...]] = ("branch",)


class RcsFault(ComponentFault):
    """Parameters of a fault of all thrusters at once."""

    components: ClassVar[tuple[Component, ...]] = ("rcs",)


class SurfaceFault(ComponentFault):
    """Parameters of a fault of one surface."""

    components: ClassVar[tuple[Component, ...]] = ("surface",)


class EngineFault(ComponentFault):
    """Parameters of a fault of one engine."""

    components: ClassVar[tuple[Component, ...]] = ("engine",)
    over_after: ClassVar[tuple[Action, ...]] = ("cut_off",)


class ParachuteFault(ComponentFault):
    """Parameters of a fault of one parachute."""

    components: ClassVar[tuple[Component, ...]] = ("parachute",)
    over_after: ClassVar[tuple[Action, ...]] = ("release", "jettison")


class TankFault(ComponentFault):
    """Parameters of a fault of one tank."""

    components: ClassVar[tuple[Component, ...]] = ("tank",)
