"""A toy scenario model with one example of everything the real one may contain."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from edl6dof.config.base import REQUIRED, Capacity, Params, Vec3, group, param, section
from edl6dof.config.document.document import Document
from edl6dof.config.document.source import parse_document
from edl6dof.config.validate import validate


class Mass(Params):
    entry_mass_kg: float = param(REQUIRED, "mass at entry", gt=0)
    cg_m: Vec3 = param((0.0, 0.0, 0.1), "centre of mass", status="estimate")
    fuel_fraction: float = param(0.25, "fuel over mass", ge=0, le=1, status="published", source="S1 table 2")


class Thruster(Params):
    name: str = param(REQUIRED, "label", record=False)
    thrust_n: float = param(25.0, "thrust", ge=0)
    position_m: Vec3 = param(REQUIRED, "where it sits")


class Rcs(Params):
    minimum_pulse_s: float = param(0.02, "shortest pulse", gt=0)
    thrusters: Annotated[list[Thruster], Capacity(3)] = param(REQUIRED, "thrusters", factory=list)


class Chute(Params):
    deploy_mach: float = param(1.8, "Mach number of deployment", gt=0, le=2.5)
    drag_table: tuple[tuple[float, float], ...] = param(((0.0, 0.6), (2.0, 0.5)), "Mach, drag", record=False)


class Apollo(Params):
    law: Literal["apollo"] = "apollo"
    gain: float = param(4.0, "overcontrol")


class Predictor(Params):
    law: Literal["predictor"] = "predictor"
    step_s: float = param(1.0, "step", gt=0)


class Vehicle(Params):
    mass: Mass = section("mass properties")
    rcs: Rcs = group(Rcs, "reaction control")
    chute: Chute = group(Chute, "parachute")


class Toy(Params):
    title: str = param("toy", "name of the run", record=False)
    seed: int = param(1, "random seed", ge=0)
    method: Literal["rk4", "euler", "heun"] = param("rk4", "integrator")
    logging: bool = param(True, "write telemetry")
    stop_s: float | None = param(None, "stop time", gt=0)
    window_s: tuple[float, float] = param((0.0, 10.0), "first and last time")
    guidance: Annotated[Apollo | Predictor, Field(discriminator="law")] = param(
        None, "guidance", factory=Apollo
    )
    rate_hz: Annotated[float, Field(gt=0)] | Literal["auto"] = param("auto", "sampling", record=False)
    limit_deg: float | list[float] | None = param(None, "limit, or one for each phase", record=False)
    gains: dict[str, float] = param(None, "free gains", factory=dict)
    plugin: dict[str, Any] = param(None, "free data", factory=dict)
    vehicle: Vehicle = section("the vehicle")

    @model_validator(mode="after")
    def _window_is_ordered(self) -> Toy:
        if self.window_s[0] >= self.window_s[1]:
            raise ValueError("window_s: the first time must be before the last")
        return self


GOOD = """\
title: demo
seed: 7
method: heun
stop_s: 1e3
vehicle:
  mass:  # [P] S1 section 7
    entry_mass_kg: 1285
    cg_m: [0, 0.0, 1.5e-1]  # [E]
  rcs:
    thrusters:
      - {name: D7, position_m: [1, 0, 0]}
      - name: D8
        thrust_n: 30  # [D] thrust curve
        position_m: [0, 1, 0]
"""

LEAST = "vehicle: {mass: {entry_mass_kg: 1.0}}\n"


def document(text: str = GOOD) -> Document:
    return parse_document(text, "toy.yaml")


def load(text: str = GOOD) -> Toy:
    return validate(Toy, document(text))


def write(folder: Path, name: str, text: str | bytes) -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path
