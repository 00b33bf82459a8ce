"""``edl6dof report``, ``plot``, ``compare`` and ``export`` from the command line."""

from __future__ import annotations

import json
import re
import shutil
import sys
import warnings
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from types import SimpleNamespace

import in_process
import numpy as np
import pytest
from PIL import Image, ImageChops
from scipy.special import stdtrit

from edl6dof.api import reports
from edl6dof.campaign.ensemble import SampleMean, clear_differences
from edl6dof.cli import result_views
from edl6dof.cli.result_views import MOST
from edl6dof.config.errors import ConfigError
from edl6dof.manifest import seal
from edl6dof.report.catalogue import channel_plot, chosen
from edl6dof.report.figure import Axis, Figure, Heat, Panel, Trace
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.report.flight.overlay import (
    comparison_report,
    differences_table,
    figures_table,
    labels,
    overlaid,
    together,
)
from edl6dof.report.matplotlib_figure import matplotlib_figure, write_figure
from edl6dof.report.pdf import write_pdf
from edl6dof.runs.run import Run


def command(capsys, monkeypatch, *words):
    monkeypatch.setattr(sys, "argv", ["edl6dof", *map(str, words)])
    with pytest.raises(SystemExit) as end:
        in_process.main()
    out, err = capsys.readouterr()
    return int(end.value.code or 0), out, err


@pytest.fixture(scope="module")
def other(run, tmp_path_factory):
    """The same flight ten seconds shorter, with another seed and propellant figure."""
    folder = tmp_path_factory.mktemp("runs") / "shorter"
    folder.mkdir()
    import pyarrow.parquet as pq

    table = pq.read_table(run.folder / "telemetry.parquet")
    pq.write_table(table.slice(0, len(run.t) - 500), folder / "telemetry.parquet")
    (folder / "events.json").write_bytes((run.folder / "events.json").read_bytes())
    summary = json.loads((run.folder / "summary.json").read_text())
    summary["figures"]["propellant_used_kg"] += 3.0
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "scenario.yaml").write_text(
        re.sub(r"^seed: 1\b", "seed: 8", run.scenario_text, flags=re.MULTILINE)
    )
    seal(folder, "flight")
    return Run(folder)


def test_report_says_where_it_is(run, tmp_path, capsys, monkeypatch):
    out = tmp_path / "r.html"
    assert command(capsys, monkeypatch, "report", run.folder, "--out", out) == (0, f"{out}\n", "")
    assert out.stat().st_size > 3_000_000


@pytest.mark.parametrize("painted", [("landing", "site"), pytest.param((), marks=pytest.mark.long)])
def test_figures_for_papers_are_painted(run, tmp_path, capsys, monkeypatch, painted):
    """Those of some sections, or all."""
    report = flight_report(run)
    if painted:
        report = replace(report, sections=[part for part in report.sections if part.key in painted])
        monkeypatch.setattr(reports, "report_of", lambda folder: report)
    assert command(capsys, monkeypatch, "report", run.folder, "--out", tmp_path / "r.html", "--png")[0] == 0
    written = {path.stem for path in (tmp_path / "r").glob("*.png")}
    assert written == {figure.key for figure in report.figures()} and len(written) > 2
    for path in (tmp_path / "r").glob("*.png"):
        with Image.open(path) as image:
            assert image.width == 1400, "7 in at 200 dpi"
            pairs = combinations(image.convert("RGB").split(), 2)
            coloured = max(ImageChops.difference(*pair).getextrema()[1] for pair in pairs)
        assert coloured > 80, f"{path.stem} has no colour in it"


def test_pdf_holds_tables_and_figures(run, tmp_path):
    whole = flight_report(run)
    sections = [section for section in whole.sections if section.key in ("limits", "landing")]
    part = replace(whole, sections=sections, picture=None)
    write_pdf(part, tmp_path / "r.pdf")
    content = (tmp_path / "r.pdf").read_bytes()
    assert content.startswith(b"%PDF")
    assert len(re.findall(rb"/Type /Page\b", content)) == 2, "one of tables, and one of the two figures"


@pytest.mark.parametrize("place, words", [("nowhere", "no such folder"), (".", "no telemetry.parquet")])
def test_folder_that_is_no_run_is_refused_in_one_line(place, words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, _, err = command(capsys, monkeypatch, "report", place)
    assert code == 2 and words in err and err.count("\n") == 1


def test_broken_telemetry_is_refused_in_one_line(run, tmp_path, capsys, monkeypatch):
    for name in ("events.json", "summary.json", "scenario.yaml"):
        (tmp_path / name).write_bytes((run.folder / name).read_bytes())
    (tmp_path / "telemetry.parquet").write_bytes(b"PAR1 not really PAR1")
    seal(tmp_path, "flight")
    code, _, err = command(capsys, monkeypatch, "report", tmp_path)
    assert code == 2 and "cannot be read" in err and err.count("\n") == 1
    (tmp_path / "telemetry.parquet").write_bytes((run.folder / "telemetry.parquet").read_bytes())
    (tmp_path / "summary.json").write_text("{")
    seal(tmp_path, "flight")
    code, _, err = command(capsys, monkeypatch, "report", tmp_path)
    assert code == 2 and "summary.json" in err and err.count("\n") == 1


def test_plot_puts_channels_of_one_unit_into_one_panel(run):
    channels = chosen(run, ["truth.rate_?_deg_s", "truth.mach", "guide.bank_deg"], run.folder)
    figure = channel_plot(run, channels, "t_s", run.t < 100.0)
    assert [[trace.name for trace in panel.traces] for panel in figure.panels] == [
        ["truth.rate_p_deg_s", "truth.rate_q_deg_s", "truth.rate_r_deg_s"],
        ["truth.mach"],
        ["guide.bank_deg"],
    ]
    assert np.array_equal(figure.panels[1].traces[0].y, run["truth.mach"][run.t < 100.0])


def test_plot_names_what_was_meant(run):
    with pytest.raises(ConfigError, match=r"did you mean 'truth\.rate_\*'"):
        chosen(run, ["truth.rate_"], run.folder)
    with pytest.raises(ConfigError, match=r"did you mean 'truth\.mach'"):
        chosen(run, ["truth.mac"], run.folder)


def test_plot_writes_what_the_ending_says(run, tmp_path, capsys, monkeypatch):
    for ending, start in (
        (".html", b"<!DOCTYPE"),
        (".png", b"\x89PNG"),
        (".pdf", b"%PDF"),
        (".svg", b"<?xml"),
    ):
        out = tmp_path / f"p{ending}"
        assert (
            command(
                capsys,
                monkeypatch,
                "plot",
                run.folder,
                "truth.mach",
                "--against",
                "truth.altitude_m",
                "--out",
                out,
            )[0]
            == 0
        )
        assert out.read_bytes().startswith(start)
    assert command(capsys, monkeypatch, "plot", run.folder, "truth.mach", "--out", tmp_path / "p.doc")[0] == 2
    assert command(capsys, monkeypatch, "plot", run.folder, "truth.mach", "--from", "9000")[0] == 2
    code, out, _ = command(capsys, monkeypatch, "plot", run.folder)
    assert code == 0 and len(out.splitlines()) == len(run) and "Mach number" in out


def test_comparison_finds_exactly_what_differs(run, other):
    assert [row[0] for row in differences_table(run, other).rows] == ["seed"]
    changed = [row for row in figures_table(run, other).rows if row[-1].strip("+-0.,")]
    assert [row[0] for row in changed] == ["propellant used"]
    assert float(changed[0][-1]) == pytest.approx(3.0, abs=1e-3)


def test_overlay_holds_the_curves_of_both(run, other):
    both = {figure.key: figure for figure in comparison_report(run, other).figures()}
    names = run.folder.name, other.folder.name
    speed = {trace.name: trace for trace in both["overview"].panels[1].traces}
    assert set(speed) == set(names)
    assert speed[names[0]].x[-1] - speed[names[1]].x[-1] == pytest.approx(10.0)
    assert speed[names[0]].dash != speed[names[1]].dash, "they differ in print too"


def test_plot_draws_several_flights_in_a_panel_for_each_channel(run, other, tmp_path, capsys, monkeypatch):
    """Each flight has its colour and dashes, the same in every panel."""
    out = tmp_path / "p.svg"
    words = ("plot", run.folder, other.folder, "truth.mach", "--out", out)
    assert command(capsys, monkeypatch, *words) == (0, f"{out}\n", "")
    names, rates = labels(run, other), chosen(run, ["truth.rate_?_deg_s"], run.folder)
    figures = [channel_plot(of, rates, "t_s", of.t > 0.0, apart=True) for of in (run, other)]
    figure = together(figures, names)
    assert figure.title.endswith("of 2 flights") and figure.entries == set(names)
    assert [panel.title.partition(":")[0] for panel in figure.panels] == rates
    for panel in figure.panels:
        assert [(trace.name, trace.dash) for trace in panel.traces] == list(
            zip(names, ("solid", "dash"), strict=True)
        )
        assert len({trace.colour for trace in panel.coloured()}) == 2
        assert len(panel.traces[0].x) - len(panel.traces[1].x) == 500


def test_times_of_a_plot_the_wrong_way_round_are_refused(run, capsys, monkeypatch):
    words = ("plot", run.folder, "truth.mach", "--from", "30", "--to", "3")
    refused = "--from: must not be after the last time, 3 s (got 30 s)\n"
    assert command(capsys, monkeypatch, *words) == (2, "", refused)


def test_compare_of_three_names_the_command_that_draws_them(capsys, monkeypatch):
    code, _, err = command(capsys, monkeypatch, "compare", "a", "b", "c")
    assert code == 2 and "edl6dof plot a b c CHANNEL" in err


def test_a_run_that_is_not_there_is_no_channel(run, capsys, monkeypatch):
    code, _, err = command(capsys, monkeypatch, "plot", run.folder, "runs/nowhere", "truth.mach")
    assert (code, err) == (2, "runs/nowhere: no such folder; name the folder of a run\n")


def test_a_difference_is_clear_beyond_that_of_neighbours():
    spread = {name: SampleMean(10.0, 0.1, 10) for name in ("peak_load_g0", "touchdown_s", "landing_east_m")}
    spread |= {"bank_reversals": SampleMean(4.0, 0.0, 10), "mass_balance": SampleMean(0.0, 0.0, 10)}
    one = dict.fromkeys(spread, 10.0)
    width = stdtrit(9, 1.0 - 0.025 / 3) * np.sqrt(2.0) * 0.1
    two = {"peak_load_g0": 10.0 + 0.99 * width, "touchdown_s": 10.0 + 1.01 * width, "bank_reversals": 4.0}
    found = clear_differences(spread, one, {**two, "landing_east_m": None, "mass_balance": 11.0})
    assert list(found) == ["bank_reversals", "touchdown_s"], "the largest of its own size first"
    assert found["touchdown_s"] == pytest.approx(width) and found["bank_reversals"] == 0.0


def test_compare_says_what_differs_more_than_neighbours_do(run, other, tmp_path, capsys, monkeypatch):
    spreads = {name: SampleMean(0.0, 1e-3, 10) for name in run.summary["figures"]}
    monkeypatch.setattr(result_views, "_spreads", lambda run: spreads)
    code, out, _ = command(
        capsys, monkeypatch, "compare", run.folder, other.folder, "--out", tmp_path / "c.html"
    )
    assert code == 0
    (row,) = (line for line in out.splitlines() if "+3.00" in line)
    assert row.split()[:3] == ["propellant", "used", "kg"] and "1 of 1 figure that differ clearly" in out
    assert "bank reversals" not in out and "Events" not in out
    monkeypatch.setattr(result_views, "_spreads", lambda run: {})
    words = ("compare", run.folder, other.folder, "--out", tmp_path / "c.html", "--force")
    assert "No figure differs by more than from flight to flight" in command(capsys, monkeypatch, *words)[1]
    everything = command(capsys, monkeypatch, *words, "--all")[1]
    assert "bank reversals" in everything and "\nEvents" in everything


@pytest.mark.long
def test_compare_writes_a_page_and_says_so(run, other, tmp_path, capsys, monkeypatch):
    code, out, _ = command(
        capsys, monkeypatch, "compare", run.folder, other.folder, "--out", tmp_path / "c.html"
    )
    assert (
        code == 0
        and "from flight to flight" in out
        and "\n  seed: 1 | 8\n" in out
        and out.endswith("c.html\n")
    )
    assert Path(tmp_path / "c.html").stat().st_size < 9_000_000


def test_of_a_fault_only_the_parameters_of_its_kind_are_told():
    fault = {"kind": "degraded", "degraded": {"thrust_factor": 0.5}, "tank_leak": {"flow_kg_s": 0.5}}
    faults = {"a": [], "b": [{**fault, "engine": None, "at": {"time_s": 3.0}}]}
    runs = [SimpleNamespace(folder=Path(name), scenario={"faults": faults[name]}) for name in faults]
    assert [row[0] for row in differences_table(*runs).rows] == [
        "faults", "faults.0.kind", "faults.0.degraded.thrust_factor", "faults.0.at.time_s",
    ]  # fmt: skip


def test_counts_are_compared_as_whole_numbers(run, other):
    rows = {row[0]: row[2:] for row in figures_table(run, other).rows}
    count = json.loads((run.folder / "summary.json").read_text())["figures"]["bank_reversals"]
    assert count > 0 and rows["bank reversals"] == [f"{count:.0f}", f"{count:.0f}", "+0"]


def test_terminal_shows_the_first_of_many_differences(run, other, tmp_path, capsys, monkeypatch):
    folder = tmp_path / "far"
    shutil.copytree(other.folder, folder)
    text = (folder / "scenario.yaml").read_text()
    (folder / "scenario.yaml").write_text(
        re.sub(r"^( *\w+): \d+\.\d+\b", r"\1: 77.5", text, flags=re.MULTILINE)
    )
    seal(folder, "flight")
    words = ("compare", run.folder, folder, "--out", tmp_path / "c.html")
    code, out, _ = command(capsys, monkeypatch, *words)
    _, reverse, _ = command(capsys, monkeypatch, "compare", folder, *words[1:2], *words[3:], "--force")
    assert "scenario.yaml:" in reverse and "how much flights vary is not known" in reverse, (
        "it cannot be flown"
    )
    shown = [line for line in out.splitlines() if line.endswith(" | 77.5")]
    assert code == 0 and len(shown) == MOST - 1 and "\n  seed: 1 | 8\n" in out, (
        "the seed is the first of them"
    )
    assert out.endswith("c.html\n") and (tmp_path / "c.html").stat().st_size < 9_000_000
    assert re.search(r"^  and \d{3} more: --all, or the page$", out, re.MULTILINE)


def test_a_campaign_is_compared_with_a_campaign_only(tmp_path, capsys, monkeypatch):
    for name in "ab":
        (tmp_path / name).mkdir()
    (tmp_path / "a" / "campaign.json").touch()
    monkeypatch.chdir(tmp_path)
    for words, said in (
        (("a", "b"), "b: is no campaign, and a is one"),
        (("b", "a"), "b: is no campaign, and a is one"),
        (("b", "b", "--json"), "--json: is of two campaigns"),
    ):
        code, _, err = command(capsys, monkeypatch, "compare", *words)
        assert code == 2 and said in err


def test_export_wants_exactly_one_form(run, tmp_path, capsys, monkeypatch):
    assert command(capsys, monkeypatch, "export", run.folder)[0] == 2
    assert command(capsys, monkeypatch, "export", run.folder, "--format", "xls")[0] == 2
    assert command(capsys, monkeypatch, "export", run.folder, "--format", "csv", "--nesc")[0] == 2
    code, out, _ = command(capsys, monkeypatch, "export", run.folder, "-", "--format", "oem")
    assert code == 0 and out.startswith("CCSDS_OEM_VERS = 2.0")
    assert command(capsys, monkeypatch, "export", run.folder, "-", "--format", "mat")[0] == 2


@pytest.mark.parametrize("t_s", [0.0, pytest.param(300.0, marks=pytest.mark.long), 1e17])
def test_a_plot_of_a_single_time_has_an_axis_around_it(t_s, tmp_path):
    trace = Trace(np.full(3, t_s), np.arange(3.0))
    figure = Figure("single", "", [Panel(Axis("time, s"), Axis("height, m"), [trace])])
    low, high = figure.spans(0)[0]
    assert low < t_s < high
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        write_figure(figure, tmp_path / "single.png")


def test_a_map_of_one_row_has_cells():
    heat = Heat(np.arange(3), np.arange(1), np.array([[0.0, 1.0, np.nan]]), "miss, km", 0.0, 1.0)
    names = Axis("", names=["nominal", "wind", "dense"]), Axis("", names=["fnpeg"])
    canvas = matplotlib_figure(Figure("map", "", [Panel(*names, heat=heat)]))
    (cells,) = canvas.axes[0].collections
    assert np.ptp(cells.get_coordinates(), axis=(0, 1)).tolist() == [3.0, 1.0]


def test_plots_of_two_flights_meet_where_one_of_them_has_fewer():
    """A flight without a measured drag has no plot of it: its range must not lie over the other's drag."""

    def figure(*titles):
        line = np.arange(3.0)
        return Figure(
            "way", "way", [Panel(Axis("t (s)"), Axis(title), [Trace(line, line)]) for title in titles]
        )

    both = overlaid(figure("drag (m/s²)", "range (km)"), figure("range (km)"), ("one", "two"))
    assert [len(panel.traces) for panel in both.panels] == [1, 2]
    assert [trace.name for trace in both.panels[1].traces] == ["one", "two"]
