"""Shared flights: the nominal is flown once for the whole session."""

from __future__ import annotations

import pytest

import edl6dof


@pytest.fixture(scope="session")
def nominal():
    """The nominal Tianwen-1 flight."""
    return edl6dof.fly("tianwen1")
