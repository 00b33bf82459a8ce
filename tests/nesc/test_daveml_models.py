"""DAVE-ML models that depend on more than the flow: pieces by a condition, deflections, fuel used, a centre
of mass that moves.  Written here against the constructs of NASA's F-16 and two-stage rocket models.
"""

from math import radians

import numpy as np
import pytest
from daveml_text import apply, calculated, refusal, table, variable, write

import edl6dof
from edl6dof.interchange.daveml import read_daveml
from edl6dof.interchange.daveml_aero import sampled_model
from edl6dof.interchange.daveml_vehicle import vehicle_part

LIMITS = ((64, 96, 96), 60_000)

#: Pieces stand in an apply of their own, as in NASA's files, and without one.
STAGED = "<apply><gt/><ci>staged</ci><cn>0</cn></apply>"
FRACTION = apply("divide", apply("minus", "<cn>180</cn>", "<ci>used</ci>"), "<cn>180</cn>")


def pieces(first, other, wrapped=True):
    inner = f"<piecewise><piece>{first}{STAGED}</piece><otherwise>{other}</otherwise></piecewise>"
    return f"<apply>{inner}</apply>" if wrapped else inner


ROCKET_MASS = (
    variable("rocketHasStaged", identifier="staged")
    + variable("fuelUsed", identifier="used", units="kg")
    + calculated("fractionLeft", FRACTION, identifier="left", units="frac").replace(
        'units="frac"', 'units="frac" minValue="0" maxValue="1"'
    )
    + calculated(
        "totalMass",
        pieces("<cn>99</cn>", apply("plus", "<cn>134</cn>", apply("times", "<cn>180</cn>", "<ci>left</ci>"))),
        units="kg",
    )
    + calculated(
        "vrsPositionOfCM_X",
        pieces(
            "<cn>4.8</cn>",
            apply("plus", "<cn>9.4</cn>", apply("times", "<cn>7.5</cn>", "<ci>left</ci>")),
            False,
        ),
        units="m",
    )
    + "".join(
        variable(f"bodyMomentOfInertia_{axis}", 5000.0, units="kgm2") for axis in ("Roll", "Pitch", "Yaw")
    )
)


def rocket_aero():
    """Lift over alpha, side force over beta, drag over the total angle, in degrees."""
    total = apply(
        "power",
        apply("plus", *(apply("power", f"<ci>{x}</ci>", "<cn>2</cn>") for x in ("alpha", "beta"))),
        "<cn>0.5</cn>",
    )
    names = {
        "liftCoefficient": "totalCoefficientOfLift",
        "dragCoefficient": "totalCoefficientOfDrag",
        "sideforceCoefficient": "aeroBodyForceCoefficient_Y",
        "pitchingMomentCoefficient": "aeroBodyMomentCoefficient_Pitch",
        "yawingMomentCoefficient": "aeroBodyMomentCoefficient_Yaw",
    }
    return (
        variable("angleOfAttack", inner="<isInput/>", identifier="alpha", units="deg")
        + variable("angleOfSideslip", inner="<isInput/>", identifier="beta", units="deg")
        + variable("referenceArea", 7.0, units="m2")
        + variable("longitudinalReferenceLength", 3.0, units="m")
        + variable("lateralReferencelength", 3.0, units="m")
        + calculated("totalAlpha", total, identifier="alphaT", units="deg")
        + "".join(variable(name, identifier=own) for name, own in names.items())
        + table("CL", ("alpha",), ("-10 -4 0 4 10",), "-1.6 -0.5 0 0.5 1.6", "totalCoefficientOfLift")
        + table("CD", ("alphaT",), ("-10 -5 0 5 10",), "0.5 0.3 0.2 0.3 0.5", "totalCoefficientOfDrag")
        + table("CY", ("beta",), ("-10 0 10",), "1.6 0 -1.6", "aeroBodyForceCoefficient_Y")
        + table("Cm", ("alpha",), ("-20 0 20",), "0.6 0 -0.6", "aeroBodyMomentCoefficient_Pitch")
        + table("Cn", ("beta",), ("-20 0 20",), "-0.6 0 0.6", "aeroBodyMomentCoefficient_Yaw")
    )


def fighter_aero():
    """Forces along the axes of B; the elevator enters table and formula, the sign of sideslip a piecewise."""
    over = {"roll": "bspan", "pitch": "cbar", "yaw": "bspan"}
    rates = {
        axis: apply("times", f"<ci>{over[axis]}</ci>", apply("divide", f"<ci>{axis}</ci>", "<ci>tvt</ci>"))
        for axis in over
    }
    flip = "<apply><lt/><ci>beta</ci><cn>0</cn></apply>"
    signed = (
        f"<apply><piecewise><piece>{apply('minus', '<ci>absCl</ci>')}{flip}</piece>"
        "<otherwise><ci>absCl</ci></otherwise></piecewise></apply>"
    )
    bend = apply(
        "minus", "<cn>1</cn>", apply("power", apply("divide", "<ci>beta</ci>", "<cn>57.3</cn>"), "<cn>2</cn>")
    )
    return (
        variable("trueAirspeed", identifier="vt", units="ft_s")
        + variable("angleOfAttack", identifier="alpha", units="deg")
        + variable("angleOfSideslip", identifier="beta", units="deg")
        + "".join(
            variable(f"bodyAngularRate_{axis.capitalize()}", identifier=axis, units="rad_s")
            for axis in ("roll", "pitch", "yaw")
        )
        + variable("elevatorDeflection", identifier="el", units="deg")
        + variable("referenceWingArea", 300.0, units="ft2")
        + variable("referenceWingChord", 11.0, units="ft", identifier="cbar")
        + variable("referenceWingSpan", 30.0, units="ft", identifier="bspan")
        + calculated("tvt", apply("times", "<cn>2</cn>", "<ci>vt</ci>"), units="ft_s")
        + calculated("absBeta", apply("abs", "<ci>beta</ci>"), identifier="absbeta", units="deg")
        + "".join(variable(name) for name in ("cxt", "czt", "absCl", "cmt", "clp", "cmq"))
        + calculated("aeroBodyForceCoefficient_X", "<ci>cxt</ci>")
        + calculated("aeroBodyForceCoefficient_Y", apply("times", "<cn>-0.02</cn>", "<ci>beta</ci>"))
        + calculated(
            "aeroBodyForceCoefficient_Z",
            apply(
                "plus",
                apply("times", "<ci>czt</ci>", bend),
                apply("times", "<cn>-0.0076</cn>", "<ci>el</ci>"),
            ),
        )
        + calculated(
            "aeroBodyMomentCoefficient_Roll",
            apply("plus", signed, apply("times", rates["roll"], "<ci>clp</ci>")),
        )
        + calculated(
            "aeroBodyMomentCoefficient_Pitch",
            apply("plus", "<ci>cmt</ci>", apply("times", rates["pitch"], "<ci>cmq</ci>")),
        )
        + table("CXT", ("alpha", "el"), ("-10 0 45", "-24 0 24"), "-.1 -.02 -.1 -.1 -.03 -.1 .2 .1 .2", "cxt")
        + table("CZT", ("alpha",), ("-10 0 10 45",), "0.8 0 -0.8 -2", "czt")
        + table("CLT", ("alpha", "absbeta"), ("-10 45", "0 30"), "0 -.05 0 -.1", "absCl")
        + table("CMT", ("alpha", "el"), ("-10 45", "-24 24"), ".2 -.2 .1 -.3", "cmt")
        + table("CLP", ("alpha",), ("-10 45",), "-.3 -.2", "clp")
        + table("CMQ", ("alpha",), ("-10 45",), "-7 -6", "cmq")
    )


@pytest.mark.parametrize(
    "staged, used, mass, station", [(0.0, 0.0, 314.0, 16.9), (0.0, 90.0, 224.0, 13.15), (1.0, 0.0, 99.0, 4.8)]
)
def test_mass_and_centre_follow_stage_and_fuel(tmp_path, staged, used, mass, station):
    path = write(tmp_path, ROCKET_MASS)
    data = vehicle_part([path], {"rocketHasStaged": staged, "fuelUsed": used})
    assert data["mass.entry_kg"][0] == pytest.approx(mass)
    assert data["mass.entry_centre_m"][0] == pytest.approx([-station, 0.0, 0.0])


def test_what_a_model_needs_is_asked_for_by_name_and_line(tmp_path):
    path = write(tmp_path, ROCKET_MASS)
    problem = refusal(path, lambda file: vehicle_part([file], {"rocketHasStaged": 0.0}))
    assert "depends on used" in problem.message and "vehicle.daveml_inputs" in problem.message
    problem = refusal(
        path, lambda file: vehicle_part([file], {"rocketHasStaged": 0.0, "fuelUsed": 1.0, "flap": 2.0})
    )
    assert "flap" in problem.message
    aero = write(tmp_path, fighter_aero(), "aero.dml")
    problem = refusal(aero, lambda file: vehicle_part([file]))
    assert problem.path == "elevatorDeflection" and "in deg" in problem.message and problem.line > 3


def test_products_of_inertia_are_those_of_the_flight(tmp_path):
    body = ROCKET_MASS + variable("bodyProductOfInertia_ZX", 120.0, units="kgm2")
    data = vehicle_part([write(tmp_path, body)], {"staged": 0.0, "used": 0.0})
    assert data["mass.entry_products_kg_m2"][0] == [0.0, 120.0, 0.0]


def test_rocket_on_the_grid_of_both_angles(tmp_path):
    found = sampled_model(write(tmp_path, rocket_aero()), {}, *LIMITS)
    alpha, beta = np.degrees(found.alpha), np.degrees(found.beta)
    assert alpha[0] == pytest.approx(-20.0) and np.diff(alpha).max() < 6.0
    i, j = int(np.argmin(abs(alpha - 4.0))), int(np.argmin(abs(beta - 2.5)))
    a, b = alpha[i], beta[j]
    lift, total = np.interp(a, [-10, -4, 0, 4, 10], [-1.6, -0.5, 0, 0.5, 1.6]), np.hypot(a, b)
    drag = np.interp(total, [0, 5, 10], [0.2, 0.3, 0.5])
    c, s = np.cos(radians(a)), np.sin(radians(a))
    expected = (lift * s - drag * c, -0.16 * b, -lift * c - drag * s, 0.0, -0.03 * a, 0.03 * b)
    assert found.static[0, i, j] == pytest.approx(expected, abs=1e-12)
    assert not found.damping.any()


def test_fighter_with_its_elevator_given(tmp_path):
    path = write(tmp_path, fighter_aero())
    model = read_daveml(path)
    for elevator in (0.0, -12.0):
        found = sampled_model(path, {"elevatorDeflection": elevator}, *LIMITS)
        for i, j in ((5, 3), (20, -4)):
            alpha, beta = np.degrees(found.alpha[i]), np.degrees(found.beta[j])
            point = {
                "vt": 500.0,
                "alpha": alpha,
                "beta": beta,
                "el": elevator,
                "roll": 0.0,
                "pitch": 0.0,
                "yaw": 0.0,
            }
            names = ("ForceCoefficient_X", "ForceCoefficient_Y", "ForceCoefficient_Z")
            own = [model.evaluate(f"aeroBody{name}", point) for name in names]
            own += [model.evaluate(f"aeroBodyMomentCoefficient_{axis}", point) for axis in ("Roll", "Pitch")]
            assert found.static[0, i, j, :5] == pytest.approx(own, abs=1e-12)
        clp = np.interp(np.degrees(found.alpha), [-10, 45], [-0.3, -0.2])
        cmq = np.interp(np.degrees(found.alpha), [-10, 45], [-7.0, -6.0])
        assert found.damping[0, :, 1] == pytest.approx(clp, rel=1e-9)
        assert found.damping[0, :, 5] == pytest.approx(cmq, rel=1e-9)


def test_damping_that_no_table_holds_is_refused(tmp_path):
    body = fighter_aero().replace("<ci>clp</ci></apply></apply>", "<ci>beta</ci></apply></apply>")
    problem = refusal(
        write(tmp_path, body), lambda file: sampled_model(file, {"elevatorDeflection": 0.0}, *LIMITS)
    )
    assert "same at all angles of sideslip" in problem.message


def test_vehicle_flies_the_model(tmp_path):
    """A vehicle file of two DAVE-ML files and their inputs alone; it falls as its drag says."""
    write(tmp_path, rocket_aero(), "aero.dml")
    write(tmp_path, ROCKET_MASS, "mass.dml")
    (tmp_path / "rocket.yaml").write_text(
        "name: rocket\ndaveml: [mass.dml, aero.dml]\ndaveml_inputs: {staged: 0, used: 0}\n"
        "aero: {body: {moment_reference_m: [-16.9, 0, 0]}}\n",
        encoding="utf-8",
    )
    overrides = [f"vehicle={tmp_path / 'rocket.yaml'}", "simulation.time_limit_s=2", "initial.speed_m_s=200"]
    flight = edl6dof.fly("earth_drop", overrides)
    aero = flight.scenario.vehicle.aero
    assert aero.model == "body" and aero.body.reference_area_m2 == 7.0 and aero.body.chord_m == 3.0
    q = flight.telemetry["truth.dynamic_pressure_pa"][0]
    assert flight.telemetry["truth.load_g0"][0] * 9.80665 * 314.0 == pytest.approx(0.2 * 7.0 * q, rel=2e-3)


@pytest.mark.parametrize(
    "math, words",
    [
        ("<piecewise/>", "must hold <piece>"),
        ("<piecewise><otherwise><cn>1</cn></otherwise></piecewise>", "must hold <piece>"),
        ("<piecewise><piece><cn>1</cn></piece></piecewise>", "a value and a condition"),
        (f"<piecewise><piece><cn>1</cn>{STAGED}</piece><otherwise/></piecewise>", "must hold a value"),
        (f"<piecewise><piece><cn>1</cn>{STAGED}</piece></piecewise>", "not finite"),
        (apply("divide", "<cn>1</cn>", "<cn>0</cn>"), "cannot be calculated"),
    ],
)
def test_pieces_that_cannot_be_are_refused(tmp_path, math, words):
    path = write(tmp_path, variable("staged", 0.0) + calculated("a", math))
    problem = refusal(path, lambda file: read_daveml(file).evaluate("a"))
    assert words in problem.message and problem.line >= 3
