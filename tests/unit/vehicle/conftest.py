"""The tables of Tianwen-1, built once."""

import pytest

import edl6dof
from edl6dof.scenario.records import build_tables


@pytest.fixture(scope="session")
def tables():
    return build_tables(edl6dof.load("tianwen1").scenario)
