"""A flight frozen at a moment: attitude, instruments, flight software and thrusters go on as they fly; the
flight path, the masses and the mission phase do not.

The attitude loop of such a flight does not depend on time.  It can be opened: the motion of the body is
imposed, and the demanded torque is read.  It can be closed with other thrust, or with valves that act later.
Position and velocity turn with the planet, so that air, heights and local frames stay the same; guidance is
held at the present bank angle and thrust, and diagnosis rests.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import cos, degrees, sin
from typing import Any

import numpy as np

from edl6dof.config.dtype import duplicate
from edl6dof.kernels import kernel
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.records import Records
from edl6dof.sensors.registry import sense
from edl6dof.sim.commands import Commander
from edl6dof.sim.flight_state import NO_TICKS, RunningFlight, Snapshot
from edl6dof.sim.linear import turned
from edl6dof.vehicle.actuate import actuate
from edl6dof.vehicle.motion.integrate import advance
from edl6dof.vehicle.motion.runge_kutta import evaluate, survey
from edl6dof.vehicle.plant import (
    ATTITUDE,
    CANOPY_POSITION,
    CANOPY_VELOCITY,
    POSITION,
    PROPELLANT,
    RATE,
    THRUST,
    VELOCITY,
)


@kernel
def command(functions, cases, onboards, tables_, plants, outputs_, works, sensors_, memories, k):
    """Run instruments, flight software and actuators of base cycle ``k``, as :func:`edl6dof.sim.loop.fly`."""
    run, software, measure, kinds = functions
    case, onboard, tables, plant = cases[0], onboards[0], tables_[0], plants[0]
    outputs, sensors, fsw = outputs_[0], sensors_[0], memories[0]
    evaluate(case, tables, plant, outputs, works[0])
    survey(case, tables, plant, outputs)
    sense(measure, case, tables, plant, outputs, sensors=sensors)
    run(software, onboard, sensors.sensed, k, fsw)
    actuate(kinds, case, fsw.command, plant)


@kernel
def coast(cases, tables_, plants, outputs_, works, t_end):
    """Advance the plant to ``t_end`` (s) with the present valves; return whether the step has succeeded."""
    return advance(cases[0], tables_[0], plants[0], outputs_[0], works[0], t_end=t_end)


class FrozenFlight:
    """A flight frozen at the start of a control cycle.

    Args:
        loaded, parts: scenario and records of the flight.
        start: the moment; the next control cycle counts.

    Attributes:
        flight: the flight, with records of its own.
        start: the moment.
        every: base cycles of a control cycle.
        control_s: control cycle, s.
        thrusters: number of thrusters.
    """

    def __init__(self, loaded: LoadedScenario, parts: Records, start: Snapshot):
        case, tables, onboard = parts
        own = Records(duplicate(case), tables, duplicate(onboard))
        self.flight = RunningFlight(loaded, parts=own, log=NO_TICKS)
        rates = loaded.scenario.flight_software.rates
        self.every, self._cycle_s = rates.control_every, 1.0 / rates.base_hz
        self.control_s, self.thrusters = self.every * self._cycle_s, len(loaded.scenario.thruster_names)
        self.flight.restore(start)
        self.flight.advance(-start.cycle % self.every)
        self.start = self.flight.snapshot()
        diagnosis = self.flight.onboard["diagnosis"][0]
        diagnosis["enabled"] = diagnosis["exercise"]["enabled"] = 0
        self._jets = self.flight.case["vehicle"]["rcs"]["thrusters"]
        self._thrust_factor = self._jets["thrust_factor"].copy()
        self._commander = Commander(self.flight.fsw, loaded.scenario.thruster_names)
        guide, bank = self.start.fsw["guide"][0], self.start.fsw["nav"]["bank"]
        guide["bank"] = bank[0]  # no error
        self._held: dict[str, Any] = {"bank_deg": degrees(float(bank[0]))}
        if self.start.fsw["vehicle"]["ignited"][0]:
            self._held["thrust_n"] = guide["thrust"] * guide["thrust_direction_N"]
        self.restart()

    def restart(self, replaced: Mapping[str, Any] | None = None, gain: float = 1.0) -> None:
        """Go back to the moment; ``replaced``: commands, as of ``Simulation.step``; ``gain``: factor on the
        thrust of all thrusters, which the flight software does not know.
        """
        self.flight.restore(self.start)
        self._jets["thrust_factor"] = gain * self._thrust_factor
        self._commander.take_up()
        self._commander.give({**self._held, **(replaced or {})})
        self._applied = self._valves()
        self._late: list[tuple[float, np.ndarray, np.ndarray]] = []

    def command(self) -> None:
        """Run instruments and flight software at the start of a base cycle, on the path of the moment."""
        f = self.flight
        self._stay((f.cycle - self.start.cycle) * self._cycle_s)
        state = f.plant, f.outputs, f.work, f.sensors, f.fsw
        command(f._functions, f.case, f.onboard, f.tables, *state, f.cycle)

    def _stay(self, elapsed: float) -> None:
        """Put path, masses and mission phase back to the moment ``elapsed`` s ago, turned with the planet."""
        y, y0 = self.flight.plant["y"][0], self.start.plant["y"][0]
        angle = float(self.flight.case["planet"]["rotation_rate"][0]) * elapsed
        turn = np.array([[cos(angle), -sin(angle), 0.0], [sin(angle), cos(angle), 0.0], [0.0, 0.0, 1.0]])
        for place in (POSITION, VELOCITY, CANOPY_POSITION, CANOPY_VELOCITY):
            y[place : place + 3] = turn @ y0[place : place + 3]
        y[PROPELLANT:THRUST] = y0[PROPELLANT:THRUST]
        fsw, fsw0 = self.flight.fsw[0], self.start.fsw[0]
        for name in ("r_I", "v_I"):
            fsw["navigation"]["solution"][name] = turn @ fsw0["navigation"]["solution"][name]
        fsw["mission"] = fsw0["mission"]
        fsw["mission"]["phase_start"] += elapsed

    def coast(self, delay_s: float = 0.0) -> None:
        """Fly the rest of the base cycle, with valves that act ``delay_s`` s after their command."""
        f, cycle_s = self.flight, self._cycle_s
        begin, steps = f.cycle * cycle_s, f.loaded.scenario.steps_per_cycle
        ends = [begin + cycle_s * (j + 1) / steps for j in range(steps)]
        if delay_s > 0.0:
            if f.cycle % self.every == 0:
                opens, closes = self._valves()
                self._late.append((begin + delay_s, opens + delay_s, closes + delay_s))
            self._open(begin)
            ends = sorted({*ends, *(t for t, *_ in self._late if begin < t < ends[-1] - 1e-9)})
        for end in ends:
            coast(f.case, f.tables, f.plant, f.outputs, f.work, end)
            if delay_s > 0.0:
                self._open(end)
        f.cycle += 1

    def _valves(self) -> tuple[np.ndarray, np.ndarray]:
        valves = self.flight.plant["valves"][0]
        return valves["open_time"].copy(), valves["close_time"].copy()

    def _open(self, t: float) -> None:
        """Let the last late command that has come by ``t`` (s) act."""
        while self._late and self._late[0][0] <= t + 1e-9:
            self._applied = self._late.pop(0)[1:]
        valves = self.flight.plant["valves"][0]
        valves["open_time"], valves["close_time"] = self._applied

    def impose(self, turn: np.ndarray, rate: np.ndarray) -> None:
        """Set the attitude of the moment turned by ``turn`` (rad) and its rate plus ``rate`` (rad/s), B."""
        y, y0 = self.flight.plant["y"][0], self.start.plant["y"][0]
        q = y0[ATTITUDE : ATTITUDE + 4]
        for axis in np.flatnonzero(turn):
            q = turned(q, int(axis), float(turn[axis]))
        y[ATTITUDE : ATTITUDE + 4], y[RATE : RATE + 3] = q, y0[RATE : RATE + 3] + rate

    def pretend(self, firing: np.ndarray) -> None:
        """Tell the flight software, after a command, that thrusters are open for the whole control cycle."""
        fsw, begin = self.flight.fsw[0], self.flight.cycle * self._cycle_s
        fsw["modulation"]["duty"][: self.thrusters][firing] = 1.0
        last = {name: fsw["estimation"]["activity"][name][0] for name in ("open_time", "close_time")}
        for record in (fsw["modulation"], last):
            record["open_time"][: self.thrusters][firing] = begin
            record["close_time"][: self.thrusters][firing] = begin + self.control_s

    def believe(self, q_I2B: np.ndarray, w_B: np.ndarray) -> np.ndarray:
        """Run the flight software of a control cycle with an estimate of attitude and rate (rad/s) in the
        place of its own, and go on to the next control cycle without flying; return the times (s) for which
        it opens the thrusters.
        """
        f, known = self.flight, self.start.fsw["navigation"]["estimate"]
        external = f.fsw["external"][0]
        external["given"]["estimate"] = 1
        for name in ("r_I", "v_I", "height_above_ground"):
            external[name] = known[name][0]
        external["q_I2B"], external["w_B"] = q_I2B, w_B
        self.command()
        f.cycle += self.every
        f.plant["t"] = f.cycle * self._cycle_s
        valves = f.fsw["modulation"][0]
        return (valves["close_time"] - valves["open_time"])[: self.thrusters]

    def flown(self, seconds: float, delay_s: float = 0.0) -> Iterator[None]:
        """Fly the closed loop, a control cycle at a time."""
        for _ in range(round(seconds / self.control_s)):
            for _ in range(self.every):
                self.command()
                self.coast(delay_s)
            yield
