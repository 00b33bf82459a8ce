"""The name of a phase is only shown: with every phase renamed, figures, report, replay, fault cases and
studies are the same.
"""

from __future__ import annotations

import base64
import copy
import re

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest

import edl6dof
from edl6dof.campaign.faults import phases_of
from edl6dof.config.document.locate import resolve_scenario
from edl6dof.interface.roles import LIFT, PARACHUTE, TRIM, begun, during, span
from edl6dof.manifest import seal
from edl6dof.replay.pages import TIMELINE
from edl6dof.replay.recording import history, write_replay
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.report.page import PLOTLY, page
from edl6dof.runs.run import Run, write_run
from edl6dof.studies import hu2022, yan2016
from edl6dof.telemetry.timeline import first_times

#: Of these the new names are made, each of one: no number or hash holds them.
LETTERS = "qxzjkvwyuhgnm"


def renamed_file(name, folder):
    """A shipped scenario with other names of its phases, as long as the old ones (a lane of the replay names
    those that it has room for), and the old name of each new one.
    """
    text, old = resolve_scenario(name).read_text(encoding="utf-8"), {}

    def renamed(match):
        new = re.sub("[a-z]", LETTERS[len(old)], match[1])
        old[new] = match[1]
        return f"- name: {new}\n"

    path = folder / f"{name}.yaml"
    text = re.sub(r"- name: (\w+)\n(?=      (?:role|guidance): )", renamed, text)
    new = {name: stage for stage, name in old.items()}
    path.write_text(re.sub(r"(?<=next: )\w+", lambda match: new[match[0]], text), encoding="utf-8")
    return path, old


@pytest.fixture(scope="module")
def other(tmp_path_factory):
    path, old = renamed_file("tianwen1", tmp_path_factory.mktemp("scenario"))
    return edl6dof.fly(path), old


@pytest.fixture(scope="module")
def other_run(other, tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "renamed"
    folder.mkdir()
    write_run(other[0], folder)
    seal(folder, "flight")
    return Run(folder)


def with_old_names(text, old):
    for new, name in old.items():
        text = text.replace(new, name).replace(new.replace("_", " "), name.replace("_", " "))
    return text


def test_every_phase_has_another_name(nominal, other):
    flight, old = other
    assert [old[name] for name in flight.phase_names] == nominal.phase_names


def test_figures_and_checks_are_the_same(nominal, other):
    flight = other[0]
    assert (
        flight.figures == nominal.figures
        and flight.checks == nominal.checks
        and flight.outcome == nominal.outcome
    )


def test_figures_need_the_roles(tmp_path):
    """Without any role only the figures that ask for none are left: it is the role that is asked for."""
    text = resolve_scenario("msl").read_text(encoding="utf-8")
    path = tmp_path / "msl.yaml"
    path.write_text(re.sub(r"      role: \w+\n", "", text), encoding="utf-8")
    gone = edl6dof.fly("msl").figures.keys() - edl6dof.fly(path).figures.keys()
    assert {"lift_start_s", "trim_aoa_limit_cycle_deg", "bank_reversals", "max_rate_parachute_deg_s"} <= gone


def test_report_is_the_same(run, other, other_run):
    # any letters may stand in the packed plotly.js
    packed = base64.b64encode(PLOTLY.read_bytes()).decode()
    pages = [page(flight_report(one)).replace(packed, "") for one in (run, other_run)]
    hashes = [one.summary["scenario_sha256"] for one in (run, other_run)]
    assert with_old_names(pages[1], other[1]).replace(hashes[1], hashes[0]) == pages[0]


def fewer_rows(flight):
    """The flight with every tenth row of its telemetry, and what was found in all of them."""
    assert flight.outcome and flight.checks and flight.events
    few = copy.copy(flight)
    few.telemetry = {name: values[::10] for name, values in flight.telemetry.items()}
    return few


def rows_of(flight, path, old):
    """What a recording holds of each entity, by the names of its columns, in the order of time: how many rows
    a chunk takes depends on the time that passes while they are written.
    """
    from rerun.chunk import RrdReader

    write_replay([history(fewer_rows(flight))], path)
    found = {}
    for chunk in RrdReader(path).stream().to_chunks():
        batch = chunk.to_record_batch()
        columns = {
            name: batch.column(name)
            for name in batch.schema.names
            if ":" in name and name != "RecordingInfo:start_time"
        }
        if TIMELINE in batch.schema.names:
            columns[TIMELINE] = batch.column(TIMELINE).cast("int64")
        found.setdefault((chunk.entity_path, *columns), []).append(pa.table(columns))
    return {key: content(pa.concat_tables(parts), old) for key, parts in found.items()}


def content(table, old):
    """Texts with the old names, and the bytes of everything else."""
    rows = pc.sort_indices(table[TIMELINE]) if TIMELINE in table.column_names else np.arange(len(table))
    table = table.take(rows).combine_chunks()
    words = [name for name in table.column_names if "string" in str(table[name].type)]
    numbers = pa.BufferOutputStream()
    with pa.ipc.new_stream(numbers, table.drop_columns(words).schema) as stream:
        stream.write_table(table.drop_columns(words))
    return with_old_names(repr(table.select(words).to_pylist()), old), numbers.getvalue().to_pybytes()


def test_replay_is_the_same(nominal, other, tmp_path):
    first, second = rows_of(nominal, tmp_path / "a.rrd", {}), rows_of(other[0], tmp_path / "b.rrd", other[1])
    assert first.keys() == second.keys() and len(first) > 50
    differing = [entity for entity in first if first[entity] != second[entity]]
    assert [entity for entity, *_ in differing] == ["/legend"], (
        "which explains the initials of the phases' names"
    )


def test_usual_faults_begin_in_the_same_phases_and_do_the_same(nominal, other, tmp_path):
    flight, old = other
    assert [old[name] for name in phases_of(flight.scenario)] == phases_of(nominal.scenario)
    fault = "faults=[{{thruster: D5, kind: stuck_off, at: {{phase: {}, plus_s: 1}}}}]"
    first = edl6dof.fly("tianwen1", [fault.format("hazard_avoidance")])
    second = edl6dof.fly(
        renamed_file("tianwen1", tmp_path)[0],
        [fault.format(flight.phase_names[nominal.phase_names.index("hazard_avoidance")])],
    )
    assert first.figures == second.figures and "time_to_detect_s" in first.figures


@pytest.mark.parametrize(
    "module, flights", [pytest.param(hu2022, 1, marks=pytest.mark.long), (yan2016, yan2016.RUNS)]
)
def test_study_finds_the_same(module, flights, tmp_path, monkeypatch):
    """Of the avoidances of Hu et al., those with the thruster of the paper's figure, of Yan et al. one
    corner: the others differ in nothing that has a name.
    """
    every, shown = hu2022.pushes, hu2022.SHOWN
    monkeypatch.setattr(yan2016, "CORNERS", yan2016.CORNERS[:1])
    monkeypatch.setattr(hu2022, "MOMENTS_S", hu2022.MOMENTS_S[:1])
    monkeypatch.setattr(hu2022, "pushes", lambda scenario: {shown: every(scenario)[shown]})

    def found():
        return repr(module.STUDY.fly(flights).findings)

    before = found()
    path, old = renamed_file(module.SCENARIO, tmp_path)
    monkeypatch.setattr(module, "SCENARIO", path)
    assert with_old_names(found(), old) == before


def test_several_phases_of_a_role_count_from_the_first_to_the_last():
    roles = [TRIM, LIFT, "none", LIFT, PARACHUTE]
    assert span(roles, LIFT) == (1, 4) and span(roles, TRIM) == (0, 1) and span(roles, "landed") == (0, 0)
    assert during(np.array([0.0, 1.0, 2.0, 3.0, 4.0]), roles, LIFT).tolist() == [
        False,
        True,
        True,
        True,
        False,
    ]
    assert not during(np.array([0.0, 1.0]), roles, "landed").any()


def test_a_role_begins_with_its_first_phase(nominal):
    events = [
        {"key": f"phase.{number}", "t_s": 2.0 * number, "role": role}
        for number, role in enumerate((TRIM, LIFT, LIFT, "none"))
    ]
    when = first_times(events)
    assert when[begun(LIFT)] == 2.0 and when["phase.2"] == 4.0 and begun("none") not in when
    assert first_times(nominal.events)[begun(LIFT)] == nominal.figures["lift_start_s"]
