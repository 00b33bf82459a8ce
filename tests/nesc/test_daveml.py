"""DAVE-ML import: the NESC brick and cannonball, gridded tables, and files that are refused with file and
line.
"""

import time
from pathlib import Path

import numpy as np
import pytest
from daveml_text import HEAD, calculated, refusal, variable, write

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.interchange.daveml import read_daveml
from edl6dof.interchange.daveml_vehicle import static_table, vehicle_part

FILES = Path(edl6dof.__file__).parents[1] / "vehicles" / "nesc"
SLUG, FOOT = 14.593902937206364, 0.3048  # kg, m


def values(paths):
    """Values of DAVE-ML files, by dotted path below ``vehicle``."""
    return {path: value for path, (value, _) in vehicle_part(paths).items()}


def test_brick_from_its_own_files():
    data = values([FILES / "brick_inertia.dml", FILES / "brick_aero.dml"])
    assert data["mass.entry_kg"] == pytest.approx(0.155404754 * SLUG, rel=1e-14)
    expected = np.array([0.00189422, 0.006211019, 0.007194665]) * SLUG * FOOT**2
    assert data["mass.entry_inertia_kg_m2"] == pytest.approx(expected, rel=1e-14)
    assert data["mass.entry_centre_m"] == [0.0, 0.0, 0.0]
    constant = {path.removeprefix("aero.constant."): value for path, value in data.items()}
    assert data["aero.model"] == "constant"
    assert constant["reference_area_m2"] == pytest.approx(0.22222 * FOOT**2, rel=1e-14)
    assert constant["span_m"] == pytest.approx(0.33333 * FOOT, rel=1e-14)
    assert constant["chord_m"] == pytest.approx(0.66667 * FOOT, rel=1e-14)
    assert constant["drag_coefficient"] == 0.01
    for axis in ("roll", "pitch", "yaw"):
        assert constant[f"{axis}_damping"] == pytest.approx(-1.0, rel=1e-12)


def test_cannonball_from_its_own_files():
    data = values([FILES / "cannonball_inertia.dml", FILES / "cannonball_aero.dml"])
    assert data["mass.entry_kg"] == pytest.approx(SLUG, rel=1e-14)
    assert data["mass.entry_inertia_kg_m2"] == pytest.approx([3.6 * SLUG * FOOT**2] * 3, rel=1e-14)
    constant = {path.removeprefix("aero.constant."): value for path, value in data.items()}
    assert constant["reference_area_m2"] == pytest.approx(0.1963495 * FOOT**2, rel=1e-14)
    assert constant["drag_coefficient"] == 0.1
    assert [constant[f"{axis}_damping"] for axis in ("roll", "pitch", "yaw")] == [0.0, 0.0, 0.0]


def test_vehicle_file_takes_them_and_its_own_values_go_first():
    loaded = edl6dof.load("nesc/case03", ["vehicle.aero.constant.yaw_damping=-2"])
    constant = loaded.scenario.vehicle.aero.constant
    assert constant.drag_coefficient == 0.0  # vehicles/nesc_brick.yaml
    assert constant.yaw_damping == -2.0
    assert constant.roll_damping == pytest.approx(-1.0)
    assert {path.name for path in loaded.document.files} >= {"brick_inertia.dml", "brick_aero.dml"}
    assert (
        edl6dof.load("nesc/case03", ["vehicle=nesc_sphere"]).scenario.vehicle.aero.constant.drag_coefficient
        == 0.1
    )


def test_missing_file_is_named_at_its_line(tmp_path):
    (tmp_path / "v.yaml").write_text("name: v\ndaveml: [nothing.dml]\n", encoding="utf-8")
    with pytest.raises(
        ConfigError,
        match=(
            r"v\.yaml:2:\d+: vehicle\.daveml\.0: no such "
            r"file \(got 'nothing\.dml'"
        ),
    ):
        edl6dof.load("nesc/case06", [f"vehicle={tmp_path / 'v.yaml'}"])


GRID = (
    variable("mach", inner="<isInput/>")
    + variable("angleOfAttack", inner="<isInput/>", units="deg")
    + variable("referenceWingArea", 10.0, units="m2")
    + variable("totalCoefficientOfDrag")
    + variable("totalCoefficientOfLift")
    + calculated(
        "aeroBodyMomentCoefficient_Pitch",
        "<apply><times/><cn>-0.1</cn><ci>totalCoefficientOfLift</ci></apply>",
    )
    + """<breakpointDef bpID="M"><bpVals>0.5, 2, 10</bpVals></breakpointDef>
<breakpointDef bpID="A"><bpVals>0 4 8</bpVals></breakpointDef>
<griddedTableDef gtID="CD_T"><breakpointRefs><bpRef bpID="M"/><bpRef bpID="A"/></breakpointRefs>
<dataTable>1.0 0.9 0.8  1.5 1.4 1.3  1.7 1.6 1.5</dataTable></griddedTableDef>
<function name="CD"><independentVarRef varID="mach"/><independentVarRef varID="angleOfAttack"/>
<dependentVarRef varID="totalCoefficientOfDrag"/>
<functionDefn><griddedTableRef gtID="CD_T"/></functionDefn></function>
<function name="CL"><independentVarPts varID="angleOfAttack">0 8</independentVarPts>
<dependentVarPts varID="totalCoefficientOfLift">0.0 -0.4</dependentVarPts></function>"""
)


def test_gridded_table_is_interpolated_and_held(tmp_path):
    model = read_daveml(write(tmp_path, GRID))
    at = {"mach": 1.25, "angleOfAttack": 2.0}
    assert model.evaluate("totalCoefficientOfDrag", at) == pytest.approx(1.2)
    assert model.evaluate("totalCoefficientOfDrag", {"mach": 99.0, "angleOfAttack": -3.0}) == 1.7
    assert model.evaluate("aeroBodyMomentCoefficient_Pitch", at) == pytest.approx(0.01)


def test_gridded_table_becomes_the_static_table_of_a_capsule(tmp_path):
    path = write(tmp_path, GRID)
    mach, alpha, table = static_table(path)
    assert mach.tolist() == [0.5, 2.0, 10.0] and alpha.tolist() == [0.0, 4.0, 8.0]
    assert table[1, 2] == pytest.approx([1.3, -0.4, 0.04])
    data = values([path])
    assert data["aero.model"] == "capsule" and data["aero.capsule.diameter_m"] == pytest.approx(
        (40.0 / np.pi) ** 0.5
    )
    flown = edl6dof.load("tianwen1", [f"vehicle.aero.capsule.static_table={path}"])
    assert flown.scenario.vehicle.aero.capsule.static_table == str(path)


@pytest.mark.parametrize(
    "body, line, words",
    [
        ("<ungriddedTableDef utID='u'/>", 3, "<ungriddedTableDef> is not supported"),
        (calculated("a", "<apply><quotient/><cn>1</cn><cn>1</cn></apply>"), 3, "<quotient> is not supported"),
        (calculated("a", "<piecewise/>"), 3, "<piecewise> must hold <piece>"),
        (variable("a", 1.0) + variable("b", 1.0, "\n<array/>"), 5, "<array> is not supported"),
        (variable("a", "many"), 3, "must hold a finite number (got 'many')"),
        (variable("a", "nan"), 3, "must hold a finite number"),
        (calculated("a", "<ci>b</ci>"), 3, "unknown variable 'b'"),
        (calculated("a", "<ci>b</ci>") + calculated("b", "<ci>a</ci>"), 4, "depends on itself"),
        (variable("a", 1.0) * 2, 4, "defined twice"),
        (GRID.replace("0.5, 2, 10", "0.5, 2, 1"), 9, "ascending"),
        (GRID.replace("1.6 1.5<", "1.6<"), 12, "holds 8 numbers, its breakpoints ask for 9"),
        (
            GRID.replace('Ref varID="mach"', 'Ref varID="mach" interpolate="cubicSpline"'),
            13,
            "interpolate='cubicSpline'",
        ),
        (GRID.replace('gtID="CD_T"/>', 'gtID="CX"/>'), 15, "unknown table 'CX'"),
    ],
)
def test_what_is_not_supported_is_named_with_file_and_line(tmp_path, body, line, words):
    problem = refusal(write(tmp_path, body))
    assert words in problem.message
    if "itself" not in words:
        assert problem.line == line


@pytest.mark.parametrize(
    "old, new, words",
    [
        ('"Cl" units="nd">', '"Cl" units="ft">', "unit 'ft' is not one of number"),
        (
            '"CLR_DAMPING" units="_rad" initialValue="0.0"',
            '"CLR_DAMPING" units="_rad" initialValue="0.2"',
            "not of a supported form",
        ),
        (
            'varID="CL" units="nd" initialValue="0.0"',
            'varID="CL" units="nd" initialValue="0.1"',
            "not of a supported form",
        ),
        (
            'name="trueAirspeed"',
            'name="dynamicPressure"',
            "is not given: write it under vehicle.daveml_inputs",
        ),
    ],
)
def test_aerodynamics_that_a_vehicle_cannot_carry_are_refused(tmp_path, old, new, words):
    text = (FILES / "brick_aero.dml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "brick.dml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    problem = refusal(path, lambda file: vehicle_part([file]))
    assert words in problem.message and problem.line > 1


def test_products_of_inertia_are_taken(tmp_path):
    text = (FILES / "brick_inertia.dml").read_text(encoding="utf-8")
    path = tmp_path / "brick.dml"
    path.write_text(
        text.replace(
            'varID="XIZX" units="slugft2" initialValue="0.0"',
            'varID="XIZX" units="slugft2" initialValue="1e-4"',
        )
    )
    products = values([path])["mass.entry_products_kg_m2"]
    assert products == pytest.approx([0.0, 1e-4 * SLUG * FOOT**2, 0.0], rel=1e-14)


ENTITIES = {
    "external file": '<!DOCTYPE DAVEfunc [<!ENTITY x SYSTEM "file:///etc/hostname">]>',
    "external address": '<!DOCTYPE DAVEfunc [<!ENTITY x SYSTEM "http://127.0.0.1:9/x">]>',
    "parameter entity": '<!DOCTYPE DAVEfunc [<!ENTITY % x SYSTEM "file:///etc/hostname"> %x;]>',
    "billion laughs": "<!DOCTYPE DAVEfunc [<!ENTITY a0 'ha'>"
    + "".join(f"<!ENTITY a{i} '{f'&a{i - 1};' * 10}'>" for i in range(1, 12))
    + "]>",
}


@pytest.mark.parametrize("kind", ENTITIES)
@pytest.mark.parametrize("place", ["text", "attribute"])
def test_entities_are_refused_at_once(tmp_path, kind, place):
    reference = {"parameter entity": "", "billion laughs": "&a11;"}.get(kind, "&x;")
    body = variable(
        reference if place == "attribute" else "a",
        1.0,
        f"<description>{reference}</description>" if place == "text" else "",
    )
    head = HEAD.replace("\n<DAVE", f"\n{ENTITIES[kind]}\n<DAVE")
    start = time.perf_counter()
    problem = refusal(write(tmp_path, body, head=head))
    assert "entit" in problem.message.lower() and problem.line >= 2
    assert time.perf_counter() - start < 1.0


@pytest.mark.parametrize(
    "text, words",
    [
        ("", "is not well-formed XML"),
        ("<a>", "is not well-formed XML"),
        ("<a/>", "its root is <a>, not <DAVEfunc>"),
        ('<x:a xmlns:x="u"/>', "its root is <a>, not <DAVEfunc>"),
        ("<a>" * 100_000, "is nested more than 100 elements deep"),
        ('<!DOCTYPE a SYSTEM "a.dtd"><a>&x;</a>', "entities"),
        (HEAD + "</DAVEfunc>", ""),
    ],
)
def test_other_xml(tmp_path, text, words):
    path = tmp_path / "x.dml"
    path.write_text(text, encoding="utf-8")
    if words:
        assert words in refusal(path).message
    else:
        assert "holds neither mass properties" in refusal(path, lambda file: vehicle_part([file])).message
