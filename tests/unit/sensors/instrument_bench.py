"""A bench for one sensor: the records that it reads, at rest in vacuum at the start, and a step of it."""

from functools import cache

import numpy as np
from numba import njit

import edl6dof
from edl6dof.config.dtype import dtype_of, fill
from edl6dof.interface.sensed import SENSED
from edl6dof.scenario.records import build_records, initial_plant
from edl6dof.sensors.registry import SENSOR_FAMILY
from edl6dof.spatial.random_numbers import Stream
from edl6dof.vehicle.plant import ATTITUDE, OUTPUTS, POSITION, RATE, VELOCITY

LOADED = edl6dof.load("tianwen1")


class Bench:
    """One sensor with its parameters, the errors of its copy in ``case``, and a plant to move by hand."""

    def __init__(self, name, params=None, seed=1, case=0, loaded=LOADED):
        member = SENSOR_FAMILY.member(name)
        given = member.params(**(params or {}))
        self.params = np.zeros(1, dtype_of(member.params))[0]
        fill(self.params, given)
        self.unit = np.zeros(1, member.tables)[0]
        if member.plan is not None:
            member.plan(given, Stream(seed, case, 100), self.unit)
        records = built() if loaded is LOADED else build_records(loaded)
        self.case, self.tables = records.case.copy()[0], records.tables[0]
        self.plant = initial_plant(loaded.truth, records.case)[0]
        self.put(w=(0.0, 0.0, 0.0))
        self.outputs = np.zeros(1, OUTPUTS)[0]
        self.memory = np.zeros(1, member.memory)[0]
        self.sensed = np.zeros(1, SENSED)[0]
        self.kernel = member.kernels["measure"]
        self._taken = (self.params, self.unit, self.case, self.tables, self.plant, self.outputs, self.memory)

    def put(self, t=None, r=None, v=None, q=None, w=None):
        """Move the plant."""
        y = self.plant["y"]
        for place, value in ((POSITION, r), (VELOCITY, v), (ATTITUDE, q), (RATE, w)):
            if value is not None:
                y[place : place + len(value)] = value
        if t is not None:
            self.plant["t"] = t

    def measure(self, **state):
        """Move the plant and let the sensor measure."""
        self.put(**state)
        self.kernel(*self._taken, self.sensed)
        return self.sensed

    def series(self, cycles, h, part):
        """What the sensor writes into a part of the sensed record, in many cycles of ``h`` s at rest.

        In one compiled loop: at each call from Python numpy describes all fields of the records, in 0.1 ms.
        """
        kind = SENSED[part]
        rows = np.zeros((cycles, *kind.shape), kind.base)
        every = (np.asarray(record).reshape(1) for record in (*self._taken, self.sensed))
        _loop(self.kernel, part)(*every, rows, h)
        return rows


@cache
def built():
    """The records of the flight that benches have where they ask for no other."""
    return build_records(LOADED)


@cache
def _loop(measure, part):
    is_row, kernel = len(SENSED[part].shape) == 1, measure

    @njit
    def loop(params, unit, case, tables, plant, outputs, memory, sensed, rows, h):
        for k in range(len(rows)):
            plant[0].t = k * h
            kernel(params[0], unit[0], case[0], tables[0], plant[0], outputs[0], memory[0], sensed[0])
            if is_row:  # number by number: a slice would have words about its size compiled with it
                for i in range(rows.shape[1]):
                    rows[k, i] = sensed[0][part][i]
            else:
                rows[k] = sensed[0][part]

    return loop
