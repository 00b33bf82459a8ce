"""The models of the air that a scenario may name as ``atmosphere.model``."""

from __future__ import annotations

from edl6dof.environment.atmospheres import exponential, none, seasonal, table, us76
from edl6dof.registry import Family

ATMOSPHERES = Family(
    "atmosphere", (table.MEMBER, exponential.MEMBER, us76.MEMBER, none.MEMBER, seasonal.MEMBER)
)

AtmosphereChoice = ATMOSPHERES.params_model(
    "AtmosphereChoice", "model", "table", "Which model of the air.", bare=True
)

#: ``(index, atmosphere, gas, table, altitude)`` to density kg/m3, pressure Pa, temperature K and speed of
#: sound m/s.
air_of_model = ATMOSPHERES.switch("air", "atm", "gas", "table", "alt")
