"""A mission of Tianwen-1's vehicle, and its sequencer over a history of navigated quantities."""

import numpy as np

from edl6dof.fsw.guidance.guidance_command import GUIDE
from edl6dof.fsw.mission import MISSION, SEQUENCE, MissionParams, Phase, Trigger, sequence
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.fsw.vehicle_state import VEHICLE_STATE
from edl6dof.interface.capacities import MAX_EVENTS
from edl6dof.scenario.loading import load_scenario
from edl6dof.scenario.mission_events import event_problems, fill_mission

DT = 0.02


def trigger(quantity, crosses, value, **window):
    return Trigger(quantity=quantity, crosses=crosses, value=float(value), **window)


VEHICLE = load_scenario("tianwen1").scenario.vehicle


def plan(*phases):
    """Record of a mission of Tianwen-1, and the mission."""
    mission, record = MissionParams(phases=list(phases)), np.zeros(1, MISSION)
    assert list(event_problems(mission, VEHICLE)) == []
    fill_mission(record[0], mission, VEHICLE)
    return record[0], mission


class Sequencer:
    """Runs the sequencer over a history of navigated quantities; keeps (time, event) and (time, phase)."""

    def __init__(self, plan, start=0.0):
        (self.mission, params), self.k, self.start = plan, 0, start
        self.names = list(params.events)
        self.nav, self.guide, self.fsw = np.zeros(1, NAV)[0], np.zeros(1, GUIDE)[0], np.zeros(1, SEQUENCE)[0]
        self.vehicle = np.zeros(1, VEHICLE_STATE)[0]
        self.fsw["phase_start"] = start
        self.events, self.entered = [], [(start, 0)]

    def run(self, duration, **quantities):
        for _ in range(round(duration / DT)):
            t = self.start + self.k * DT
            self.nav["t"] = t
            for name, value in quantities.items():
                self.set(name, value(t) if callable(value) else value)
            request, before = np.zeros(MAX_EVENTS, np.int64), int(self.fsw["phase"])
            sequence(self.mission, self.nav, self.vehicle, self.guide, self.fsw, request)
            self.events += [(t, self.names[i]) for i in np.flatnonzero(request)]
            if self.fsw["phase"] != before:
                self.entered.append((t, int(self.fsw["phase"])))
            self.k += 1
        return self

    def set(self, name, value):
        if name in ("time_to_go", "downrange_to_go", "spot_chosen"):
            self.guide[name] = value
        elif name == "descent_rate":
            self.nav["v_N"][2] = value
        else:
            self.nav[name] = value


def last(name="last"):
    return Phase(name=name)
