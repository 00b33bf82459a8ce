"""Scenario files with a designed entry: with its bank profile, or aimed at another site."""

from __future__ import annotations

from pathlib import Path

from edl6dof.config.document.document import EXTENDS, Document
from edl6dof.config.document.locate import extends_name
from edl6dof.config.document.overrides import with_values
from edl6dof.config.document.yamltree import write_scalar
from edl6dof.design.entry_profile import Design
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.loading import check_document
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import resolved_text


def write_designed(scenario: str, whole: bool, loaded: LoadedScenario, found: Design, path: Path) -> None:
    """Write a scenario with the designed profile as YAML: one that extends the given one, or ``whole``."""
    rows = (f"          - {{at: {at:.1f}, bank_deg: {bank:.2f}}}\n" for at, bank in found.after.points)
    changes = f"""\
flight_software:
  guidance:
    entry:
      reference_bank:
        points:  # [D] edl6dof design entry {scenario}
{"".join(rows)}"""
    points = [{"at": round(at, 1), "bank_deg": round(bank, 2)} for at, bank in found.after.points]
    values = {"flight_software.guidance.entry.reference_bank.points": points}
    document = with_values(loaded.document, values, Scenario) if whole else None
    _write(path, f"{loaded.scenario.name}_designed", scenario, changes, document)


def write_aimed(scenario: str, whole: bool, aimed: LoadedScenario, path: Path) -> None:
    """Write the scenario at its new site as YAML: one that extends the given one, or ``whole``."""
    new = aimed.scenario
    changes = f"""\
terrain:
  site_latitude_deg: {new.terrain.site_latitude_deg}   # [S]
  site_longitude_deg: {new.terrain.site_longitude_deg}  # [S]
  site_elevation_m: {new.terrain.site_elevation_m}  # [D] edl6dof design aim {scenario}
initial:
  epoch_utc: {write_scalar(new.initial.epoch_utc)}  # [S]
  latitude_deg: {new.initial.latitude_deg}  # [D] edl6dof design aim {scenario}
  longitude_deg: {new.initial.longitude_deg}  # [D] the same
"""
    _write(path, f"{new.name}_aimed", scenario, changes, aimed.document if whole else None)


def _write(path: Path, name: str, scenario: str, changes: str, document: Document | None) -> None:
    """Write a scenario with a name: changes of the given one, or a whole document."""
    text = f"{EXTENDS}: {write_scalar(extends_name(scenario))}\nname: {write_scalar(name)}\n{changes}"
    if document is not None:
        text = resolved_text(check_document(with_values(document, {"name": name}, Scenario)))
    path.write_text(text, encoding="utf-8")
