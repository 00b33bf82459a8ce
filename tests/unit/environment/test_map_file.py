"""Files of height maps whose head is broken."""

from __future__ import annotations

import io

import numpy as np
import pytest

from edl6dof.environment.areoid import DATA
from edl6dof.environment.height_map import map_file, read_map


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"}", b" "),  # a tokenizer's error
        (b"'shape'", b"'shape "),
        (b"False", b"[]+[]"),
        (b"<f8", b"|O8"),
        (b"\x93NUMPY", b"PK\x03\x04\0\0"),
    ],
)
def test_broken_head_is_refused(old, new, tmp_path):
    buffer = io.BytesIO()
    np.save(buffer, np.zeros((2, 2)))
    content = buffer.getvalue()
    assert content.count(old) == 1
    (tmp_path / "map.npy").write_bytes(content.replace(old, new))
    (tmp_path / "map.yaml").write_text((DATA / "areoid" / "mars_gmm3_degree12.yaml").read_text())
    with pytest.raises(ValueError, match="no .npy file of numbers"):
        read_map(map_file(tmp_path / "map.npy"))
