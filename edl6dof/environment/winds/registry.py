"""The models of the mean wind that a scenario may name as ``wind.model``."""

from __future__ import annotations

from edl6dof.environment.winds import constant, none, shear, table
from edl6dof.registry import Family

WINDS = Family("mean wind", (table.MEMBER, constant.MEMBER, shear.MEMBER, none.MEMBER))

WindChoice = WINDS.params_model("WindChoice", "model", "table", "Which model of the mean wind.", bare=True)

#: ``(index, wind, table, altitude)`` to the mean wind towards east and north, m/s.
wind_of_model = WINDS.switch("mean", "wind", "table", "alt")
