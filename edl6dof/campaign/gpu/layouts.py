"""What a flight has of its own in the memory of a GPU, and how much of it.

The size of a record is part of the machine code.  A flight without eyes has records of its own, in which
their images and maps take no room, and machine code for these; on the processor, where pages that are never
touched take no memory, one code flies all.
"""

from __future__ import annotations

from math import ceil, prod
from typing import NamedTuple

import numpy as np

from edl6dof.campaign.design.variants import Variant
from edl6dof.fsw.onboard import FSW
from edl6dof.metrics.evaluation import LIMIT_CYCLE_S
from edl6dof.scenario.case import CASE
from edl6dof.sensors.registry import EYES, SENSORS
from edl6dof.sim.figures import telling_of
from edl6dof.sim.underway import log_rows
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.plant import OUTPUTS, PEAKS, STATE, WORKSPACE

#: Flight time of one launch.
LAUNCH_S = 10.0
#: Rows of telemetry that figures may need, beside the last of the trim phase; most flights need a hundred.
TELLING_ROWS = 500
#: Numbers of an array from which on it is an image or a map.
_IMAGE = 64
#: What eyes write to: theirs among the sensors, theirs in what is sensed, that of hazard detection.
_SEEN = {
    "sensors": (*EYES, *(f"sensed.{name}" for name in ("lidar", "stereo", "camera"))),
    "fsw": ("hazard",),
}


class Layout(NamedTuple):
    """How the flights of a batch lie in memory.

    Attributes:
        name: of the layout.
        own: record layouts of what each flight has of its own, in the order of the arguments of the loop.
        log: rows of telemetry, ``TICK`` or ``BRIEF``.
        thinned: whether rows that no figure needs are dropped after every launch.
    """

    name: str
    own: dict[str, np.dtype]
    log: np.dtype
    thinned: bool

    def rows(self, variant: Variant) -> int:
        """Rows of telemetry that a flight must have room for."""
        if not self.thinned:
            return log_rows(variant.loaded)
        return TELLING_ROWS + launch_rows(variant, LIMIT_CYCLE_S) + launch_rows(variant, LAUNCH_S)

    def size(self, rows: int) -> int:
        """Bytes of one flight whose log has so many rows."""
        flags = rows if self.thinned else 0
        return sum(layout.itemsize for layout in self.own.values()) + rows * self.log.itemsize + flags


def launch_rows(variant: Variant, duration_s: float) -> int:
    """Most rows that a flight logs in some time."""
    loaded = variant.loaded
    rate = loaded.scenario.flight_software.rates.base_hz / loaded.truth.simulation.log_every
    return ceil(duration_s * rate) + 2


def layout_of(variant: Variant, collects: bool) -> Layout:
    """How a flight lies in memory; ``collects``: whether more of it is asked for than its figures."""
    if collects:
        return WHOLE_TELEMETRY
    seeing = not set(EYES).isdisjoint(variant.loaded.truth.sensors_in_flight.flown)
    return WHOLE_LOG if seeing or telling_of(variant.loaded.scenario) is None else LEAN


def without(layout: np.dtype, sections: tuple[str, ...]) -> np.dtype:
    """A record layout without the images and maps of some of its sections, given by dotted paths: each is one
    number in it.
    """
    assert layout.names is not None
    fields = []
    for name in layout.names:
        inner = tuple(path.partition(".")[2] for path in sections if path.partition(".")[0] == name)
        part = layout[name]
        if inner:
            part = without(part, inner) if all(inner) else _shrunk(part)
        fields.append((name, part))
    return np.dtype(fields, align=True)


def _shrunk(layout: np.dtype) -> np.dtype:
    if layout.subdtype is not None:
        base, shape = layout.subdtype
        return np.dtype((_shrunk(base), tuple(1 for _ in shape) if prod(shape) >= _IMAGE else shape))
    if layout.names is None:
        return layout
    return np.dtype([(name, _shrunk(layout[name])) for name in layout.names], align=True)


_OWN = {
    "case": CASE, "plant": STATE, "outputs": OUTPUTS, "peaks": PEAKS,
    "work": WORKSPACE, "sensors": SENSORS, "fsw": FSW,
}  # fmt: skip
#: All channels; what figures need, row for row; what they need of a flight without eyes.
WHOLE_TELEMETRY, WHOLE_LOG = Layout("telemetry", _OWN, TICK, False), Layout("log", _OWN, BRIEF, False)
LEAN = Layout("lean", _OWN | {name: without(_OWN[name], paths) for name, paths in _SEEN.items()}, BRIEF, True)
