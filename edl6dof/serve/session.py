"""Requests of a client to its flight, and the answers.

Each field of a request is checked before the flight is stepped; an answer names the mistake and a correction.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import edl6dof
from edl6dof.api.arguments import naming_arguments, texts
from edl6dof.api.simulation import Simulation, described
from edl6dof.config.errors import ConfigError
from edl6dof.config.wording import got, unknown

#: Version of the protocol; it increases if a program that was written for the last one would fail.
PROTOCOL = 2
#: Largest number of base cycles of a step, and largest seed.
MOST_CYCLES, LARGEST_SEED = 10_000_000, 2**31 - 1
#: Path and text of a change of the scenario: a text is a word, so that a client can name no file.
_PATH, _WORD = re.compile(r"[A-Za-z0-9_.]{1,200}"), re.compile(r"[A-Za-z0-9_]{1,64}")

Answer = dict[str, Any]


class Session:
    """One client's flight.

    Args:
        scenario: file, or name of a shipped one.
        sets: changes, as of ``--set``.

    Attributes:
        simulation: the flight.
        open: False once the client has closed the flight.

    Raises:
        ConfigError: the scenario is wrong.
    """

    def __init__(self, scenario: str, sets: Sequence[str] = ()):
        self._scenario, self._sets = scenario, tuple(sets)
        self._changes: tuple[str, ...] = ()
        self.simulation: Simulation = self._changed(())
        self.open = True

    def answer(self, request: Any) -> Answer:
        """Answer a request: ``ok`` is true if the request was done, otherwise ``error`` has the reason."""
        try:
            with naming_arguments():
                return {"ok": True, **self._done(request)}
        except ConfigError as error:
            return refused("; ".join(str(error).splitlines()))
        except (ValueError, TypeError, RecursionError) as error:
            return refused(str(error))

    def _done(self, request: Any) -> Answer:
        if not isinstance(request, dict) or not isinstance(name := request.pop("do", None), str):
            raise ValueError("a request is a map that says under 'do' what is to be done")
        if name not in _REQUESTS:
            raise ValueError(unknown("request", name, _REQUESTS))
        act, fields = _REQUESTS[name]
        for field in request:
            if field not in fields:
                raise ValueError(
                    unknown(f"field of {name}", field, fields) if fields else f"{name} has no fields"
                )
        return act(self, **request)

    def _reset(self, seed: Any = None, overrides: Any = None) -> Answer:
        """Restart the flight with these changes and no others; an error leaves the old flight as it is."""
        number = None if seed is None else _whole("seed", seed, LARGEST_SEED, 0)
        changes = () if overrides is None else _as_texts(overrides)
        simulation = self.simulation if changes == self._changes else self._changed(changes)
        seen = simulation.reset(number)
        self.simulation, self._changes = simulation, changes
        return {**self._standing(), "observation": seen}

    def _step(self, command: Any = None, cycles: Any = 1, observe: Any = None) -> Answer:
        if command is not None and not isinstance(command, dict):
            raise ValueError(f"command must be a map of commands by name (got {got(command)})")
        number = _whole("cycles", cycles, MOST_CYCLES)
        self._look(observe)
        self.simulation.step(command, number)
        return {**self._standing(), **self._look(observe)}

    def _observe(self, names: Any = True) -> Answer:
        return {**self._standing(), **self._look(names)}

    def _look(self, names: Any) -> Answer:
        """Observe what is requested: everything, the names in a list, or nothing."""
        if names is None or names is False:
            return {}
        if names is not True and not isinstance(names, list):
            raise ValueError(f"what is to be observed is true, or a list of names (got {got(names)})")
        return {"observation": self.simulation.observe(None if names is True else map(str, names))}

    def _restore(self, state: Any = None) -> Answer:
        if not isinstance(state, bytes):
            raise ValueError(f"state must be the bytes that the answer to state held (got {got(state)})")
        self.simulation.restore(edl6dof.State.unpacked(state, "state"))
        return self._standing()

    def _close(self) -> Answer:
        self.open = False
        return {}

    def _standing(self) -> Answer:
        """State of the flight, and the outcome once the flight has ended."""
        now = self.simulation
        found: Answer = {"flying": now.flying, "cycle": now.cycle, "time_s": now.time_s}
        return found if now.flying else {**found, "outcome": now.outcome}

    def _changed(self, changes: tuple[str, ...]) -> Simulation:
        return Simulation(self._scenario, (*self._sets, *changes), telemetry=False)


_REQUESTS: dict[str, tuple[Callable[..., Answer], tuple[str, ...]]] = {
    "describe": (lambda session: {"protocol": PROTOCOL, **described(session.simulation)}, ()),
    "reset": (Session._reset, ("seed", "overrides")),
    "step": (Session._step, ("command", "cycles", "observe")),
    "observe": (Session._observe, ("names",)),
    "own": (lambda session: {"own": session.simulation.own()}, ()),
    "truth": (lambda session: {"truth": session.simulation.truth()}, ()),
    "state": (lambda session: {"state": session.simulation.state().packed()}, ()),
    "restore": (Session._restore, ("state",)),
    "close": (Session._close, ()),
}


def refused(reason: str) -> Answer:
    """Answer that a request is refused: one line of at most 500 characters."""
    line = " ".join(reason.split())[:500]
    return {"ok": False, "error": "".join(ch if ch.isprintable() else "?" for ch in line)}


def _whole(name: str, value: Any, most: int, least: int = 1) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
        raise ValueError(f"{name} must be a whole number from {least} to {most} (got {got(value)})")
    return value


def _as_texts(overrides: Any) -> tuple[str, ...]:
    """Return changes of the scenario as texts ``path=value``."""
    if not isinstance(overrides, dict):
        raise ValueError(f"overrides must be a map of values by dotted path (got {got(overrides)})")
    for path, value in overrides.items():
        if not isinstance(path, str) or not _PATH.fullmatch(path):
            raise ValueError(f"overrides: {path!r} is no dotted path of letters, digits and _")
        for one in value if isinstance(value, list) else (value,):
            if isinstance(one, str) and not _WORD.fullmatch(one):
                raise ValueError(f"overrides: {path} may be set to a word, not to {got(one)}")
            if not isinstance(one, str | int | float | None):
                raise ValueError(
                    f"overrides: {path} may be set to a number, true or false, a word, or a list"
                )
    return texts(overrides)
