"""Shape that faces the air, and the convention of every aerodynamic model.

Every model takes the air-relative velocity (u, v, w) in body axes `B` (x forward through the nose, y right, z
down, m/s), the dynamic pressure ``qbar`` (Pa) and the rates (p, q, r) (rad/s), and returns (Fx, Fy, Fz, Mx,
My, Mz) in `B` (N, N m).  Moments are about a point on the x axis: ``table.moment_reference_x`` (capsule),
``bluff.centre_of_pressure_x``, ``constant.moment_reference_x``.  The caller adds (r_ref - r_cg) x F;
:func:`edl6dof.vehicle.aerodynamics.wrench.aerodynamic_wrench` returns the station as well.

Axisymmetric bodies are described by the total angle aT between velocity and +x, 0..pi, and the direction e =
(0, v, w)/|(v, w)|: F = qbar A (-CA, -CN e_y, -CN e_z), M = qbar A D Cm (0, e_z, -e_y).  CN and Cm vanish with
aT: zero lateral velocity is regular.
"""

from __future__ import annotations

from typing import Literal, get_args

#: What a part shows to the air: nothing, so that the bare lander flies; the whole capsule, heat shield ahead;
#: the open backshell with the lander inside.
Shape = Literal["none", "capsule", "backshell"]
SHAPES: tuple[Shape, ...] = get_args(Shape)
CONFIG_LANDER, CONFIG_CAPSULE, CONFIG_BACKSHELL = range(len(SHAPES))

#: Speed relative to the air (m/s) below which a body feels no force of it.
MIN_SPEED = 1e-9
