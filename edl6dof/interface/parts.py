"""Parts that leave the vehicle, and the configurations between their separations."""

from __future__ import annotations

#: Parts that can be jettisoned, as the vehicle file names them; records carry the index.
PARTS = ("heat_shield", "backshell", "parachute")
HEAT_SHIELD, BACKSHELL, PARACHUTE = range(len(PARTS))

#: Parts that are gone in each configuration: at entry, under the parachute, and of the lander alone; records
#: carry the index.
CONFIGURATIONS = ((), ("heat_shield", "parachute"), ("heat_shield", "backshell", "parachute"))
ENTRY, UNDER_CHUTE, LANDER = range(len(CONFIGURATIONS))
