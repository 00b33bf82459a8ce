"""Coefficients of two capsules from their shapes alone compared with published ones: the 70-degree Phoenix,
over Mach number and angle, and the axial force of the 60-degree Stardust in hypersonic flow.

Nothing is flown.  Newtonian flow depends on shape and stagnation pressure, but has no detached shock, sonic
line or separation; the table shows the resulting errors.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import edl6dof
from edl6dof.studies.frame import Curve, Finding, Grid, Line, Panel, Report, Session, Study
from edl6dof.vehicle.aerodynamics.capsule import CapsuleParams
from edl6dof.vehicle.aerodynamics.capsule_table import read_static_table
from edl6dof.vehicle.aerodynamics.newtonian import capsule_rings, newtonian_coefficients

#: Shape of Phoenix: diameter 2.65 m, nose D/4, shoulder D/40 as printed; the afterbody is an estimate.
_FRONT: dict[str, Any] = {"diameter_m": 2.65, "nose_radius_m": 0.6638, "shoulder_radius_m": 0.0662}
_AFT: dict[str, Any] = {"backshell_break_radius_m": 0.8, "backshell_base_radius_m": 0.35}
PHOENIX = CapsuleParams(coefficients="newtonian", **_FRONT, **_AFT)
#: Axial force coefficient of Stardust's capsule at no angle, by computed flow.
STARDUST_CA = ((10.5, 1.515), (12.2, 1.4992), (17.1, 1.4939), (24.7, 1.4816), (35.4, 1.4828), (40.0, 1.4959),
               (42.7, 1.464))  # fmt: skip
SHOWN = (0.4, 0.8, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 8.8, 13.9, 20.3, 28.0)
ANGLE_DEG = 11.0
REGIMES = (("below Mach 1", 0.0, 1.0), ("Mach 1 to 5", 1.0, 5.0), ("Mach 5 to 15", 5.0, 15.0),
           ("Mach 15 to 30", 15.0, 31.0))  # fmt: skip
REMARKS = (
    "Phoenix: CD, CL and Cm of AIAA 2008-7219, second hand, as shipped; its afterbody is not printed there.",
    "Stardust: computed flow of AIAA 97-2304, second hand, from the public asim; 0.813 m, nose 0.2286 m.",
    "One ratio of specific heats stands for the shock layer, that of the planet's file: 1.33 on Mars, 1.4 on "
    "Earth.",
    "The pitching moment about the centre of mass is small beside its parts: its slope is off by most.",
)


def run(session: Session) -> Report:
    """Compute the coefficients of both shapes once; no flights are repeated."""
    mach, alpha, published = read_static_table("phoenix_70deg_static_aero.csv")
    gas = edl6dof.load("tianwen1").scenario.planet.gas
    size = (PHOENIX.diameter_m, PHOENIX.moment_reference_x_over_d * PHOENIX.diameter_m)
    rings, ratio = capsule_rings(PHOENIX), gas.shock_layer_heat_capacity_ratio
    own = newtonian_coefficients(rings, np.radians(alpha), mach, ratio, size)
    stardust = edl6dof.load("stardust").scenario
    others = np.array([m for m, _ in STARDUST_CA])
    shape = stardust.vehicle.aero.capsule.model_copy(update={"diameter_m": 0.813})
    earth = stardust.planet.gas.shock_layer_heat_capacity_ratio
    axial = newtonian_coefficients(capsule_rings(shape), np.zeros(1), others, earth, (0.813, 0.0))[:, 0, 0]
    names = [f"{of}_{name}" for of in ("published", "newtonian") for name in ("ca", "cn", "cm")]
    both, rows = np.concatenate([published, own], axis=-1), []
    for m, a in np.ndindex(both.shape[:2]):
        about = {"mach": float(mach[m]), "alpha_deg": float(alpha[a])}
        rows.append({**about, **dict(zip(names, both[m, a].tolist(), strict=True))})
    error = np.abs(own[..., 0] / published[..., 0] - 1.0)
    findings = []
    for name, low, high in REGIMES:
        if (within := (mach >= low) & (mach < high)).any():
            largest = 100.0 * float(error[within].max())
            findings.append(Finding(f"Phoenix, largest error of CA, {name}", "%", largest))
    for (m, value), computed in zip(STARDUST_CA, axial.tolist(), strict=True):
        findings.append(Finding(f"Stardust, CA at Mach {m:g}", "", computed, value, within=0.1))
    shown = mach, alpha, published, own
    return Report(findings, rows, 1, [_grid(*shown)], REMARKS, _pictures(*shown))


def _grid(mach: np.ndarray, alpha: np.ndarray, published: np.ndarray, own: np.ndarray) -> Grid:
    """CA at no angle, and slopes per rad up to ``ANGLE_DEG``, of both, by Mach number."""
    end = int(np.flatnonzero(alpha == ANGLE_DEG)[0])
    rows: list[Line] = []
    for value in SHOWN:
        k = int(np.argmin(np.abs(mach - value)))
        pair = [(c[k, 0, 0], c[k, end, 1], c[k, end, 2]) for c in (published, own)]
        slopes = [(ca, cn / np.radians(ANGLE_DEG), cm / np.radians(ANGLE_DEG)) for ca, cn, cm in pair]
        (ca, cn, cm), (own_ca, own_cn, own_cm) = slopes
        off = 100.0 * (own_ca / ca - 1.0)
        rows.append((f"{mach[k]:g}", *map(float, (ca, own_ca, off, cn, own_cn, cm, own_cm))))
    heads = ("Mach", "CA publ.", "CA", "off %", "CN_a publ.", "CN_a", "Cm_a publ.", "Cm_a")
    return Grid(f"Phoenix: CA at no angle; CN and Cm per rad, mean to {ANGLE_DEG:g} deg", heads, rows)


def _pictures(mach: np.ndarray, alpha: np.ndarray, *tables: np.ndarray) -> dict[str, list[Panel]]:
    """CA and Cm over Mach number, published and computed."""
    end, moment = int(np.flatnonzero(alpha == ANGLE_DEG)[0]), f"Pitching moment at {ANGLE_DEG:g} deg"
    panels = []
    for title, label, angle, k in (("Axial force at no angle", "CA", 0, 0), (moment, "Cm", end, 2)):
        published, own = (table[:, angle, k] for table in tables)
        pair = Curve(mach, published, "published", "dots"), Curve(mach, own, "Newtonian")
        panels.append(Panel(title, "Mach number", label, pair))
    return {"phoenix": panels}


TITLE = "Coefficients from the shape alone beside published ones"
STUDY = Study("newtonian", TITLE, "Edquist et al. 2008; Mitcheltree et al. 1997", run)
