"""Names cannot forge lines, columns or variables of the files that other programs read."""

from __future__ import annotations

import io
from datetime import UTC, datetime

import numpy as np
import pytest
from scipy.io import loadmat, netcdf_file

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.export.ccsds import About, write_aem, write_oem
from edl6dof.export.forms import Description, plain, write_mat, write_netcdf

EPOCH = datetime(2021, 5, 14, tzinfo=UTC)
MARS = {
    "name": "Mars",
    "orientation": {
        "pole_ra_deg": 317.7,
        "pole_dec_deg": 52.9,
        "prime_meridian_deg": 176.6,
        "prime_meridian_rate_deg_day": 350.9,
    },
}
EVIL = "lander\nREF_FRAME = EME2000\r\nMETA_STOP\x0b2021-05-14T00:00:00 1 2 3 4 5 6\x00\u2028é"


def columns() -> dict[str, np.ndarray]:
    found = {"t_s": np.array([0.0, 1.0])}
    found |= {f"truth.{s}_I_{a}_{u}": np.ones(2) for s, u in (("r", "m"), ("v", "m_s")) for a in "xyz"}
    return found | {f"truth.q_I2B_{c}": np.full(2, 0.5) for c in "wxyz"}


@pytest.mark.parametrize("write", [write_oem, write_aem])
def test_a_message_has_the_lines_of_an_ordinary_one(write):
    ordinary, forged = io.StringIO(), io.StringIO()
    write(ordinary, About("lander", MARS, EPOCH, ["fine"]), columns())
    write(forged, About(EVIL, MARS, EPOCH, [EVIL * 10]), columns())
    assert forged.getvalue().isascii()
    lines = forged.getvalue().splitlines()
    assert [line.partition(" ")[0] for line in lines] == [
        line.partition(" ")[0] for line in ordinary.getvalue().splitlines()
    ]
    assert all(line.count("=") <= 1 and len(line) <= 254 for line in lines)
    (name,) = (line for line in lines if line.startswith("OBJECT_NAME"))
    assert name == "OBJECT_NAME = LANDER REF_FRAME EME2000 META_STOP 2021-05-14T00:00:00 1 2 3 4 5 6"


def test_a_name_of_nothing_printable_is_unknown():
    stream = io.StringIO()
    write_oem(stream, About("\n\x00", MARS, EPOCH), columns())
    assert "OBJECT_NAME = UNKNOWN\n" in stream.getvalue()


@pytest.mark.parametrize("name", ["rcs.D 1", "1st", "_x", "a\nb", "x=1", "é", "y" * 100])
def test_variables_of_other_programs_are_plain(name, tmp_path):
    assert (
        plain(name).isascii()
        and plain(name).isidentifier()
        and plain(name)[0].isalpha()
        and len(plain(name)) <= 63
    )
    data = {"t_s": np.arange(2.0), f"rcs.{name}": np.ones(2)}
    about = Description(dict.fromkeys(data, ""), dict.fromkeys(data, ""), {})
    write_mat(tmp_path / "x.mat", data, about)
    group, _, field = f"rcs.{name}".partition(".")
    found = loadmat(tmp_path / "x.mat", squeeze_me=True, struct_as_record=False)
    assert np.array_equal(getattr(found[group], plain(field)), [1.0, 1.0])
    write_netcdf(tmp_path / "x.nc", data, about)
    with netcdf_file(tmp_path / "x.nc", mmap=False) as file:
        assert len(file.variables) == 2


@pytest.mark.parametrize("name", ["D.1", "D/1", "D,1", 'D"1', "D\\n1", "D=1", "1D", "", "D" * 41])
def test_thrusters_and_phases_have_names_that_columns_can_have(name):
    for path in ("vehicle.rcs.thrusters.0.name", "mission.phases.0.name"):
        with pytest.raises(ConfigError) as caught:
            edl6dof.load("tianwen1", [f'{path}="{name}"' if '"' not in name else f"{path}='{name}'"])
        (problem,) = caught.value.problems
        assert problem.path == path
        assert "must be at most 40 letters, digits and _, the first a letter" in problem.message


@pytest.mark.parametrize("name", ["Mars\\nX", "\\0", " ", "m" * 201])
def test_planet_and_vehicle_have_names_of_one_line(name):
    for path in ("planet.name", "vehicle.name"):
        with pytest.raises(ConfigError, match="must be one line of at most 200 printable characters"):
            edl6dof.load("tianwen1", [f'{path}="{name}"'])
