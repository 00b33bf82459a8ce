"""A server for all tests of a file."""

from __future__ import annotations

import pytest
from serving import serving


@pytest.fixture(scope="module")
def server():
    with serving("tianwen1") as running:
        yield running
