"""Every form of export, read back by programs that are not ours and compared with the telemetry."""

from __future__ import annotations

import csv
import warnings
from datetime import datetime
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from scipy.io import loadmat, netcdf_file
from scipy.spatial.transform import Rotation

import edl6dof
from edl6dof.config.errors import ConfigError
from edl6dof.environment.planet import OrientationParams
from edl6dof.export.ccsds import days_since_j2000, icrf_to_fixed
from edl6dof.export.forms import FILES, write_export
from edl6dof.export.kml import PLACE, write_kml
from edl6dof.manifest import seal
from edl6dof.runs.run import Run

#: Date of t = 0 in the scenario.
EPOCH = "2021-05-14T23:08:55.100000"


def orientation_of(planet):
    path = Path(edl6dof.__file__).parent / "data" / "planets" / f"{planet}.yaml"
    return OrientationParams.model_validate(yaml.safe_load(path.read_text(encoding="utf-8"))["orientation"])


def part(whole, folder, rows):
    """A run of some rows of the telemetry of another."""
    folder.mkdir()
    for name in ("events.json", "summary.json", "scenario.yaml"):
        (folder / name).write_bytes((whole.folder / name).read_bytes())
    pq.write_table(pq.read_table(whole.folder / "telemetry.parquet").take(rows), folder / "telemetry.parquet")
    seal(folder, "flight")
    return Run(folder)


@pytest.fixture(scope="module")
def beginning(run, tmp_path_factory):
    """The first two minutes of the nominal flight: all its rows take a second in each form."""
    return part(run, tmp_path_factory.mktemp("beginning") / "nominal", np.arange(6001))


@pytest.fixture(scope="module")
def exported(beginning, tmp_path_factory):
    """Path of each form."""
    folder = tmp_path_factory.mktemp("export")
    for form in ("mat", "nc", "oem", "aem"):
        write_export(beginning.folder, form, folder / FILES[form], force=False)
    return folder


def thinned(path, target, keep=200):
    """A message with each ``keep``-th line of its data, and the last: readers take their time for each."""
    lines = path.read_text().splitlines()
    data = [k for k, line in enumerate(lines) if line.startswith("2021-")]
    left_out = {k for i, k in enumerate(data[:-1]) if i % keep}
    target.write_text("\n".join(line for k, line in enumerate(lines) if k not in left_out) + "\n")
    return target


def test_csv_keeps_every_digit(run, tmp_path):
    few = part(run, tmp_path / "few", np.arange(0, len(run.t), 499))
    write_export(few.folder, "csv", tmp_path / "few.csv", force=False)
    with open(tmp_path / "few.csv", encoding="utf-8", newline="") as stream:
        header, *rows = csv.reader(stream)
    assert header == list(run) and len(rows) == len(few.t)
    table = np.array([[float(value) for value in row] for row in rows])
    for k, name in enumerate(header):
        assert np.array_equal(table[:, k], run[name][::499], equal_nan=True), name


def test_mat_has_a_struct_for_each_group(beginning, exported):
    content = loadmat(exported / "telemetry.mat", squeeze_me=True, struct_as_record=False)
    assert np.array_equal(content["t_s"], beginning.t)
    for name in beginning:
        group, _, field = name.partition(".")
        if field:
            assert np.array_equal(getattr(content[group], field), beginning[name], equal_nan=True), name
    assert content["units"].truth.altitude_m == "m"
    assert content["about"].outcome == beginning.summary["outcome"]


def test_netcdf_says_what_its_columns_are(beginning, exported):
    assert (exported / "telemetry.nc").read_bytes()[:4] == b"CDF\x02"
    with netcdf_file(exported / "telemetry.nc", mmap=False) as file:
        assert file.dimensions["time"] == len(beginning.t)
        assert np.array_equal(file.variables["truth_mach"][:], beginning["truth.mach"])
        assert file.variables["truth_altitude_m"].units == b"m"
        assert file.variables["truth_load_g0"].units == b"9.80665 m s-2", "not grams"
        assert file.variables["truth_alpha_deg"].long_name == beginning.meaning("truth.alpha_deg").encode()


def test_kml_is_the_trajectory_with_its_events(run, tmp_path):
    rows = write_export(run.folder, "kml", tmp_path / "t.kml", force=False)
    root = ElementTree.parse(tmp_path / "t.kml").getroot()
    kml = {"kml": "http://www.opengis.net/kml/2.2"}
    assert root.tag == f"{{{kml['kml']}}}kml" and root.get("hint") == "target=mars"
    assert root.findtext("kml:Document/kml:name", namespaces=kml) == f"{run.name} on Mars"

    def places(shape):
        found = root.iterfind(f".//kml:{shape}", kml)
        texts = [shown.findtext("kml:coordinates", namespaces=kml).split() for shown in found]
        return [np.array([point.split(",") for point in points], float) for points in texts]

    assert {mode.text for mode in root.iterfind(".//kml:altitudeMode", kml)} == {"absolute"}
    (line,) = places("LineString")
    flown = np.column_stack([run[f"truth.{name}"] for name in ("longitude_deg", "latitude_deg")])
    height = run["truth.height_above_areoid_m"]
    assert rows == len(line) < len(run.t)
    at = [int(np.abs(flown - point[:2]).sum(axis=1).argmin()) for point in line[:-20]]
    assert np.abs(line[:-20, :2] - flown[at]).max() < 1e-7
    assert np.abs(line[[0, -1], 2] - height[[0, -1]]).max() < 0.006
    falling = np.interp(flown[:, 1][::-50], line[::-1, 1], line[::-1, 2])
    above = height[::-50] > 10_000.0
    assert np.abs(falling - height[::-50])[above].max() < np.ptp(height) / 2000.0

    names = [one.text for one in root.iterfind(".//kml:Placemark/kml:name", kml)]
    marks = dict(zip(names[1:], (point for (point,) in places("Point")), strict=True))
    assert marks["main parachute deployed"][2] == pytest.approx(run.at(PLACE[2], run.when["mortar"]), abs=3.0)
    assert np.abs(marks["touchdown, first contact"][:2] - flown[-1]).max() < 1e-5
    assert "phase lift" not in marks and run.summary["outcome"] in marks


def test_kml_of_a_moon_that_no_globe_shows_names_it(beginning, tmp_path, monkeypatch):
    monkeypatch.setitem(beginning.scenario["planet"], "name", "Titan")
    write_kml(tmp_path / "t.kml", beginning)
    text = (tmp_path / "t.kml").read_text()
    assert "hint" not in text and "on Titan" in text


def test_oem_is_read_by_two_published_parsers(beginning, exported, tmp_path):
    oem = pytest.importorskip("oem", reason="pip install oem: a second reader of the message")
    ndm = pytest.importorskip("ccsds_ndm.ndm_io", reason="pip install ccsds-ndm: a reader of the message")
    few = thinned(exported / "orbit.oem", tmp_path / "few.oem")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the readers' own dependencies
        message = oem.OrbitEphemerisMessage.open(few)
    segment = message.segments[0]
    assert segment.metadata["CENTER_NAME"] == "MARS" and segment.metadata["REF_FRAME"] == "ICRF"
    states = list(segment.states)
    first, last = states[0], states[-1]
    assert first.epoch.isot.startswith("2021-05-14T23:08:55.1")
    assert (last.epoch - first.epoch).sec == pytest.approx(beginning.t[-1], abs=1e-6)
    for state, row in ((first, 0), (last, -1)):
        radius, speed = (
            np.linalg.norm([beginning[f"truth.{s}_I_{a}_{u}"][row] for a in "xyz"])
            for s, u in (("r", "m"), ("v", "m_s"))
        )
        assert np.linalg.norm(state.position) * 1e3 == pytest.approx(radius, abs=1e-3)
        assert np.linalg.norm(state.velocity) * 1e3 == pytest.approx(speed, abs=1e-6)
    other = ndm.NdmIo().from_path(few).body.segment[0].data.state_vector
    assert len(other) == len(states)
    assert float(other[0].x.value) == pytest.approx(first.position[0], abs=1e-9)


def test_velocity_of_the_oem_is_the_rate_of_its_position(exported):
    rows = [
        line.split() for line in (exported / "orbit.oem").read_text().splitlines() if line.startswith("2021")
    ]
    i = 5000
    before, here, after = (np.array(rows[k][1:], float) for k in (i - 1, i, i + 1))
    assert (after[:3] - before[:3]) / 0.04 == pytest.approx(here[3:], abs=2e-6)


def test_aem_turns_the_celestial_frame_into_the_body(beginning, exported, tmp_path):
    ndm = pytest.importorskip("ccsds_ndm.ndm_io", reason="pip install ccsds-ndm: a reader of the message")
    segment = ndm.NdmIo().from_path(thinned(exported / "attitude.aem", tmp_path / "few.aem")).body.segment[0]
    meta = segment.metadata
    assert (meta.ref_frame_a, meta.ref_frame_b, meta.attitude_dir.value) == ("ICRF", "SC_BODY_1", "A2B")
    states = segment.data.attitude_state
    assert len(states) == len(range(0, len(beginning.t) - 1, 200)) + 1
    turn = icrf_to_fixed(orientation_of("mars"), datetime.fromisoformat(EPOCH + "+00:00"))
    for state, row in ((0, 0), (20, 4_000), (-1, -1)):
        q = states[state].quaternion_state.quaternion
        q1, q2, q3, qc = q.q1, q.q2, q.q3, q.qc
        # CCSDS 504.0-B-1: the direction cosine matrix from A to B of [q1 q2 q3 qc]
        matrix = np.array(
            [
                [q1 * q1 - q2 * q2 - q3 * q3 + qc * qc, 2 * (q1 * q2 + q3 * qc), 2 * (q1 * q3 - q2 * qc)],
                [2 * (q1 * q2 - q3 * qc), -q1 * q1 + q2 * q2 - q3 * q3 + qc * qc, 2 * (q2 * q3 + q1 * qc)],
                [2 * (q1 * q3 + q2 * qc), 2 * (q2 * q3 - q1 * qc), -q1 * q1 - q2 * q2 + q3 * q3 + qc * qc],
            ]
        )
        own = (
            Rotation.from_quat([beginning[f"truth.q_I2B_{c}"][row] for c in "xyzw"]).inv().as_matrix() @ turn
        )
        assert matrix == pytest.approx(own, abs=1e-9)


def test_sun_over_mars_stands_where_mars_time_says():
    """Sub-solar point by this orientation, against Mars' mean solar time and equation of time (Allison &
    McEwen 2000).
    """
    coordinates = pytest.importorskip(
        "astropy.coordinates", reason="pip install astropy: positions of Sun and Mars"
    )
    from astropy.time import Time
    from astropy.utils import iers

    iers.conf.auto_download = False
    when = datetime.fromisoformat(EPOCH + "+00:00")
    time = Time(when.replace(tzinfo=None), scale="utc")
    sun, mars = (
        coordinates.get_body_barycentric(name, time, ephemeris="builtin").xyz.to_value("km")
        for name in ("sun", "mars")
    )
    x, y, z = icrf_to_fixed(orientation_of("mars"), when) @ (sun - mars)
    longitude, latitude = np.degrees(np.arctan2(y, x)), np.degrees(np.arctan2(z, np.hypot(x, y)))

    days = days_since_j2000(when)
    anomaly = np.radians(19.3871 + 0.52402073 * days)
    centre = sum(
        a * np.sin(k * anomaly)
        for k, a in enumerate((10.691 + 3e-7 * days, 0.623, 0.050, 0.005, 0.0005), start=1)
    )
    terms = (
        (71, 2.2353, 49.409),
        (57, 2.7543, 168.173),
        (39, 1.1177, 191.837),
        (37, 15.7866, 21.736),
        (21, 2.1354, 15.704),
        (20, 2.4694, 95.528),
        (18, 32.8493, 49.095),
    )
    centre += sum(1e-4 * a * np.cos(np.radians(0.985626 * days / tau + phase)) for a, tau, phase in terms)
    season = np.radians(270.3871 + 0.524038496 * days + centre)
    equation = 2.861 * np.sin(2 * season) - 0.071 * np.sin(4 * season) + 0.002 * np.sin(6 * season) - centre
    mean_time = 360.0 * ((days - 4.5) / 1.0274912517 + 44796.0 - 0.0009626)
    assert (longitude + mean_time + equation + 180.0 + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=0.05)
    assert latitude == pytest.approx(np.degrees(np.arcsin(0.42565 * np.sin(season))), abs=0.05)


def test_earth_turns_with_sidereal_time():
    coordinates = pytest.importorskip(
        "astropy.coordinates", reason="pip install astropy: rotation of the Earth"
    )
    from astropy.time import Time
    from astropy.utils import iers

    iers.conf.auto_download = False
    when = datetime.fromisoformat("2015-03-01T07:00:00+00:00")
    time = Time(when.replace(tzinfo=None), scale="utc")
    here = coordinates.EarthLocation.from_geodetic(0.0, 0.0).get_gcrs(time).cartesian.xyz.value
    x, y, z = icrf_to_fixed(orientation_of("earth"), when) @ (here / np.linalg.norm(here))
    assert np.degrees(np.arctan2(y, x)) == pytest.approx(0.0, abs=0.3)
    assert np.degrees(z) == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize(
    "stated, instead, message",
    [
        ('epoch_utc: "2021-05-14T23:08:55.1"', 'epoch_utc: ""', "epoch_utc"),
        ("  orientation:\n", "  orientation: null\n  unread:\n", "Mars states no orientation"),
    ],
)
def test_a_scenario_without_a_date_or_a_pole_cannot_become_a_message(run, tmp_path, stated, instead, message):
    for name in ("telemetry.parquet", "events.json", "summary.json"):
        (tmp_path / name).write_bytes((run.folder / name).read_bytes())
    assert stated in run.scenario_text
    (tmp_path / "scenario.yaml").write_text(run.scenario_text.replace(stated, instead))
    seal(tmp_path, "flight")
    with pytest.raises(ConfigError, match=message):
        write_export(Run(tmp_path).folder, "oem", tmp_path / "orbit.oem", force=False)
    assert not list(tmp_path.glob("*.oem"))
