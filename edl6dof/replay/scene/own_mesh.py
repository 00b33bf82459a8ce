"""What shows a piece of the vehicle: the user's own mesh where the vehicle file names one, else the drawn
shape.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from edl6dof.interchange.mesh_file import read_mesh_file
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.scene.mesh import Mesh
from edl6dof.spatial import rotations as turns
from edl6dof.vehicle.appearance import MeshFileParams, VehicleAppearanceParams


def mesh_of(look: VehicleAppearanceParams, part: str | None) -> MeshFileParams | None:
    """The mesh that shows a part; of ``None``, all that is not a part."""
    return next((mesh for mesh in look.meshes if mesh.part == part), None)


def shown(recorder: Recorder, part: str | None, mesh: Mesh, **more: Any) -> list[Any]:
    """A part as rerun takes it; ``more`` goes with the drawn shape alone."""
    own = mesh_of(recorder.vehicle.appearance, part)
    return [recorder.mesh(mesh, **more)] if own is None else asset(recorder, own)


def asset(recorder: Recorder, own: MeshFileParams) -> list[Any]:
    """A mesh of the user's own, in its place in B."""
    file = read_mesh_file(Path(own.file))
    yaw, pitch, roll = np.radians(own.yaw_pitch_roll_deg)
    turn = turns.multiply(turns.multiply(_about(2, yaw), _about(1, pitch)), _about(0, roll))
    place = recorder.rr.Transform3D(
        translation=own.origin_m, quaternion=turns.xyzw(turn), scale=np.full(3, own.scale)
    )
    return [recorder.rr.Asset3D(contents=file.content, media_type=file.media_type), place]


def _about(axis: int, angle: float) -> np.ndarray:
    turn = np.zeros(4)
    turn[0], turn[1 + axis] = np.cos(0.5 * angle), np.sin(0.5 * angle)
    return turn
