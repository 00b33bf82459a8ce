"""A flight flown step by step, with commands from outside in the place of any part of the flight software.

A stepped flight has the same bits as a flight in one call: both run the same compiled loop, here for one or
several base cycles a call.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np

from edl6dof.config.errors import refusal
from edl6dof.config.wording import unknown
from edl6dof.interface.command import EXTERNAL
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.records import Records
from edl6dof.sim.attitude_loop import Margins, linearise
from edl6dof.sim.checkpoint import State
from edl6dof.sim.commands import Command, Commander, Reader, navigated, true_state, wanted
from edl6dof.sim.flight import Flight, flight_of
from edl6dof.sim.flight_state import NO_TICKS, RunningFlight, Snapshot
from edl6dof.sim.frozen import FrozenFlight
from edl6dof.sim.linear import LinearModel, linear_plant
from edl6dof.sim.outcome import FLYING, OUTCOMES


class SteppedFlight:
    """One flight, step by step.

    Args:
        loaded: the scenario, from :func:`edl6dof.load`.
        parts: its records, where the caller has built them already.
        telemetry: whether to keep telemetry, as :meth:`flight` needs it.
    """

    def __init__(self, loaded: LoadedScenario, parts: Records | None = None, telemetry: bool = True):
        self.loaded, self._telemetry = loaded, telemetry
        self._begin(loaded, parts)

    def _begin(self, loaded: LoadedScenario, parts: Records | None = None) -> None:
        """Go to the start of a flight of a scenario."""
        self.loaded = loaded
        self.running = RunningFlight(loaded, parts=parts, log=None if self._telemetry else NO_TICKS)
        self._names = loaded.scenario.thruster_names
        self._commander = Commander(self.running.fsw, self._names)
        for name in ("_navigated", "_wanted", "_true"):
            self.__dict__.pop(name, None)

    def step(self, command: Command | None = None, cycles: int = 1) -> bool:
        """Fly base cycles of the flight software under a command; return False at the end of the flight.

        Args:
            command: values by name, each of which replaces the value of the flight software for these cycles:
                ``bank_deg``, ``bank_rate_deg_s``, ``thrust_n`` (north, east, down), ``throttle`` (of full
                thrust), ``torque_nm`` (x, y, z of B), ``duties`` (0..1 of each thruster, or by name),
                ``isolate`` (names of thrusters not to use), ``safe_spot_m`` and ``coarse_spot_m``
                (north and east of the landing site), ``estimate`` (``r_I_m``, ``v_I_m_s``, ``q_I2B``,
                ``w_B_rad_s``, ``height_m``).
            cycles: base cycles, of 1 / ``flight_software.rates.base_hz`` s each.

        Raises:
            ValueError: there is no such command, or its value is not of its kind or not finite; or no cycle
                is to be flown.
        """
        if cycles < 1:
            raise ValueError(f"cycles must be >= 1 (got {cycles})")
        if command is not None or self._commander.holds:
            self._commander.give(command)
        return self.running.advance(cycles) == FLYING

    def observe(self, names: Iterable[str] | None = None) -> dict[str, Any]:
        """Return the estimates of the flight computer after the last cycle, by name: navigation, guidance,
        phase. Before the first cycle they are zero. They contain nothing that the flight computer does not
        know.

        Args:
            names: names of the quantities, or one name; ``None``: all, which takes longer.

        Raises:
            ValueError: there is no quantity of such a name.
        """
        readers = self._navigated
        names = [names] if isinstance(names, str) else names
        if names is None:
            return {name: read() for name, read in readers.items()}
        try:
            return {name: readers[name]() for name in names}
        except KeyError as error:
            raise ValueError(unknown("observation", error.args[0], readers)) from None

    def look_ahead(self) -> dict[str, Any]:
        """Return the estimates that the flight computer will have after the next base cycle, without flying
        this cycle; at the start of a flight, the first observation.
        """
        now = self.running.snapshot()
        self.running.advance(1)
        found = self.observe()
        self.running.restore(now)
        return found

    def own(self) -> dict[str, Any]:
        """Return the last demands that the flight software itself computed, by name, including those that
        commands replaced.
        """
        return {name: read() for name, read in self._wanted.items()}

    def truth(self) -> dict[str, Any]:
        """Return the true state by name, which no flight computer knows; meant for rewards and figures of
        merit.
        """
        self.running.look()
        return {name: read() for name, read in self._true.items()}

    def linear_plant(self) -> LinearModel:
        """Return the linear model of the plant at its present state; its inputs are torque and force of the
        thrusters.
        """
        return linear_plant(self.running)

    def attitude_margins(self) -> dict[str, Margins | None]:
        """Return the stability margins of the attitude loop at this moment, by axis of B; ``None`` for an
        axis whose law rests within a deadband.
        """
        running = self.running
        parts = Records(running.case, running.tables, running.onboard)
        loop = linearise(FrozenFlight(self.loaded, parts, running.snapshot()))
        return {axis: loop.margins(i) for i, axis in enumerate("xyz")}

    def state(self) -> State:
        """Return the state of the flight, without commands; :meth:`restore` and ``edl6dof fly --from`` read
        it.
        """
        found = self.running.state()
        found.fsw["external"] = np.zeros(1, EXTERNAL)
        return found

    def restore(self, state: State | Snapshot) -> None:
        """Restore a state of this scenario; telemetry starts again there.

        Raises:
            ConfigError: the state does not fit the scenario.
            TypeError: the argument is no state.
        """
        if not isinstance(state, State | Snapshot):
            raise TypeError(f"a state is what state() returned, or State.load (got {state!r})")
        if isinstance(state, State):
            state.check_fits(self.loaded.scenario)
            if state.scenario_text != self.running.scenario_text:
                words = "is of another scenario; fly it with edl6dof fly --from, or load its own"
                raise refusal("(saved state)", words)
        self.running.restore(state)
        self._commander.take_up()

    def flight(self) -> Flight:
        """Return the flight so far, as :func:`edl6dof.fly` returns it, with the telemetry since the last
        reset or restore. It shares its records with this flight: call the method again after the next step.

        Raises:
            ValueError: no telemetry is kept, or no cycle has been flown.
        """
        if not self._telemetry or self.running.rows == 0:
            raise ValueError("no telemetry is kept" if not self._telemetry else "no cycle has been flown yet")
        return flight_of(self.running)

    @property
    def time_s(self) -> float:
        """Flight time, s."""
        return self.running.time_s

    @property
    def cycle(self) -> int:
        """Base cycle that comes next."""
        return self.running.cycle

    @property
    def cycle_s(self) -> float:
        """Length of a base cycle, s."""
        return 1.0 / self.loaded.scenario.flight_software.rates.base_hz

    @property
    def flying(self) -> bool:
        """True while the flight has not ended."""
        return self.running.code == FLYING

    @property
    def outcome(self) -> str:
        """How the flight ended, without its limits; ``flying`` until then."""
        return OUTCOMES[self.running.code]

    @property
    def phase(self) -> str:
        """Name of the present mission phase."""
        return self.running.phase

    @property
    def commands(self) -> list[str]:
        """Names of the commands that :meth:`step` takes."""
        return self._commander.names

    @cached_property
    def _navigated(self) -> dict[str, Reader]:
        return navigated(self.running.fsw)

    @cached_property
    def _wanted(self) -> dict[str, Reader]:
        return wanted(self.running.fsw, len(self._names))

    @cached_property
    def _true(self) -> dict[str, Reader]:
        return true_state(self.running.plant, self.running.outputs)
