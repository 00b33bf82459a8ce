"""A report speaks of nothing that the vehicle does not have."""

from __future__ import annotations

import re

import pytest

import edl6dof
from edl6dof.manifest import seal
from edl6dof.report.document import Listing, Report, Table, Text
from edl6dof.report.figure import Figure
from edl6dof.report.flight.flight_report import flight_report
from edl6dof.runs.run import Run, write_run

#: What a body without parts, flight software or limits has none of.
PARTS = re.compile(
    r"parachute|thruster|propellant|engine|corridor|bank|radar|navigated|diagnos|\bfault|heat shield|"
    r"backshell|touchdown|guidance|mortar|flight computer|hazard",
    re.IGNORECASE,
)


def words(report: Report) -> str:
    """All words of a report but those of its scenario."""
    found = [report.title, report.headline, *(fact.label for fact in report.facts)]
    for section in report.sections:
        found.append(section.title)
        for block in section.blocks:
            if isinstance(block, Figure):
                found += [block.title, block.caption]
                for panel in block.panels:
                    found += [panel.title, panel.x.title, panel.y.title]
                    found += [trace.name for trace in panel.traces] + [mark.label for mark in panel.marks]
            elif isinstance(block, Table):
                found += [block.caption, *block.columns, *(str(row[0]) for row in block.rows)]
            elif isinstance(block, Text):
                found.append(block.words)
            else:
                assert isinstance(block, Listing)
    return "\n".join(found)


@pytest.fixture(scope="module")
def of_a_body(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drop")
    write_run(edl6dof.fly("earth_drop", ["simulation.time_limit_s=40"]), folder)
    seal(folder, "flight")
    return flight_report(Run(folder))


def test_report_of_a_body_without_parts_speaks_of_none(of_a_body):
    text = words(of_a_body)
    assert "Trajectory" in text and PARTS.findall(text) == []


def test_parts_are_spoken_of_where_there_are_some(run):
    assert len({part.lower() for part in PARTS.findall(words(flight_report(run)))}) > 12


def test_no_section_is_empty(run, of_a_body):
    for report in (flight_report(run), of_a_body):
        assert all(section.blocks for section in report.sections)
        assert all(panel.traces or panel.heat for figure in report.figures() for panel in figure.panels)


#: Words that a report may hold only where the vehicle has such parts.
WORDS = {
    "parachutes": r"parachute|canopy|mortar|riser",
    "thrusters": r"thruster|valve",
    "engines": r"engine|throttle|ignition",
    "surfaces": r"wing",
    "tanks": r"propellant",
}


@pytest.mark.parametrize(
    "name", ["titan_probe", "genesis", "stardust", "msl", pytest.param("viking1", marks=pytest.mark.long)]
)
def test_report_speaks_of_no_part_that_a_vehicle_has_not(name, tmp_path):
    flight = edl6dof.fly(name, ["simulation.time_limit_s=2", "mission.goal=time"])
    write_run(flight, tmp_path)
    seal(tmp_path, "flight")
    text, vehicle = words(flight_report(Run(tmp_path))), flight.scenario.vehicle
    parts = {**dict(vehicle), "thrusters": vehicle.rcs.thrusters}
    absent = [word for part, word in WORDS.items() if not parts[part]]
    assert absent
    assert [line for line in text.splitlines() if re.search("|".join(absent), line, re.IGNORECASE)] == []
