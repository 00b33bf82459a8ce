"""What ``import edl6dof`` offers: quick to load, the same as the command line, told in objects."""

import inspect
import json
import pickle
import subprocess
import sys

import numpy as np
import pyarrow as pa
import pytest

import edl6dof
from edl6dof.api.arguments import texts
from edl6dof.api.campaign import worst_case
from edl6dof.metrics.evaluation import Figures
from edl6dof.report import catalogue
from edl6dof.report.catalogue import ALL_STACKS, CATALOGUE, STACKS, Stack
from edl6dof.sim.flight import fly as fly_flight

SHORT = {"simulation.time_limit_s": 20.0, "mission.goal": "time"}


@pytest.fixture(scope="module")
def flight():
    return edl6dof.fly("tianwen1", SHORT)


@pytest.fixture(scope="module")
def folder(flight, tmp_path_factory):
    return flight.save(tmp_path_factory.mktemp("api") / "run", replay=False)


@pytest.fixture(scope="module")
def result():
    return edl6dof.campaign("tianwen1_mc", SHORT, cases=6, workers=1)


# loading


def test_import_loads_nothing_heavy():
    """The modules that flying needs come when something is flown: the import takes some milliseconds."""
    code = (
        "import sys, edl6dof; print([n for n in ('numpy', 'numba', 'pydantic', 'yaml') if n in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_every_name_that_is_offered_is_there():
    assert all(hasattr(edl6dof, name) for name in edl6dof.__all__)
    assert set(edl6dof.__all__) <= set(dir(edl6dof))
    with pytest.raises(AttributeError, match="no attribute 'fligth'"):
        edl6dof.fligth  # noqa: B018


def test_packages_of_the_same_names_are_called_like_their_functions(folder):
    """Python puts an imported package in the place of the function."""
    import edl6dof.report.document
    import edl6dof.verify.check

    assert edl6dof.report.document.Report
    with pytest.raises(ValueError, match="no check case 'keppler'"):
        edl6dof.verify("keppler")
    assert "cases" in str(inspect.signature(edl6dof.verify))


@pytest.mark.parametrize(
    "given, expected",
    [
        (["seed=3"], ("seed=3",)),
        ({"seed": 3}, ("seed=3",)),
        ({"wind": {"gust": {"enabled": True}}}, ("wind.gust.enabled=true",)),
        ({"wind.gust": {"enabled": False}}, ("wind.gust.enabled=false",)),
        ({"truth": {"vehicle.mass.entry_kg": 1300}}, ('truth={"vehicle.mass.entry_kg": 1300}',)),
        ({"limits.largest_rock_m": None}, ("limits.largest_rock_m=null",)),
        ({"initial.rate_deg_s": np.array([1.0, 0.0, 1e-5])}, ("initial.rate_deg_s=[1.0, 0.0, 1e-05]",)),
        ({"truth": {}}, ("truth={}",)),
    ],
)
def test_overrides_are_texts_or_data(given, expected):
    assert texts(given) == expected


def test_overrides_as_data_are_those_of_the_command_line():
    data = edl6dof.load("tianwen1", {"seed": 4, "initial": {"rate_deg_s": [1e-5, 0.0, 0.0]}})
    text = edl6dof.load("tianwen1", ["seed=4", "initial.rate_deg_s=[1e-5, 0.0, 0.0]"])
    assert data.scenario == text.scenario


def test_what_is_no_override_is_refused():
    with pytest.raises(TypeError, match=r"write \['seed=3'\]"):
        edl6dof.load("tianwen1", "seed=3")
    with pytest.raises(TypeError, match="cannot stand in a scenario"):
        edl6dof.load("tianwen1", {"seed": object()})
    with pytest.raises(edl6dof.ConfigError, match="did you mean 'enabled'"):
        edl6dof.load("tianwen1", {"wind.gust.enabld": True})
    with pytest.raises(TypeError, match="name a scenario"):
        edl6dof.fly()


# flights


def test_a_flight_is_told_in_a_line(flight):
    assert len(repr(flight)) < 120
    assert repr(flight).startswith("<Flight tianwen1: flown to the time limit at t = 20.0 s")


def test_a_flight_is_the_one_of_the_simulator(flight):
    plain = fly_flight(edl6dof.load("tianwen1", SHORT))
    assert flight.log.tobytes() == plain.log.tobytes()
    assert flight.figures == plain.figures


def test_a_channel_that_is_none_is_told_with_the_one_that_was_meant(flight):
    with pytest.raises(KeyError, match=r"no channel 'truth.macg'; did you mean 'truth.mach'\?"):
        flight["truth.macg"]
    with pytest.raises(edl6dof.ConfigError, match="did you mean 'truth.mach'"):
        flight.plot("truth.macg")


def test_plots_are_pictures(flight, tmp_path):
    plot = flight.plot("truth.mach", "truth.rate_*", until_s=10.0)
    assert len(plot.figure.axes) == 2
    plot.save(tmp_path / "plot.svg")
    assert (tmp_path / "plot.svg").read_text().count("<svg") == 1
    assert plot._repr_png_()[:4] == b"\x89PNG"
    with pytest.raises(edl6dof.ConfigError, match="no telemetry between"):
        flight.plot("truth.mach", since_s=100.0)
    with pytest.raises(edl6dof.ConfigError, match="name a channel"):
        flight.plot()


def test_figures_are_items_attributes_and_a_table(flight, folder):
    for figures in (flight.figures, edl6dof.open_run(folder).figures):
        assert figures.peak_load_g0 == figures["peak_load_g0"] and "peak_load_g0" in dir(figures)
        head, *rows = repr(figures).splitlines()
        assert head.split() == ["figure", "value", "unit", "meaning"] and len(rows) == len(figures)
        (row,) = [row for row in rows if row.startswith("peak_load_g0 ")]
        assert row.split() == [
            *("peak_load_g0", f"{figures.peak_load_g0:.6g}", "g", "peak", "load", "of", "the", "entry")
        ]
        with pytest.raises(AttributeError, match="did you mean 'peak_load_g0'"):
            figures.peak_lod_g0  # noqa: B018
        with pytest.raises(KeyError, match="did you mean 'peak_load_g0'"):
            figures["peak_lod_g0"]
        assert pickle.loads(pickle.dumps(figures)) == figures
    assert " - " in repr(Figures({"heat_load_j_cm2": None}))


def test_plots_of_a_flight_are_those_it_has_data_for(flight, folder):
    recorded = edl6dof.open_run(folder).plots
    assert list(flight.plots) == list(recorded)
    assert {"rates", "overview", "mach"} <= set(dir(recorded)) and "powered" not in recorded
    assert [line.split()[0] for line in repr(recorded).splitlines()[1:]] == list(recorded)
    assert len(recorded.rates.figure.axes) == 3, "roll, pitch, yaw"
    (curve,) = recorded["mach"].figure.axes[0].lines
    assert curve.get_ydata()[0] == pytest.approx(flight["truth.mach"][0])
    assert flight.plots.mach._repr_png_() == recorded.mach._repr_png_()
    with pytest.raises(AttributeError, match="did you mean 'rates'"):
        recorded.ratse  # noqa: B018
    with pytest.raises(KeyError, match="no plot 'powered'"):
        recorded["powered"]


def test_every_plot_of_the_catalogue_is_offered_once():
    shown = {plot.key for stack in ALL_STACKS.values() for plot in stack.plots}
    assert shown <= {*CATALOGUE, *(one.key for plot in CATALOGUE.values() for one in plot.apart())}
    declared = {one.key for one in vars(catalogue).values() if isinstance(one, Stack)}
    declared |= {stack.key for stacks in STACKS.values() for stack in stacks}
    assert declared - set(ALL_STACKS) == {"nav_velocity"}, "needs rows that its report chooses"


def test_notebooks_show_a_flight(flight):
    html = flight._repr_html_()
    assert "flown to the time limit" in html
    assert "phase trim_aoa" in html
    assert "data:image/png;base64," in html


def test_frames_have_all_channels(flight):
    frame = flight.to_pandas()
    assert frame.index.name == "t_s"
    assert np.array_equal(frame["truth.mach"], flight["truth.mach"])


def test_data_sets_have_units(flight):
    pytest.importorskip("xarray")
    data = flight.to_xarray()
    assert data["truth.mach"].dims == ("t_s",)
    assert data["truth.altitude_m"].attrs["units"] == "m"


def test_data_set_of_a_campaign_has_units(result):
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert dict(data.sizes) == {"case": 6} and list(data["case"]) == list(range(6))
    assert set(data.data_vars) == {*result.table.column_names} - {"case"}
    load, mass = data["peak_load_g0"], data["truth.vehicle.mass.entry_kg"]
    assert load.attrs == {"units": "g", "long_name": "peak load of the entry"}
    assert mass.attrs == {"units": "kg", "long_name": "mass of the whole vehicle at entry interface"}
    assert data["truth.vehicle.rcs.thrusters.D1.thrust_n"].attrs["units"] == "N"
    assert np.array_equal(mass, result["truth.vehicle.mass.entry_kg"])


@pytest.mark.parametrize("missing", ["pandas", "xarray"])
def test_what_is_not_installed_is_named(flight, monkeypatch, missing):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(ImportError, match=rf"pip install 'edl6dof\[{missing}\]'"):
        getattr(flight, f"to_{missing}")()


def test_a_folder_gives_the_flight_back(flight, folder):
    run = edl6dof.open_run(folder)
    assert repr(run) == repr(flight)
    assert (run.outcome, run.success, run.time_s) == (flight.outcome, flight.success, flight.time_s)
    assert set(run.figures) == set(flight.figures)
    assert [event["key"] for event in run.events] == [event["key"] for event in flight.events]
    assert [(c.figure, c.limit, c.ok) for c in run.checks] == [
        (c.figure, c.limit, c.ok) for c in flight.checks
    ]
    assert np.array_equal(run["truth.mach"], flight["truth.mach"])
    assert (run.unit("truth.altitude_m"), run.meaning("truth.mach")) == ("m", flight.meaning("truth.mach"))
    assert np.array_equal(run.to_pandas(), flight.to_pandas(), equal_nan=True)
    with pytest.raises(KeyError, match="did you mean 'truth.mach'"):
        run["truth.macg"]


def test_a_folder_is_what_the_command_writes(flight, folder, tmp_path, monkeypatch):
    from edl6dof.cli import app

    sets = [word for text in texts(SHORT) for word in ("--set", text)]
    with pytest.raises(SystemExit):
        app(["fly", "tianwen1", *sets, "--out", str(tmp_path / "run"), "--no-replay", "-q"])
    for name in ("telemetry.parquet", "events.json", "scenario.yaml", "summary.json"):
        assert (tmp_path / "run" / name).read_bytes() == (folder / name).read_bytes()
    with pytest.raises(edl6dof.ConfigError, match="exists"):
        flight.save(folder)


def test_a_folder_that_must_not_be_replaced_is_refused_before_the_flight(folder, monkeypatch):
    monkeypatch.setattr("edl6dof.sim.flight.fly", lambda *_, **__: pytest.fail("flown in vain"))
    with pytest.raises(edl6dof.ConfigError, match="exists"):
        edl6dof.fly("tianwen1", SHORT, out=folder)


def test_a_saved_state_goes_on(flight, tmp_path):
    half = edl6dof.fly("tianwen1", SHORT, save_at_s=10.0, out=tmp_path / "run", replay=False)
    later = edl6dof.fly(start=tmp_path / "run" / "state.npz")
    assert later.plant.tobytes() == flight.plant.tobytes() == half.plant.tobytes()


def test_reports_are_written_where_it_is_said(folder, tmp_path):
    assert edl6dof.report(folder, out=tmp_path / "page.html") == [tmp_path / "page.html"]
    assert edl6dof.report(edl6dof.open_run(folder), out=tmp_path / "one.html")[0].stat().st_size > 100_000
    (tmp_path / "mine.html").write_text("mine")
    with pytest.raises(edl6dof.ConfigError, match="exists"):
        edl6dof.report(folder, out=tmp_path / "mine.html")


def test_a_replay_that_is_none_is_refused(folder, tmp_path):
    with pytest.raises(edl6dof.ConfigError, match="no such replay"):
        edl6dof.replay(tmp_path / "nowhere")
    with pytest.raises(edl6dof.ConfigError, match="time of a picture"):
        edl6dof.replay(folder, at_s=3.0)


# many flights


def test_a_campaign_is_its_rows(result):
    assert len(result) == result.cases == 6
    assert result.p_success == result.successes / 6
    assert repr(result).startswith("<Campaign tianwen1_mc: 6 of 6 succeed, 100.0 %")
    frame = result.to_pandas()
    assert list(frame.index) == list(range(6))
    assert np.array_equal(frame["end_s"], result["end_s"])
    assert "<table>" not in result._repr_html_()
    with pytest.raises(KeyError, match="did you mean 'end_s'"):
        result["ends_s"]


def test_quantiles_are_those_that_the_cases_can_bound(result):
    column = "truth.vehicle.mass.entry_kg"
    assert [one.share for one in result.quantiles(column)] == [0.5]
    assert result.quantile(column, 0.5).value == pytest.approx(np.median(result[column]))
    assert result.quantile(column, 0.99) is None


def test_the_worst_case_is_the_one_with_the_largest_figure_or_the_least_clearance(result):
    assert result.worst("peak_load_g0") == np.argmax(result["peak_load_g0"])
    table = pa.table({"case": [4, 5, 6, 7], "belly_clearance_m": [0.3, 0.1, None, 0.2]})
    assert worst_case(table, "belly_clearance_m") == 5
    with pytest.raises(edl6dof.ConfigError, match="did you mean 'peak_load_g0'"):
        result.worst("peak_lod_g0")


def test_a_case_flies_again_bit_for_bit(result):
    again = edl6dof.refly(result, 3)
    assert again.differences == ()
    assert again.figures["peak_load_g0"] == result["peak_load_g0"][3]
    with pytest.raises(edl6dof.ConfigError, match=r"must be 0 \.\. 5"):
        edl6dof.refly(result, 6)


def test_a_campaign_in_a_folder_is_opened_and_gone_on_with(result, tmp_path, monkeypatch):
    told = []
    place = tmp_path / "mc"
    kept = edl6dof.campaign(
        "tianwen1_mc", SHORT, cases=6, workers=1, out=place, progress=lambda *so_far: told.append(so_far)
    )
    assert told[-1] == (6, 6)
    assert kept.table.equals(result.table)
    assert edl6dof.open_run(place).table.equals(result.table)
    assert edl6dof.campaign(place, resume=True).table.equals(result.table)
    with pytest.raises(edl6dof.ConfigError, match="exists"):
        edl6dof.campaign("tianwen1_mc", SHORT, cases=6, out=place)
    with pytest.raises(edl6dof.ConfigError, match="was begun with another plan"):
        edl6dof.campaign("tianwen1_mc", SHORT, cases=5, out=place, resume=True)
    with pytest.raises(edl6dof.ConfigError, match="accepts no other values"):
        edl6dof.campaign(place, cases=5, resume=True)
    monkeypatch.setattr(edl6dof, "__version__", "9.9")
    opened = edl6dof.open_run(place)  # what another version flew is looked at, and not flown again
    assert opened.table.equals(result.table) and repr(opened) == repr(result)
    with pytest.raises(edl6dof.ConfigError, match=r"edl6dof: was .*, is 9\.9"):
        opened.refly(3)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"engine": "thread"}, "must be threads or dask"),
        ({"cluster": "tcp://x"}, "needs --engine dask"),
        ({"until": "soon"}, "until: must"),
    ],
)
def test_a_campaign_that_is_none_is_refused(options, words):
    with pytest.raises(edl6dof.ConfigError, match=words):
        edl6dof.campaign("tianwen1_mc", **options)


def test_faults_are_flown_as_the_command_flies_them():
    short = {"simulation.time_limit_s": 5.0, "mission.goal": "time"}
    found = edl6dof.faults("tianwen1", short, components=["D7", "P1"], at=1.0, workers=1)
    assert found["component"].tolist() == ["D7", "P1"]
    assert found.summary.faults is not None
    with pytest.raises(edl6dof.ConfigError, match="did you mean 'D1'"):
        edl6dof.faults("tianwen1", short, components="D11")


def test_report_of_a_campaign_in_memory_says_that_it_has_no_folder(result):
    with pytest.raises(ValueError, match="out=FOLDER"):
        edl6dof.report(result)


def test_check_cases_are_run(monkeypatch):
    (found,) = edl6dof.verify("kepler")
    assert found.passed
    with pytest.raises(ValueError, match="did you mean 'kepler'"):
        edl6dof.verify("keppler")


def test_calibration_is_that_of_the_command(monkeypatch):
    """Its flights are the campaign's business; here that everything is handed on and refused."""
    with pytest.raises(edl6dof.ConfigError, match="has no calibration: section"):
        edl6dof.calibrate("msl")


def test_what_a_flight_tells_is_plain_data(flight):
    json.dumps([dict(event) for event in flight.events])
