"""The trajectory of a run as KML 2.2 (OGC 07-147r2): its line, and a placemark at each main event.

Altitudes are absolute: heights above the areoid, which stands for the mean sea level of KML.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from edl6dof.runs.run import Run
from edl6dof.telemetry.thinning import bends

NAMESPACE = "http://www.opengis.net/kml/2.2"
PLACE = ("truth.longitude_deg", "truth.latitude_deg", "truth.height_above_areoid_m")
#: Planets that Google Earth can show, in lower case.
GLOBES = ("earth", "mars", "moon")
#: Keys of events without a placemark; phases, which begin at other events, have none either.
MINOR = ("bank_reversal", "line_stretch", "trim_wing_open", "relaxed", "guard")


def write_kml(path: Path, run: Run) -> int:
    """Write the trajectory of a run; return the number of its points, between which straight lines pass each
    row of telemetry within 1/4000 of the range of a coordinate.
    """
    planet = str(run.scenario["planet"]["name"])
    root = Element("kml", xmlns=NAMESPACE)
    if planet.lower() in GLOBES:
        root.set("hint", f"target={planet.lower()}")
    document = SubElement(root, "Document")
    _tell(document, f"{run.name} on {planet}", f"{run.summary['outcome']}; planet: {planet}")
    places = np.column_stack([run[name] for name in PLACE])
    places[:, 0] = np.where(places[:, 0] > 180.0, places[:, 0] - 360.0, places[:, 0])
    rows = bends(run.t, places)
    rows = rows[np.isfinite(places[rows]).all(axis=1)]
    _placemark(document, "LineString", (run.name, "trajectory"), places[rows])
    for event in run.events:
        if "phase" not in event and event["key"] not in MINOR:
            row = int(np.abs(run.t - event["t_s"]).argmin())
            _placemark(document, "Point", (event["name"], _state(event)), places[[row]])
    ElementTree.indent(root)
    ElementTree.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)
    return len(rows)


def _placemark(document: Element, shape: str, words: tuple[str, str], places: np.ndarray) -> None:
    """Add points (longitude and latitude in degrees, height in m), shape (n, 3)."""
    placemark = SubElement(document, "Placemark")
    _tell(placemark, *words)
    geometry = SubElement(placemark, shape)
    SubElement(geometry, "altitudeMode").text = "absolute"
    SubElement(geometry, "coordinates").text = " ".join(f"{x:.7f},{y:.7f},{z:.2f}" for x, y, z in places)


def _tell(element: Element, name: str, description: str) -> None:
    SubElement(element, "name").text = name
    SubElement(element, "description").text = description


def _state(event: Mapping[str, Any]) -> str:
    """Time, height, speed and Mach number of an event in words."""
    values = (("{:.2f} s", "t_s"), ("{:.0f} m above the ground", "height_m"), ("{:.1f} m/s", "speed_m_s"))
    found = [form.format(event[key]) for form, key in values if event[key] is not None]
    return ", ".join([*found, *([] if event["mach"] is None else [f"Mach {event['mach']:.2f}"])])
