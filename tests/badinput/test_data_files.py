"""Mistakes in the data files that a scenario names are found by ``check``, at the key that names the file."""

from __future__ import annotations

import os
import socket
import warnings
from pathlib import Path

import numpy as np
import pytest

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.interchange.daveml_model import read_xml
from edl6dof.sim.checkpoint import State

ATMOSPHERE = "h_km,rho,T_K\n0.0,1.5e-2,210.0\n1.0,1.4e-2,209.0\n2.0,1.3e-2,208.0\n"
AERO = "mach,alpha,CD,CL,Cm\n" + "".join(
    f"{m},{a},1.5,{-0.01 * a},{-0.002 * a}\n" for m in (1.0, 5.0) for a in (0, 2, 4)
)
GRAVITY = (
    "3396.0,42828.37285418775,0,120,120,1,0,0\n2,0,-8.75e-4,0.0,0,0\n2,1,0,0,0,0\n2,2,-8.4e-5,4.9e-5,0,0\n"
)

KEYS = {
    "atmosphere": "atmosphere.table",
    "aero": "vehicle.aero.capsule.static_table",
    "gravity": "planet.gravity.coefficients",
}
GOOD = {"atmosphere": ATMOSPHERE, "aero": AERO, "gravity": GRAVITY}

#: kind of file, content, what is said
BROKEN = {
    "atmosphere empty": ("atmosphere", "", "is empty"),
    "atmosphere heading only": ("atmosphere", "h_km,rho,T_K\n", "has a heading and no row"),
    "atmosphere one row": ("atmosphere", "h_km,rho,T_K\n0.0,1.5e-2,210.0\n", "two rows at least"),
    "atmosphere short row": (
        "atmosphere",
        ATMOSPHERE.replace(",209.0", ""),
        "table.csv:3:1: has 2 entries, its heading 3",
    ),
    "atmosphere text": (
        "atmosphere",
        ATMOSPHERE.replace("209.0", "cold"),
        "table.csv:3:12: T_K: must be a finite number (got 'cold')",
    ),
    "atmosphere nan": (
        "atmosphere",
        ATMOSPHERE.replace("209.0", "nan"),
        "must be a finite number (got 'nan')",
    ),
    "atmosphere altitude falls": (
        "atmosphere",
        ATMOSPHERE.replace("1.0,1.4", "3.0,1.4"),
        "altitudes must rise",
    ),
    "atmosphere density zero": ("atmosphere", ATMOSPHERE.replace("1.4e-2", "0.0"), "densities be positive"),
    "atmosphere no temperature": (
        "atmosphere",
        ATMOSPHERE.replace("T_K", "T_C"),
        "no column that begins with 'T_K'",
    ),
    "atmosphere fine steps": ("atmosphere", ATMOSPHERE.replace("1.0,1.4", "0.001,1.4"), "at most 512 fit"),
    "atmosphere absurd steps": ("atmosphere", ATMOSPHERE.replace("1.0,1.4", "1e-300,1.4"), ""),
    "aero empty": ("aero", "", "is empty"),
    "aero text": ("aero", AERO.replace("1.5", "1.5x"), "CD: must be a finite number (got '1.5x')"),
    "aero gap": ("aero", AERO.rsplit("\n", 2)[0] + "\n", "not a complete Mach x alpha table"),
    "aero short row": ("aero", AERO + "7.0,0\n", ""),
    "aero fraction of a degree": ("aero", AERO.replace(",2,", ",2.5,"), "alpha must be whole degrees"),
    "aero nan": ("aero", AERO.replace("1.5", "nan", 1), "CD: must be a finite number (got 'nan')"),
    "gravity empty": ("gravity", "", "not a complete table"),
    "gravity text": ("gravity", GRAVITY.replace("2,1,0", "2,1,o"), "could not convert string to float: 'o'"),
    "gravity of another planet": (
        "gravity",
        GRAVITY.replace("3396.0", "6378.0"),
        "holds for reference_radius_m 6378000.0",
    ),
    "gravity nan": ("gravity", GRAVITY.replace("-8.4e-5", "nan"), "not finite"),
    "gravity order above degree": ("gravity", GRAVITY + "2,99,0,0,0,0\n", "not a complete table"),
}


def load(kind: str, path: Path) -> edl6dof.scenario.loading.LoadedScenario:
    overrides = [f"{KEYS[kind]}={path}"] + (["wind.model=none"] if kind == "atmosphere" else [])
    return edl6dof.load("tianwen1", overrides)


@pytest.mark.parametrize("kind", KEYS)
def test_good_file_is_accepted(kind, tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(GOOD[kind])
    load(kind, path)


@pytest.mark.parametrize("name", BROKEN)
def test_broken_file(name, tmp_path):
    kind, content, said = BROKEN[name]
    path = tmp_path / "table.csv"
    path.write_text(content)
    with warnings.catch_warnings(), pytest.raises(ConfigError) as caught:
        warnings.simplefilter("error")
        load(kind, path)
    (problem,) = caught.value.problems
    assert problem.path == KEYS[kind]
    assert problem.file == "overrides"
    assert said in problem.message


@pytest.mark.parametrize("kind", KEYS)
@pytest.mark.parametrize("what", ["missing", "folder", "binary", "unreadable name"])
def test_no_such_file(kind, what, tmp_path):
    path = tmp_path / "table.csv"
    if what == "folder":
        path.mkdir()
    elif what == "binary":
        path.write_bytes(b"\x80\xff\x00" * 100)
    elif what == "unreadable name":
        path = tmp_path / ("x" * 300)
    with pytest.raises(ConfigError) as caught:
        load(kind, path)
    (problem,) = caught.value.problems
    assert problem.path == KEYS[kind]


def test_table_that_does_not_fit_with_the_damping_is_refused_at_the_capsule(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(
        "mach,alpha_deg,CD,CL,Cm\n"
        + "".join(
            f"{0.5 + 0.1003 * m},{a},1.5,{-0.01 * a},{-0.002 * a}\n" for m in range(60) for a in (0, 2, 4)
        )
    )
    with pytest.raises(ConfigError) as caught:
        load("aero", path)
    (problem,) = caught.value.problems
    assert problem.path == "vehicle.aero.capsule"
    assert "Mach numbers with those of the damping, at most 64" in problem.message
    assert problem.file.endswith("vehicles/tianwen1.yaml")
    assert problem.line > 1


def test_resolved_scenario_and_saved_state_go_through_the_same_check(tmp_path):
    from edl6dof.config.document.source import parse_document
    from edl6dof.scenario.loading import check_document
    from edl6dof.sim.flight import resolved_text

    text = resolved_text(edl6dof.load("tianwen1")).replace(
        "marsgram2010_jezero_feb2021_winds.csv", "gone.csv"
    )
    with pytest.raises(ConfigError) as caught:
        check_document(parse_document(text, "scenario.yaml"))
    (problem,) = caught.value.problems
    assert (problem.file, problem.path) == ("scenario.yaml", "atmosphere.table")
    assert text.splitlines()[problem.line - 1].strip().startswith("table:")


@pytest.fixture(params=["pipe", "device", "socket", "too large"])
def odd(request, tmp_path) -> tuple[Path, str]:
    """What is no file of reasonable size, and what is said of it."""
    path = tmp_path / "table.csv"
    if request.param == "pipe":
        os.mkfifo(path)
    elif request.param == "device":
        path.symlink_to("/dev/zero")
    elif request.param == "socket":
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(path))
    else:
        with path.open("wb") as file:
            file.truncate(50_000_001)
        return path, "it has 50000001 bytes; at most"
    return path, "it is not a regular file"


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such files")
class TestOddFiles:
    """Reading a pipe would wait for ever, and reading a device would fill the memory."""

    @pytest.mark.parametrize("kind", KEYS)
    def test_table(self, odd, kind):
        with pytest.raises(ConfigError) as caught:
            load(kind, odd[0])
        (problem,) = caught.value.problems
        assert problem.path == KEYS[kind]
        assert f"cannot be read: {odd[1]}" in problem.message

    def test_daveml(self, odd, tmp_path):
        path = odd[0].rename(tmp_path / "model.dml")
        with pytest.raises(ConfigError) as caught:
            load("aero", path)
        assert odd[1] in str(caught.value)
        with pytest.raises(ConfigError) as caught:
            read_xml(path)
        assert odd[1] in str(caught.value)

    def test_scenario(self, odd, tmp_path):
        path = odd[0].rename(tmp_path / "odd.yaml")
        (tmp_path / "extending.yaml").write_text(f"extends: {path}\n", encoding="utf-8")
        said = odd[1].removeprefix("it ")
        for name in (path, tmp_path / "extending.yaml"):
            with pytest.raises(ConfigError) as caught:
                edl6dof.load(str(name))
            assert said in str(caught.value)

    def test_saved_state(self, odd):
        with pytest.raises(ConfigError, match=odd[1]):
            State.load(odd[0])


@pytest.mark.parametrize("kind", ["array", "packed zeros", "damaged"])
def test_file_of_numpy_that_is_no_state(kind, tmp_path):
    path = tmp_path / "state.npz"
    with path.open("wb") as file:
        if kind == "array":
            np.save(file, np.zeros(3))
        else:
            np.savez_compressed(
                file, layout=np.zeros(60_000_000 if kind == "packed zeros" else 1000, dtype=np.uint8)
            )
    if kind == "damaged":
        content = bytearray(path.read_bytes())
        content[100] ^= 0xFF
        path.write_bytes(content)
    with pytest.raises(ConfigError, match="is not a state saved by"):
        State.load(path)
