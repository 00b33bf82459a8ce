"""Check data that a DAVE-ML file carries of itself: met, or the file is refused."""

import pytest
from daveml_text import apply, calculated, refusal, table, variable, write

from edl6dof.config.errors import ConfigError
from edl6dof.interchange.daveml import read_daveml


def signal(name, value, tolerance=None, tag="signalName"):
    tol = "" if tolerance is None else f"<tol>{tolerance}</tol>"
    return f"<signal><{tag}>{name}</{tag}><signalValue>{value}</signalValue>{tol}</signal>\n"


def shot(given, expected):
    return (
        f'<checkData><staticShot name="middle"><checkInputs>{"".join(given)}</checkInputs>'
        f"<checkOutputs>{''.join(expected)}</checkOutputs></staticShot></checkData>\n"
    )


def thrust(idle, military, most):
    """Thrust over the power lever, as in NASA's model of the F-16: up to 50 %, and above with afterburner."""

    def between(low, high, start):
        part = apply("times", apply("minus", "<ci>PWR</ci>", start), apply("minus", high, low))
        return apply("plus", low, apply("divide", part, "<cn>50</cn>"))

    below = between("<ci>T_IDLE</ci>", "<ci>T_MIL</ci>", "<cn>0</cn>")
    above = between("<ci>T_MIL</ci>", "<ci>T_MAX</ci>", "<cn>50</cn>")
    condition = apply("lt", "<ci>PWR</ci>", "<cn>50</cn>")
    text = variable("powerLeverAngle", inner="<isInput/>", identifier="PWR", units="pct")
    text += "".join(variable(name, identifier=name) for name in ("T_IDLE", "T_MIL", "T_MAX"))
    text += variable("mach", inner="<isInput/>", identifier="RMACH")
    for name, values in (("T_IDLE", idle), ("T_MIL", military), ("T_MAX", most)):
        text += table(name, ["RMACH"], ["0.6, 0.8"], f"{values[0]}, {values[1]},", name)
    return text + calculated(
        "thrustBodyForce_X",
        f"<apply><piecewise><piece>{below}{condition}</piece><otherwise>{above}</otherwise></piecewise></apply>",
        identifier="FEX",
    )


#: Thrust (lbf) at 30,000 ft between Mach 0.6 and 0.8, table of Stevens and Lewis.
F16 = thrust((350.0, -247.0), (4660.0, 5320.0), (9285.0, 11115.0))
#: By hand: at Mach 0.7 51.5, 4990 and 10200 lbf; 40 % of the way to military power, and half of the rest.
HALF, AFTERBURNER = 51.5 + 0.4 * (4990.0 - 51.5), 0.5 * (4990.0 + 10200.0)


def asked(power, mach=0.7):
    return [signal("powerLeverAngle", power), signal("mach", mach)]


@pytest.mark.parametrize(("power", "expected"), [(20.0, HALF), (75.0, AFTERBURNER), (50.0, 4990.0)])
def test_a_file_that_meets_its_check_data_is_read(tmp_path, power, expected):
    checks = shot(asked(power), [signal("thrustBodyForce_X", expected, 1e-6)])
    model = read_daveml(write(tmp_path, F16 + checks))
    assert model.evaluate("FEX", {"PWR": power, "RMACH": 0.7}) == pytest.approx(expected, rel=1e-12)


def test_a_file_that_misses_its_check_data_is_refused_with_every_miss(tmp_path):
    more = variable("also", identifier="also", value=3.0)
    outputs = [signal("thrustBodyForce_X", HALF + 0.002, 0.001), signal("also", 4.0, tag="varID")]
    with pytest.raises(ConfigError) as error:
        read_daveml(write(tmp_path, F16 + more + shot(asked(20.0), outputs)))
    first, second = error.value.problems
    assert "'middle' of the file itself is not met: 2026.9, not 2026.902 (tolerance 0.001)" in first.message
    assert (first.path, second.path) == ("FEX", "also")
    assert second.line > first.line > 1


def test_without_a_tolerance_a_millionth_counts(tmp_path):
    assert read_daveml(write(tmp_path, F16 + shot(asked(20.0), [signal("FEX", HALF * (1.0 + 9e-7))])))
    assert (
        "not met"
        in refusal(write(tmp_path, F16 + shot(asked(20.0), [signal("FEX", HALF * (1.0 + 2e-6))]))).message
    )


@pytest.mark.parametrize(
    ("given", "output", "words"),
    [
        (asked(20.0), signal("thrust", 1.0), "check data of an unknown variable 'thrust'"),
        (asked(20.0), signal("FEX", "much"), "<signal> needs a number in <signalValue>"),
        (asked(20.0), signal("FEX", HALF, "small"), "<signal> needs a number in <tol>"),
        (asked(20.0), signal("FEX", "nan"), "not met"),
        (asked(20.0)[1:], signal("FEX", HALF), "neither initialValue nor calculation nor function"),
    ],
)
def test_check_data_that_cannot_be_used_is_refused(tmp_path, given, output, words):
    assert words in refusal(write(tmp_path, F16 + shot(given, [output]))).message
