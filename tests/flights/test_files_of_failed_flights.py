"""A flight that fails leaves whole files, whatever reads them afterwards says something, and its case flies
again to the same row.
"""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest
from in_process import called

from edl6dof.api.reports import report_of
from edl6dof.report.document import Section
from edl6dof.report.pdf import write_pdf

FILES = {"scenario.yaml", "telemetry.parquet", "events.json", "summary.json", "manifest.json", "replay.rrd"}
#: Over in its first cycle, numbers that grow beyond all bounds, a leg as long as one may be.
FAILURES = {
    "at_once": ["initial.rate_deg_s=[0, 0, 400]", "sensors.set=perfect"],
    "diverged": ["vehicle.landing_gear.damping_n_s_m=1e12", "simulation.log_every=20"],
    "thrown": ["vehicle.landing_gear.footpads_m.1.2=200", "simulation.log_every=20"],
}


def not_json(word):
    raise AssertionError(f"{word} is no JSON")


#: The flight that is thrown leaves files of the same kind as the one that diverges.
ENDED = ["at_once", "diverged", pytest.param("thrown", marks=pytest.mark.long)]


@pytest.fixture(scope="module", params=ENDED)
def flown(request, tmp_path_factory):
    """The folder of a failed flight, in a folder with a healthy one."""
    folder = tmp_path_factory.mktemp(request.param)
    sets = [word for change in FAILURES[request.param] for word in ("--set", change)]
    done = called("fly", "tianwen1", "--out", "failed", *sets, cwd=folder)
    assert done.returncode == 1 and "Traceback" not in done.stderr, done.stderr[-2000:]
    short = ("--no-replay", "--set", "simulation.time_limit_s=50")
    assert called("fly", "tianwen1", "--out", "sound", *short, cwd=folder).returncode == 1
    return folder


def test_all_files_are_there_and_whole(flown):
    run = flown / "failed"
    assert {path.name for path in run.iterdir()} == FILES
    summary, events = (
        json.loads((run / name).read_text(), parse_constant=not_json)
        for name in ("summary.json", "events.json")
    )
    assert not summary["success"] and " in phase " in summary["outcome"]
    assert events[-1]["name"] == summary["outcome"]
    assert pq.read_table(run / "telemetry.parquet").num_rows >= 1


def read_or_refused(done):
    assert "Traceback" not in done.stderr, done.stderr[-2000:]
    assert done.returncode == 0 or (done.returncode == 2 and done.stderr.strip())


@pytest.mark.parametrize(
    "words",
    [
        ["report", "failed"],
        ["plot", "failed", "truth.rate_*", "--out", "rates.png"],
        *(["export", "failed", "--format", form] for form in ("csv", "mat", "nc", "oem", "aem", "kml")),
        ["export", "failed", "--nesc"],
        ["compare", "failed", "sound"],
        pytest.param(["compare", "sound", "failed"], marks=pytest.mark.long),
        ["replay", "failed", "--html", "replay.html"],
    ],
    ids=" ".join,
)
def test_what_reads_them_does_so_or_says_why_not(flown, words):
    read_or_refused(called(*words, cwd=flown))


@pytest.mark.long
@pytest.mark.parametrize("flown", ["at_once", "diverged"], indirect=True)
def test_all_figures_are_drawn_of_one_row_and_of_numbers_beyond_all_bounds(flown):
    read_or_refused(called("report", "failed", "--pdf", cwd=flown))


def beyond_all_bounds(figure):
    traces = (trace for panel in figure.panels for trace in panel.traces)
    return any(np.nanmax(np.abs(trace.y), initial=0.0) > 1e30 for trace in traces)


@pytest.mark.parametrize("flown", ["diverged"], indirect=True)
def test_figures_are_drawn_of_numbers_beyond_all_bounds(flown):
    report = report_of(flown / "failed")
    figures = [figure for figure in report.figures() if beyond_all_bounds(figure)]
    assert len(figures) > 2
    write_pdf(replace(report, sections=[Section("beyond", "Beyond", figures[:1])]), flown / "beyond.pdf")
    assert (flown / "beyond.pdf").stat().st_size > 10_000


def test_drawings_of_the_page_are_strict_json(flown):
    assert called("report", "failed", "--out", "page.html", "--force", cwd=flown).returncode == 0
    _, _, rest = (
        (flown / "page.html").read_text().partition('<script type="application/json" id="figure-data">')
    )
    assert json.loads(rest.partition("</script>")[0], parse_constant=not_json)


def test_case_that_diverges_flies_again_to_the_same_row(tmp_path):
    """Legs so stiff that the first millimetre throws the vehicle out of all numbers; some that land tilted
    tip over before.
    """
    (tmp_path / "stiff.yaml").write_text(
        "extends: tianwen1\nname: stiff\nvehicle: {landing_gear: {stiffness_n_m: 1.0e+12}}\n"
        "simulation: {log_every: 20}\n"
        "campaign: {cases: 3, truth: {atmosphere.density_factor: {kind: uniform, half_width: 0.02}}}\n"
    )
    first = called("campaign", "stiff.yaml", "--out", "dispersed", cwd=tmp_path)
    assert "Traceback" not in first.stderr, first.stderr[-2000:]
    cases = pq.read_table(tmp_path / "dispersed/cases.parquet", columns=["case", "cause"]).to_pylist()
    diverged = [row["case"] for row in cases if row["cause"].startswith("not finite: ")]
    assert diverged, cases
    again = called("refly", "dispersed", str(diverged[-1]), "--no-replay", cwd=tmp_path)
    assert "Traceback" not in again.stderr, again.stderr[-2000:]
    assert "identical" in again.stdout + again.stderr
