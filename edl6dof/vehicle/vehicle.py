"""The vehicle file: all parameters of the true vehicle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, field_validator, model_validator

from edl6dof.config.base import (
    REQUIRED,
    Capacity,
    Hardware,
    Key,
    Title,
    Vec3,
    group,
    param,
    section,
    unique_names,
)
from edl6dof.config.errors import Inconsistent
from edl6dof.config.refused import Found, findings
from edl6dof.interface.capacities import MAX_ENGINES, MAX_PARACHUTES, MAX_PARTS, MAX_SURFACES, MAX_TANKS
from edl6dof.spatial.arrays import total
from edl6dof.vehicle.aerodynamics.surfaces import SurfaceParams
from edl6dof.vehicle.aerodynamics.wrench import AeroParams, BluffParams
from edl6dof.vehicle.landing_gear import LandingGearParams
from edl6dof.vehicle.mass import MassParams, Part, Tank, lander_problem
from edl6dof.vehicle.parachutes.parachute import ParachuteParams
from edl6dof.vehicle.propulsion.engine import EngineParams
from edl6dof.vehicle.propulsion.engine_models import THRUSTER_SET
from edl6dof.vehicle.propulsion.rcs import RcsParams, branch_problems

#: The body of the entry vehicle, and what is inside it; ``derived`` follows from the rest of the file.
BodyShape = Literal["derived", "sphere_cone", "sphere", "box", "none"]
LanderKind = Literal["derived", "legs", "platform", "rover", "crane", "none"]


class MeshFileParams(Hardware):
    """A mesh of the user's own, drawn in place of a shape."""

    file: str = param(
        REQUIRED,
        "glTF 2.0 (.glb, or self-contained .gltf) or STL (.stl), relative to the file that names it",
        record=False,
        min_length=1,
    )
    part: Key | None = param(
        None, "part that the mesh shows; none: the vehicle without its parts", record=False
    )
    scale: float = param(1.0, "metres per unit of the file", record=False, gt=0.0, le=1e4)
    origin_m: Vec3 = param((0.0, 0.0, 0.0), "position in B of the origin of the file", record=False)
    yaw_pitch_roll_deg: Vec3 = param(
        (0.0, 0.0, 0.0), "turns about z, y, x that carry B into the axes of the file", record=False
    )


class VehicleAppearanceParams(Hardware):
    """Shapes in pictures; omitted values follow from mass, aerodynamics and landing gear."""

    body: BodyShape = param(
        "derived",
        "shape at entry; derived: the sphere-cone of aero.model capsule; else none of an uncovered lander, a "
        "sphere for equal moments of inertia, a sphere-cone for two equal ones, else a box",
        record=False,
    )
    nose_x_m: float = param(0.0, "station of the nose of a sphere-cone in B", record=False)
    diameter_m: float | None = param(
        None, "largest diameter; none: of the aerodynamics' capsule or area", record=False, gt=0.0
    )
    nose_radius_m: float | None = param(
        None, "radius of the nose; none: of the capsule, or vehicle.nose_radius_m", record=False, gt=0.0
    )
    shoulder_radius_m: float | None = param(
        None, "radius of the shoulder; none: of the capsule, or D/40", record=False, ge=0.0
    )
    cone_half_angle_deg: float | None = param(
        None, "half angle of the forebody; none: of the capsule, or 70", record=False, gt=10.0, lt=90.0
    )
    backshell_m: list[tuple[float, float]] = param(
        None,
        "corners of the afterbody: distance behind the shoulder, and radius; none: the capsule's two cones, "
        "or flat",
        record=False,
        factory=list,
        max_length=20,
    )
    size_m: Vec3 | None = param(
        None, "sides of a box along x, y, z; none: those of a solid with the vehicle's inertia", record=False
    )
    lander: LanderKind = param(
        "derived",
        "lander inside the aeroshell; derived: legs where there are footpads, else a platform where "
        "there are engines, else none",
        record=False,
    )
    meshes: list[MeshFileParams] = param(
        None, "meshes drawn in place of these shapes", record=False, factory=list, max_length=8
    )


#: Parameters that a vehicle must state for each aerodynamic model or shape that it flies.
STATED = {
    "capsule": ("diameter_m", "nose_radius_m"),
    "constant": ("reference_area_m2", "drag_coefficient"),
    "lift_drag": ("reference_area_m2", "drag_coefficient", "lift_to_drag"),
    "body": ("file",),
    "backshell": tuple(BluffParams.model_fields),
    "lander": tuple(BluffParams.model_fields),
}
#: Largest relative difference of an engine's thrust and the sum of its thrusters', which are dispersed.
_AS_BELIEVED = 0.1


def _or_daveml(schema: dict[str, Any]) -> None:
    """Let editors accept files that leave ``mass`` and ``aero`` to DAVE-ML, which is read first."""
    own = [name for name in schema["required"] if name not in ("mass", "aero")]
    schema["anyOf"] = [{"required": ["mass", "aero"]}, {"required": ["daveml"]}]
    schema["required"] = own


class VehicleParams(Hardware):
    """An entry vehicle and everything that leaves it."""

    model_config = ConfigDict(json_schema_extra=_or_daveml)

    name: Title = param(REQUIRED, "name of the vehicle", record=False)
    daveml: list[str] = param(
        None,
        "DAVE-ML files that give mass and aero; values in the YAML take precedence",
        record=False,
        factory=list,
    )
    daveml_inputs: dict[str, float] = param(
        None,
        "inputs of those files other than the flow, such as deflections: values by name, in their units",
        record=False,
        factory=dict,
    )
    nose_radius_m: float = param(
        0.85, "effective nose radius for heating", status="estimate", source="D/4", gt=0.0
    )
    mass: MassParams = section("mass properties")
    parts: Annotated[list[Part], Capacity(MAX_PARTS)] = param(
        None, "parts that can be jettisoned, the outermost first", factory=list, max_length=MAX_PARTS
    )
    tanks: Annotated[list[Tank], Capacity(MAX_TANKS)] = param(
        None, "propellant tanks; empty for none", factory=list, max_length=MAX_TANKS
    )
    aero: AeroParams = section("aerodynamics")
    surfaces: Annotated[list[SurfaceParams], Capacity(MAX_SURFACES)] = param(
        None, "surfaces that unfold, such as a trim wing", factory=list, max_length=MAX_SURFACES
    )
    rcs: RcsParams = group(RcsParams, "reaction-control thrusters")
    engines: Annotated[list[EngineParams], Capacity(MAX_ENGINES)] = param(
        None, "landing engines, throttled together", factory=list, max_length=MAX_ENGINES
    )
    parachutes: Annotated[list[ParachuteParams], Capacity(MAX_PARACHUTES)] = param(
        None, "parachutes, flown one after the other", factory=list, max_length=MAX_PARACHUTES
    )
    landing_gear: LandingGearParams = group(LandingGearParams, "landing legs")
    appearance: VehicleAppearanceParams = group(
        VehicleAppearanceParams, "shapes in pictures; no flight depends on them", record=False
    )

    _names_differ = field_validator("parts", "tanks", "surfaces", "engines", "parachutes")(unique_names)

    @model_validator(mode="after")
    def _parts_fit(self) -> VehicleParams:
        if problems := findings(_CHECKS, self):
            raise Inconsistent(problems)
        return self

    @property
    def engine_groups(self) -> dict[str, list[str]]:
        """Names of the engines that events light and cut off together, by the name of their group."""
        found: dict[str, list[str]] = {}
        for engine in self.engines:
            if engine.group is not None:
                found.setdefault(engine.group, []).append(engine.name)
        return found

    def showing(self, shape: str) -> Part | None:
        """The first part with this ``shape`` in the flow."""
        return next((part for part in self.parts if part.shape == shape), None)

    @property
    def own_engines(self) -> list[EngineParams]:
        """Engines with a nozzle of their own, without an engine that is made of thrusters."""
        return [engine for engine in self.engines if engine.model != THRUSTER_SET.name]

    @property
    def main_parachute(self) -> ParachuteParams:
        """The parachute flown last."""
        return self.parachutes[-1]


def _mass_problems(vehicle: VehicleParams) -> Iterator[Found]:
    if words := lander_problem(vehicle.mass, tuple(vehicle.parts), tuple(vehicle.tanks)):
        yield "mass", words


def _capsule_problems(vehicle: VehicleParams) -> Iterator[Found]:
    if vehicle.aero.model == "capsule" and vehicle.showing("capsule") is None:
        yield "parts", "aero.model capsule flies as long as a part with shape: capsule is attached"


def _unstated_aero(vehicle: VehicleParams) -> Iterator[Found]:
    """Require the values of the shapes flown: a default would be another vehicle's."""
    flown: list[str] = [vehicle.aero.model] if vehicle.aero.model in STATED else []
    flown += ["backshell"] if vehicle.showing("backshell") else []
    flown += ["lander"] if vehicle.aero.model == "capsule" and vehicle.engines else []
    for shape in flown:
        for key in STATED[shape]:
            if key not in getattr(vehicle.aero, shape).model_fields_set:
                yield f"aero.{shape}.{key}", "required key is missing"


def _part_problems(vehicle: VehicleParams) -> Iterator[Found]:
    """Require the parts that parachutes, surfaces and meshes name."""
    names = [part.name for part in vehicle.parts]
    named = {f"parachutes.{k}.pack": one.pack for k, one in enumerate(vehicle.parachutes)}
    named |= {f"parachutes.{k}.carried_by": one.carried_by for k, one in enumerate(vehicle.parachutes)}
    named |= {f"surfaces.{k}.carried_by": one.carried_by for k, one in enumerate(vehicle.surfaces)}
    named |= {f"appearance.meshes.{k}.part": one.part for k, one in enumerate(vehicle.appearance.meshes)}
    for place, part in named.items():
        if part is not None and part not in names:
            yield place, f"no part named {part!r}; names: {', '.join(names) or 'none'}"


def _feed_problems(vehicle: VehicleParams) -> Iterator[Found]:
    """Require the tanks that engines or thrusters name."""
    drawing = {f"engines.{k}": one.draws_from for k, one in enumerate(vehicle.engines)}
    drawing |= {f"rcs.thrusters.{k}": one.draws_from for k, one in enumerate(vehicle.rcs.thrusters)}
    names = [tank.name for tank in vehicle.tanks]
    for place, drawn in drawing.items():
        for k, name in enumerate(drawn):
            if name not in names:
                yield (
                    f"{place}.draws_from.{k}",
                    f"no tank named {name!r}; names: {', '.join(names) or 'none'}",
                )


def _branch_problems(vehicle: VehicleParams) -> Iterator[Found]:
    laid = branch_problems(vehicle.rcs.branches, [jet.name for jet in vehicle.rcs.thrusters])
    yield from ((f"rcs.{place}", words) for place, words in laid.items())


def _engine_problems(vehicle: VehicleParams) -> Iterator[Found]:
    for k, engine in enumerate(vehicle.engines):
        low, high = engine.throttle_min_n, engine.throttle_max_n
        if engine.model == "throttled" and high == 0.0:
            yield f"engines.{k}.throttle_max_n", "a throttled engine needs its band"
        elif low > high:
            yield f"engines.{k}.throttle_min_n", f"must not be above throttle_max_n {high:g} (got {low:g})"
        elif high > engine.full_thrust_n:
            words = f"must not be above full_thrust_n {engine.full_thrust_n:g} (got {high:g})"
            yield f"engines.{k}.throttle_max_n", words
        if engine.direction[0] * vehicle.engines[0].direction[0] < 0.0:
            yield f"engines.{k}.direction", "must push the same way along x as the first engine"
        if engine.group in [other.name for other in vehicle.engines]:
            yield f"engines.{k}.group", f"must not be the name of an engine (got {engine.group!r})"


def _thruster_set_problems(vehicle: VehicleParams) -> Iterator[Found]:
    """Limit number, place and thrust of engines made of thrusters."""
    sets = [k for k, engine in enumerate(vehicle.engines) if engine.model == THRUSTER_SET.name]
    jets = [jet for jet in vehicle.rcs.thrusters if sets and jet.group == "axial"]
    axial = total(-jet.thrust_n * jet.direction[0] for jet in jets)
    for k in sets:
        full = vehicle.engines[k].full_thrust_n
        if abs(full - axial) > _AS_BELIEVED * full:
            words = f"must be what the axial thrusters give along -x together, {axial:.1f} (got {full:g})"
            yield f"engines.{k}.full_thrust_n", words
    if sets and (len(sets) > 1 or sets[0] != len(vehicle.engines) - 1):
        yield "engines", f"at most one is a {THRUSTER_SET.name}, the last of the list"


_CHECKS: tuple[Callable[[VehicleParams], Iterable[Found]], ...] = (
    _mass_problems,
    _capsule_problems,
    _unstated_aero,
    _part_problems,
    _feed_problems,
    _branch_problems,
    _engine_problems,
    _thruster_set_problems,
)


def carriers(vehicle: VehicleParams) -> list[int]:
    """Index of the part that each surface leaves with; -1 where it stays on the vehicle."""
    index = {None: -1} | {part.name: number for number, part in enumerate(vehicle.parts)}
    return [index[surface.carried_by] for surface in vehicle.surfaces]


def fill_suspension(record: np.ndarray, vehicle: VehicleParams) -> None:
    """Fill the ``SUSPENSION`` records of a vehicle's parachutes, shape (MAX_PARACHUTES,)."""
    index = {None: -1} | {part.name: number for number, part in enumerate(vehicle.parts)}
    record["pack"] = record["carrier"] = -1
    for slot, chute in zip(record, vehicle.parachutes, strict=False):
        slot["pack"], slot["carrier"] = index[chute.pack], index[chute.carried_by]
