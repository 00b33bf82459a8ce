"""A flight in the viewer while it is flown: the flight so far is drawn as in a replay, again and again, and
what the viewer already has is left out.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from edl6dof.replay.blueprint import Layout
from edl6dof.replay.history import Flown
from edl6dof.replay.recorder import Recorder
from edl6dof.replay.recording import OF_EACH, OF_FIRST, history
from edl6dof.replay.scene.ground import Ground
from edl6dof.replay.scene.poses import Motion

if TYPE_CHECKING:
    import pyarrow as pa
    import rerun as rr


#: Time (s) in which the viewer must take what is sent.
_PATIENCE_S = 10.0


class Live:
    """Draws a flight while it is flown.

    Args:
        recording: stream to the viewer.
        planned: flight from which the arrangement of the views and the ground around the landing follow, such
            as the undisturbed one.
    """

    def __init__(self, recording: rr.RecordingStream, planned: Flown) -> None:
        past, self._sink = history(planned), _News(recording)
        motion = Motion(past)
        self.blueprint = Layout([past], motion, recording).blueprint()
        self._once: list[Recorder] = [Ground(past, motion, self._sink)]

    def update(self, flight: Flown) -> None:
        """Send what has been added to the flight.

        Raises:
            RuntimeError: the viewer does not take it.
        """
        past = history(flight)
        if len(past.t) < 2:
            return
        motion = Motion(past)
        parts = [part(past, motion, self._sink) for part in (*OF_FIRST, *OF_EACH)]
        for part in (*self._once, *(one for one in parts if not isinstance(one, Ground))):
            part.statics()
        for part in parts:
            part.motions()
        self._once = []
        self._sink.sent_until(float(past.t[-1]))


class _News:
    """Passes on to a recording what it does not have: rows after the last one, and timeless entities that
    have changed.
    """

    def __init__(self, recording: rr.RecordingStream) -> None:
        self._recording, self._after, self._now = recording, -inf, -inf
        self._timeless: dict[str, list[pa.Array]] = {}

    def log(self, entity: str, *what: Any, static: bool = False) -> None:
        """Log an entity, unless the recording has it."""
        if static:
            content = [batch.as_arrow_array() for one in what for batch in one.as_component_batches()]
            known = self._timeless.get(entity, [])
            if len(known) == len(content) and all(a.equals(b) for a, b in zip(known, content, strict=True)):
                return
            self._timeless[entity] = content
        elif self._now <= self._after:
            return
        self._recording.log(entity, *what, static=static)

    def set_time(self, timeline: str, *, duration: float) -> None:
        """Set the time (s) of what is logged next."""
        self._now = duration
        self._recording.set_time(timeline, duration=duration)

    def reset_time(self) -> None:
        """End the effect of :meth:`set_time`."""
        self._recording.reset_time()

    def send_columns(self, entity: str, indexes: Iterable[Any], columns: Iterable[Any]) -> None:
        """Send the new rows of a series."""
        (index,) = indexes
        times = index.as_arrow_array()
        t = times.to_numpy(zero_copy_only=False).astype("timedelta64[ns]") / np.timedelta64(1, "s")
        first = int(np.searchsorted(t, self._after, side="right"))
        if first < len(t):
            rows = slice(first, len(t))
            self._recording.send_columns(entity, [_Rows(index, rows)], [_Rows(one, rows) for one in columns])

    def sent_until(self, t: float) -> None:
        """Take all rows up to time ``t`` (s) as sent.

        Raises:
            RuntimeError: the viewer does not take them.
        """
        self._after = t
        self._recording.flush(timeout_sec=_PATIENCE_S)


class _Rows:
    """Some rows of a column of times or of a component."""

    def __init__(self, column: Any, rows: slice) -> None:
        self._column, self._rows = column, rows

    def timeline_name(self) -> str:
        """Name of the timeline, of a column of times."""
        return str(self._column.timeline_name())

    def component_descriptor(self) -> Any:
        """Descriptor of the component."""
        return self._column.component_descriptor()

    def as_arrow_array(self) -> pa.Array:
        """The rows."""
        return self._column.as_arrow_array()[self._rows]
