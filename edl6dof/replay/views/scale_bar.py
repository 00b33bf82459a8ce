"""A bar of a round length above what the chase camera follows, by which the eye measures it."""

from __future__ import annotations

import numpy as np

from edl6dof.replay.history import thin
from edl6dof.replay.recorder import SLOW_HZ, Recorder
from edl6dof.replay.views.cameras import steady, together
from edl6dof.replay.views.spatial import EYE

COLOUR = (225, 225, 225)
#: Height of the bar in the camera's frame, and the largest length there; height of the strokes at its ends.
_ABOVE, _LONGEST, _STROKE = 1.12, 0.7, 0.03


class ScaleBar(Recorder):
    """Writes ``camera/scale_bar``."""

    def motions(self) -> None:
        """The bar, anew where what the camera takes in has changed."""
        rows = thin(self.t, SLOW_HZ)
        radius = steady(self.t, self.motion.centre, together(self.motion)).radius[rows]
        anew = np.append(True, np.abs(np.diff(np.round(np.log(radius) / 0.02))) > 0)
        rows, radius = rows[anew], radius[anew]
        length = round_down(_LONGEST * radius)
        across = np.cross(-EYE, [0.0, 0.0, 1.0])
        across /= np.linalg.norm(across)
        half = (0.5 * length / radius)[:, None] * across
        ends = np.stack([-half, half], axis=1) + [0.0, 0.0, _ABOVE]
        stroke = np.array([0.0, 0.0, _STROKE])
        strips = np.stack(
            [ends, ends[:, :1] + [-stroke, stroke], ends[:, 1:] + [-stroke, stroke]], axis=1
        ).reshape(-1, 2, 3)
        rr, entity = self.rr, f"{self.root}/camera/scale_bar"
        self.static(entity, rr.LineStrips3D.from_fields(colors=COLOUR, radii=rr.Radius.ui_points(0.9)))
        drawn = rr.LineStrips3D.columns(strips=strips).partition(np.full(len(rows), 3))
        self.columns(entity, self.t[rows], drawn)
        name = f"{entity}/length"
        self.static(name, rr.Points3D.from_fields(colors=COLOUR, radii=-0.01, show_labels=True))
        texts = rr.Points3D.columns(
            positions=ends[:, 1] + 0.12 * across, labels=[f"{one:g} m" for one in length]
        )
        self.columns(name, self.t[rows], texts)


def round_down(values: np.ndarray) -> np.ndarray:
    """The largest of 1, 2 and 5 times powers of ten that is not above each value, all positive."""
    power = 10.0 ** np.floor(np.log10(values))
    return power * np.select([values >= 5.0 * power, values >= 2.0 * power], [5.0, 2.0], 1.0)
