"""What a fault is about: one component of the vehicle, a thruster, a surface, an engine or a parachute."""

from __future__ import annotations

from typing import ClassVar, Literal, get_args

from edl6dof.config.base import Params

#: Kinds of component; a fault names the one it acts on under the key of the same name.
Component = Literal["thruster", "surface", "engine", "parachute"]
COMPONENTS: tuple[Component, ...] = get_args(Component)


class ComponentFault(Params):
    """Parameters of a fault of one component."""

    component: ClassVar[Component]


class ThrusterFault(ComponentFault):
    """Parameters of a fault of one thruster."""

    component: ClassVar[Component] = "thruster"


class SurfaceFault(ComponentFault):
    """Parameters of a fault of one surface."""

    component: ClassVar[Component] = "surface"


class EngineFault(ComponentFault):
    """Parameters of a fault of one engine."""

    component: ClassVar[Component] = "engine"


class ParachuteFault(ComponentFault):
    """Parameters of a fault of one parachute."""

    component: ClassVar[Component] = "parachute"
