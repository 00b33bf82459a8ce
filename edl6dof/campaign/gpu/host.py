"""What the processor does for a flight on a GPU: what goes there, and what is made of what comes back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.campaign.design.variants import Variant
from edl6dof.campaign.executor import CaseRunner, Ready
from edl6dof.campaign.gpu.layouts import LAUNCH_S, WHOLE_LOG, Layout, launch_rows, layout_of
from edl6dof.campaign.rows import Row, failed_row, flown_row
from edl6dof.scenario.records import Records
from edl6dof.sim.figures import telling_of
from edl6dof.sim.flight import flight_of
from edl6dof.sim.flown import Flown
from edl6dof.sim.underway import beginning, last_cycle
from edl6dof.vehicle.plant import OUTPUTS, WORKSPACE


class Start(NamedTuple):
    """A flight that is to begin on a GPU.

    Attributes:
        layout: how it lies in memory there.
        own: its records by the names of the layout, as bytes.
        onboard, tables: what the flight computer believes, as bytes, and the tables, shape (1,); ``None``:
            those of the nominal case.
        needs: what its figures need of its telemetry (``TELLING``), as bytes; empty: all rows.
        rows: of telemetry that there must be room for.
        launch_rows: that it logs in a launch at most.
        last_cycle: base cycle after which the time limit has ended it.
        base_hz, steps: base cycles in a second, and steps of a base cycle.
    """

    layout: Layout
    own: dict[str, bytes]
    onboard: bytes | None
    tables: np.ndarray | None
    needs: bytes
    rows: int
    launch_rows: int
    last_cycle: int
    base_hz: int
    steps: int


class Left(NamedTuple):
    """What a flight leaves: records by the names of its layout and rows of telemetry, as bytes; outcome code
    of the loop, and the base cycle that would come next.
    """

    own: dict[str, bytes]
    log: bytes
    code: int
    cycle: int


class Host:
    """Prepares cases of a scenario, and makes rows of what their flights leave."""

    def __init__(self, runner: CaseRunner):
        self._runner = runner
        self._waiting: dict[int, tuple[Ready | str, Layout]] = {}

    @property
    def nominal(self) -> Records:
        """Records of the case without changes."""
        return self._runner.variants.nominal.records

    def prepare(self, cases: Sequence[Case]) -> list[Start | None]:
        """What begins of each case: nothing, where it cannot fly."""
        return [self._prepared(case) for case in cases]

    def _prepared(self, case: Case) -> Start | None:
        ready = self._runner.prepared(case)
        if isinstance(ready, str):
            self._waiting[case.index] = ready, WHOLE_LOG
            return None
        layout = layout_of(ready.variant, self._runner.collect is not None)
        self._waiting[case.index] = ready, layout
        return start_of(ready.variant, layout, self.nominal)

    def again(self, case: Case) -> Start:
        """A case that was prepared, to keep every row of its telemetry."""
        ready, _ = self._waiting[case.index]
        assert isinstance(ready, Ready)
        self._waiting[case.index] = ready, WHOLE_LOG
        return start_of(ready.variant, WHOLE_LOG, self.nominal)

    def rows(self, cases: Sequence[Case], left: Sequence[Left | None]) -> list[Row]:
        """Rows of cases that were prepared, from what each has left: nothing, where it could not fly."""
        return [self._row(case, one) for case, one in zip(cases, left, strict=True)]

    def _row(self, case: Case, left: Left | None) -> Row:
        ready, layout = self._waiting.pop(case.index)
        if isinstance(ready, str):
            return failed_row(case, ready)
        assert left is not None
        flight = flight_of(flown(ready.variant, layout, left))
        return flown_row(case, ready.changes, flight, self._runner.collect)


def start_of(variant: Variant, layout: Layout, nominal: Records) -> Start:
    """The beginning of a flight."""
    (case, tables, onboard), loaded = variant.parts, variant.loaded
    kinds = layout.own["sensors"], layout.own["fsw"]
    _, plant, peaks, sensors, fsw = beginning(loaded, case, onboard, *kinds)
    own = {
        "case": case, "plant": plant, "outputs": np.zeros(1, OUTPUTS), "peaks": peaks,
        "work": np.zeros(1, WORKSPACE), "sensors": sensors, "fsw": fsw,
    }  # fmt: skip
    believed, needs = onboard.tobytes(), telling_of(loaded.scenario) if layout.thinned else None
    return Start(
        layout,
        {name: record.tobytes() for name, record in own.items()},
        None if believed == nominal.onboard.tobytes() else believed,
        None if tables is nominal.tables else tables,
        b"" if needs is None else needs.tobytes(),
        layout.rows(variant),
        launch_rows(variant, LAUNCH_S),
        last_cycle(loaded),
        loaded.scenario.flight_software.rates.base_hz,
        loaded.scenario.steps_per_cycle,
    )


def flown(variant: Variant, layout: Layout, left: Left) -> Flown:
    """A flight at its end; nothing has changed in its case, of which nothing comes back."""
    case, tables, onboard = variant.parts
    names = ("plant", "outputs", "peaks", "work", "sensors", "fsw")
    plant, outputs, peaks, work, sensors, fsw = (
        np.frombuffer(bytearray(left.own[name]), layout.own[name]) for name in names
    )
    log = np.frombuffer(bytearray(left.log), layout.log)
    changed = plant, outputs, peaks, work, sensors, fsw
    return Flown(variant.loaded, case, tables, onboard, *changed, log, left.code, left.cycle)
