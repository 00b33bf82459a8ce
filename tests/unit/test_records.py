"""The walk over the numbers of a record."""

import numpy as np

from edl6dof.interface.sensed import SENSED
from edl6dof.records import TIME_IF_EVER, finite_words, first_not_finite, whole

#: A record of a sensor that is still to be built, behind the images.
SUN = np.dtype([("direction", "f8", (3,)), ("seen", whole(0, 1)), ("last", TIME_IF_EVER)], align=True)
ROWS = np.dtype([("index", whole(0, 9)), ("value", "f8")], align=True)
MORE = np.dtype(
    [*((name, SENSED[name]) for name in SENSED.names or ()), ("sun", SUN), ("rows", ROWS, (3,))], align=True
)


def watched(layout):
    return {word for first, end in finite_words(layout) for word in range(first, end)}


def test_every_float_that_should_be_finite_is_found_wherever_it_stands():
    """Each word is made NaN by itself; images, floats of four bytes, have two to a word."""
    record, words = np.zeros(1, MORE), watched(MORE)
    raw = record.view(np.uint64)
    images = np.ones(1, MORE)
    for name in ("lidar", "stereo"):
        images[name]["range"] = np.nan
    images["camera"]["density"] = np.nan
    of_images = np.isnan(images.view(np.float32)).reshape(-1, 2).any(axis=1)
    for word in np.flatnonzero(~of_images):
        raw[word] = np.float64(np.nan).view(np.uint64)
        assert (first_not_finite(record) is not None) == (word in words), word
        raw[word] = 0
    assert not words & set(np.flatnonzero(of_images).tolist())


def test_a_new_sensed_field_is_among_them_behind_the_images():
    assert len(watched(MORE)) == len(watched(SENSED)) + 3 + 3


def test_runs_are_as_few_as_there_are_gaps():
    runs = finite_words(MORE)
    assert all(before[1] < after[0] for before, after in zip(runs, runs[1:], strict=False))
