"""Aerodynamic tables in csv: what is read, and what is wrong with file, line and column."""

import numpy as np
import pytest

from edl6dof.interchange.aero_table import read_aero_csv
from edl6dof.vehicle.aerodynamics.body import BodyAeroParams
from edl6dof.vehicle.aerodynamics.body_table import body_inputs, build_body_table, of_csv
from edl6dof.vehicle.aerodynamics.capsule_table import read_static_table

HEADING = "# remark\nalpha_deg,mach,Cm_xcg0253,CL,CD\n"
FULL = HEADING + "0,1,0,0,1.5\n4,1,-0.1,-0.2,1.4\n0,2,0,0,1.6\n4,2,-0.1,-0.3,1.5\n"


def read(tmp_path, text):
    path = tmp_path / "aero.csv"
    path.write_text(text, encoding="utf-8")
    return read_aero_csv(path, path.read_bytes())


def test_columns_in_any_order_and_drag_and_lift_turned_to_axes_of_the_body(tmp_path):
    table = read(tmp_path, FULL)
    assert table.mach.tolist() == [1.0, 2.0] and table.alpha_deg.tolist() == [0.0, 4.0] and not table.has_beta
    c, s = np.cos(np.radians(4.0)), np.sin(np.radians(4.0))
    axial, _, normal, _, pitching, _ = table.values[1, 1, 0]
    assert (axial, normal) == pytest.approx((1.5 * c + 0.3 * s, 1.5 * s - 0.3 * c)) and pitching == -0.1
    mach, alpha, static = read_static_table(str(tmp_path / "aero.csv"))
    assert np.array_equal(static, table.values[:, :, 0][..., [0, 2, 4]]) and len(mach) == len(alpha) == 2


def test_body_of_revolution_is_turned_into_both_angles(tmp_path):
    rows = [f"{m},{a},{1.5 - 0.01 * a},{0.02 * a},{-0.01 * a}" for m in (1, 5) for a in (0, 90, 180)]
    path = tmp_path / "aero.csv"
    path.write_text("mach,alpha_deg,CA,CN,Cm\n" + "\n".join(rows), encoding="utf-8")
    found = of_csv(path, path.read_bytes())
    alpha, beta = int(np.argmin(abs(found.alpha_deg - 45.0))), int(np.argmin(abs(found.beta_deg)))
    assert found.static[0, alpha, beta] == pytest.approx([-1.05, 0.0, -0.9, 0.0, -0.45, 0.0])
    side = int(np.argmin(abs(found.beta_deg - 45.0)))
    ahead = int(np.argmin(abs(found.alpha_deg)))
    assert found.static[0, ahead, side] == pytest.approx([-1.05, -0.9, 0.0, 0.0, 0.0, 0.45])


def test_both_angles_are_taken_as_they_are(tmp_path):
    rows = [
        f"{m},{a},{b},{1 + 0.1 * b * a},{0.5 * a},{0.1 * b},{0.2 * b},{-0.3 * a},{0.4 * b}"
        for m in (1, 2)
        for a in (-5, 5)
        for b in (-2, 0, 2)
    ]
    path = tmp_path / "aero.csv"
    path.write_text("mach,alpha_deg,beta_deg,CA,CN,CY,Cl,Cm,Cn\n" + "\n".join(rows), encoding="utf-8")
    record = build_body_table(body_inputs(BodyAeroParams(file=str(path)), 1.4, sheds=False))[0]
    assert (record["n_mach"], record["n_alpha"], record["n_beta"]) == (2, 2, 3)
    # Mach 2, alpha 5, beta 2: the last point
    assert record["static"][11] == pytest.approx([-2.0, 0.2, -2.5, 0.4, -1.5, 0.8])


@pytest.mark.parametrize(
    "text, words",
    [
        ("", "is empty"),
        ("mach,alpha_deg,CD,CL,Cm\n", "no row"),
        ("1,0,1.5,0,0\n", "needs a heading"),
        ("mach,alpha_deg,CD,CL\n1,0,1,0\n", ":1:1: lacks the column Cm"),
        ("Mach_number,alpha_deg,CD,CL,Cm\n", "lacks the column mach; is it the one called 'Mach_number'"),
        ("mach,alpha_deg,CD,Cm\n1,0,1,0\n", "lacks the columns CD and CL, or CA and CN"),
        ("mach,alpha_deg,CD,CL,Cm,thrust\n", "unknown column 'thrust'"),
        ("mach,alpha_deg,CD,CL,Cm,Cm\n", "Cm stands twice"),
        (FULL.replace("1.4", "many"), ":4:15: CD: must be a finite number (got 'many')"),
        (FULL.replace("1.4", "nan"), ":4:15: CD: must be a finite number (got 'nan')"),
        (FULL.replace(",1.4", ""), ":4:1: has 4 entries, its heading 5"),
        (
            FULL.replace("4,2,-0.1,-0.3,1.5\n", ""),
            "not a complete Mach x alpha table: mach 2, alpha_deg 4",
        ),
        (FULL + "4,2,0,0,1\n", ":7: gives the same point as line 6"),
        ("mach,alpha_deg,CD,CL,Cm\n1,0,1,0,0\n1,4,1,0,0\n", "at least two Mach numbers"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, text, words):
    with pytest.raises(ValueError) as error:
        read(tmp_path, text)
    assert words in str(error.value) and "aero.csv" in str(error.value)


def test_negative_total_angle_is_refused(tmp_path):
    path = tmp_path / "aero.csv"
    path.write_text(FULL.replace("0,1,0", "-1,1,0").replace("0,2,0", "-1,2,0"), encoding="utf-8")
    with pytest.raises(ValueError, match="begins at 0"):
        of_csv(path, path.read_bytes())
