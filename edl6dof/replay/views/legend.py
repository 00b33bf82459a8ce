"""What the colours of the scene mean, of those things that the flight has."""

from __future__ import annotations

from edl6dof.replay.recorder import Recorder


class Legend(Recorder):
    """Writes ``/legend``; of the first flight only."""

    def statics(self) -> None:
        """A table of things and colours."""
        if self.number:
            return
        rows = "\n".join(f"| {what} | {colours} |" for what, colours in self._rows())
        text = f"| what | colours |\n|:--|:--|\n{rows}"
        self.static("legend", self.rr.TextDocument(text, media_type="text/markdown"))

    def _rows(self) -> list[tuple[str, str]]:
        """Things and what their colours mean."""
        flight, kinds = self.flight, {one.kind for one in self.flight.instruments}
        path = "each flight's own" if self.label else "of the phase, as in its lane"
        known = [
            (True, "path and trail", path),
            (True, "axes x, y, z", "red, green, blue; B of the body, V of the velocity"),
            (True, "arrows", "velocity cyan, lift green, thrust amber, disturbance pink"),
            (True, "target, planned ellipse", "cyan"),
            ("beam" in kinds, "radar beams", "echo used green, not used amber, excluded red"),
            (flight.landing_map is not None, "hazard map", "safe green, too steep amber, too rough red"),
            (bool(flight.failures), "thruster", "failed red"),
            (bool(self.vehicle.engines), "lane of the engine", "burning orange"),
        ]
        return [(what, colours) for there, what, colours in known if there]
