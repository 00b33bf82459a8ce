"""Trajectories of real flights: what is read, what is refused, and the bands of dispersed flights."""

from __future__ import annotations

import json

import numpy as np
import pytest
from in_process import called
from test_validate import DROP

from edl6dof.config.errors import ConfigError
from edl6dof.missions.bands import bands, in_bands
from edl6dof.missions.flown import MOST, SERIES, Trajectory, read_trajectory
from edl6dof.missions.mission import compare, load_mission

SPEED, HEIGHT = "truth.speed_m_s", "truth.altitude_m"
GOOD = "# a remark\n# [D] made up\nt_s, altitude_m ,speed_m_s\n0,9000,50\n0.5,8975,51\n1.5,8924,53\n"


@pytest.fixture
def csv(tmp_path):
    """Writes a csv and returns its path."""

    def written(text, name="flown.csv"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return written


@pytest.fixture
def drop(csv):
    """A drop of 8 s with a dispersed density, long enough that the drag shows."""
    text = DROP.format(pressure=12.5, name="drop").replace("time_limit_s: 2.0", "time_limit_s: 8.0")
    return csv(text, "drop.yaml")


def test_any_channels_are_read_by_their_names(csv):
    found = read_trajectory(csv(GOOD))
    assert found.status == "derived" and found.t.tolist() == [0.0, 0.5, 1.5]
    assert {name: x.tolist() for name, x in found.channels.items()} == {
        HEIGHT: [9000.0, 8975.0, 8924.0],
        SPEED: [50.0, 51.0, 53.0],
    }
    rows = "".join(f"{k},{k}\n" for k in range(2 * MOST + 1))
    thinned = read_trajectory(csv("# [P] long\nt_s,mach\n" + rows))
    assert len(thinned.t) <= MOST and thinned.t[:2].tolist() == [0.0, 3.0]


@pytest.mark.parametrize(
    ("text", "mistakes"),
    [
        (GOOD.replace("[D]", "D:"), ["1:1: needs a remark with origin and source, such as '# [P] paper'"]),
        (
            GOOD.replace("altitude_m", "altitude_km").replace("t_s", "time_s").replace("53", "fast"),
            [
                "3:1: no column 'time_s'; did you mean 't_s'? (allowed: t_s, altitude_m, ",
                "3:1: no column 'altitude_km'; did you mean 'altitude_m'? (allowed: ",
                "3:1: lacks the column t_s, seconds since the start of the simulation",
                "6:10: speed_m_s: must be a finite number (got 'fast')",
            ],
        ),
        (
            "# none\nt_s,speed_m_s,speed_m_s\n1,2,3\n1,nan,3\n0.5,2\n",
            [
                "1:1: needs a remark with origin and source",
                "2:1: the column speed_m_s stands twice",
                "4:1: t_s: must rise (got 1 after 1)",
                "4:3: speed_m_s: must be a finite number (got 'nan')",
                "5:1: has 2 entries, its heading 3",
            ],
        ),
        ("# [P] x\nt_s\n1\n", ["2:1: has no column but t_s: add one such as speed_m_s"]),
        ("# [P] x\nt_s,mach\n", ["2:1: has a heading and no row"]),
        ("# [P] x\n", [": is empty"]),
    ],
)
def test_every_mistake_of_a_csv_is_named_with_its_place(csv, text, mistakes):
    with pytest.raises(ConfigError) as caught:
        read_trajectory(csv(text))
    found = str(caught.value).splitlines()
    assert len(found) == len(mistakes)
    for line, words in zip(found, mistakes, strict=True):
        assert "flown.csv" in line and words in line


def test_each_of_the_dispersed_flights_lies_in_the_bands_of_the_others_as_often_as_they_say(csv, drop):
    mission = load_mission(str(drop), 60, csv(GOOD.replace("1.5,", "7.5,")))
    rows = mission.fly(None, lambda done, count: None)
    shares, shifted = [], []
    for k, row in enumerate(rows):
        others, speed = [*rows[:k], *rows[k + 1 :]], np.array(row[SERIES + SPEED])
        for found, offset in ((shares, 0.0), (shifted, 10.0)):
            flown = Trajectory("derived", mission.flown.t, {SPEED: speed + offset})
            (band,) = bands(flown, others)
            found.append([band.share(level) for level in (0.5, 0.95)])
    # three standard deviations of the share of 60 flights, whose samples all lie within or all outside
    assert np.mean(shares, axis=0) == pytest.approx([0.5, 0.95], abs=3.0 * (0.25 / 60) ** 0.5)
    assert np.mean(shares, axis=0)[1] > 0.85 and np.max(shifted) == 0.0


def test_a_band_ends_where_most_flights_have_ended():
    flown = Trajectory("published", np.arange(4.0), {SPEED: np.array([5.0, 5.0, 50.0, 5.0])})
    series = [[4.0, 4.0, 4.0, np.nan], [6.0, 6.0, 6.0, np.nan], [5.0, 5.0, np.nan, 7.0]]
    (band,) = found = bands(flown, [{SERIES + SPEED: one} for one in series])
    assert band.there.tolist() == [True, True, True, False]
    assert band.share(0.95) == pytest.approx(2.0 / 3.0) and bands(None, []) == ()
    assert in_bands("drop", found) == [
        "drop, speed over ground: 67 % of the flown curve in the central 95 % of the flights, 67 % in the "
        "central 50 % (3 samples)"
    ]
    (lost,) = bands(flown, [{"case": 0, "success": False}] * 3)  # none could fly
    assert not lost.there.any() and np.isnan(lost.share(0.95))


def test_the_command_draws_the_flown_trajectory(csv, drop, tmp_path):
    csv(GOOD)
    drop.write_text(drop.read_text() + "flown: flown.csv\n")
    done = called("validate", drop, "-n", "6", cwd=tmp_path)
    folder = tmp_path / "runs" / "validation"
    assert done.returncode in (0, 1) and (folder / "drop_flown.png").is_file(), done.stderr
    curves = json.loads((folder / "validation.json").read_text(encoding="utf-8"))["missions"][0]["trajectory"]
    assert [(one["channel"], one["samples"], one["with_band"]) for one in curves] == [
        (HEIGHT, 3, 3),
        (SPEED, 3, 3),
    ]
    assert f"drop, speed over ground: {100.0 * curves[1]['inside_95']:.0f} % of" in " ".join(
        done.stdout.split()
    )
    other = csv("# [R] from memory\nt_s,load_g0\n1,0.1\n", "other.csv")
    again = called("validate", drop, "-n", "6", "--flown", other, "--json", "--out", "two", cwd=tmp_path)
    assert [one["channel"] for one in json.loads(again.stdout)["missions"][0]["trajectory"]] == [
        "truth.load_g0"
    ]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("drop.yaml", "--flown", "none.csv"), "none.csv: cannot be read: No such file or directory"),
        (("drop.yaml", "viking1_mc", "--flown", "flown.csv"), "--flown: is the flight of one mission"),
        (("--flown", "flown.csv"), "--flown: is the flight of one mission"),
    ],
)
def test_a_trajectory_that_cannot_be_compared_is_refused(csv, drop, tmp_path, words, message):
    csv(GOOD)
    done = called("validate", *words, cwd=tmp_path)
    assert done.returncode == 2 and message in done.stderr


def test_a_wrong_trajectory_is_found_by_check(csv, drop, tmp_path):
    csv(GOOD.replace("51", "?"))
    drop.write_text(drop.read_text() + "flown: flown.csv\n")
    for command in ("check", "validate"):
        done = called(command, drop, cwd=tmp_path)
        assert done.returncode == 2 and "flown.csv:5:10: speed_m_s: must be a finite" in done.stderr


def test_a_copy_of_a_shipped_scenario_finds_its_trajectory(csv, tmp_path):
    copy = csv(called("scenarios", "pathfinder").stdout, "mine.yaml")
    assert called("check", copy, cwd=tmp_path).returncode == 0
    csv("extends: pathfinder_mc\nflown: none/such.csv\n", "mine.yaml")
    wrong = called("check", copy, cwd=tmp_path)
    assert wrong.returncode == 2 and "none/such.csv: cannot be read" in wrong.stderr


def test_pathfinder_is_compared_with_its_flight():
    mission = load_mission("pathfinder_mc", 2)
    assert mission.flown.status == "published" and len(mission.flown.t) == 57
    assert {"truth.altitude_m", "truth.speed_m_s", "truth.load_g0"} == set(mission.flown.channels)
    # the flown peak of the curve, every 3 s, is that of the published figures
    peak = mission.flown.channels["truth.load_g0"].max()
    published = {one.figure.name: one.published.number for one in mission.compared}
    assert peak == pytest.approx(published["peak_load_g0"], abs=0.15)
    rows = [{"success": True, "cause": "", SERIES + "truth.load_g0": [0.0] * 57}] * 4
    assert compare(mission, rows).bands[2].share(0.95) == 0.0
