"""The same kernels as plain Python, in a process of their own with numba switched off.

The records are built by the compiled program and handed over byte for byte.  Plain Python reads them through
:class:`Record`: numpy's own ``recarray`` will not do, because ``rates.base`` is an attribute of every numpy
scalar.  Scalars are numpy's, so divisions follow the same rules as in compiled code; squares are products
(:mod:`squares`).  About a thousand times
slower.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import squares

if __name__ == "__main__":
    squares.multiply("edl6dof")

from edl6dof.fsw.onboard import FSW, ONBOARD
from edl6dof.kernels.cache import SETTINGS
from edl6dof.scenario import records
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.truth import CASE
from edl6dof.sensors.registry import SENSORS
from edl6dof.sim.checkpoint import State
from edl6dof.telemetry.channels import BRIEF, TICK
from edl6dof.vehicle.plant import OUTPUTS, PEAKS, STATE, STATES, STATES_VEHICLE, WORKSPACE

#: The records of a flight, in the order of the loop's arguments.
LAYOUT = {
    "case": CASE, "onboard": ONBOARD, "tables": records.TABLES,
    "plant": STATE, "outputs": OUTPUTS, "peaks": PEAKS, "work": WORKSPACE, "sensors": SENSORS, "fsw": FSW,
}  # fmt: skip


class Record:
    """Fields of a structured numpy scalar as attributes, as compiled code sees them."""

    __slots__ = ("_void",)

    def __init__(self, void: np.void) -> None:
        object.__setattr__(self, "_void", void)

    def __getattr__(self, name: str) -> Any:
        value = self._void[name]
        if isinstance(value, np.void):
            return Record(value)
        return Records(value) if isinstance(value, np.ndarray) and value.dtype.names else value

    __getitem__ = __getattr__

    def __setattr__(self, name: str, value: Any) -> None:
        self._void[name] = value


class Records:
    """A structured array whose items are :class:`Record`."""

    def __init__(self, array: np.ndarray) -> None:
        self.array, self.shape = array, array.shape

    def __getitem__(self, index: int) -> Record:
        return Record(self.array[index])

    def __len__(self) -> int:
        return len(self.array)

    def view(self, kind: type) -> np.ndarray:
        """The same memory as plain numbers."""
        return self.array.view(kind)


@dataclass(frozen=True)
class Setting:
    """All records of a flight (keys of ``LAYOUT``) at the start of a base cycle, and its steps per cycle."""

    arrays: dict[str, np.ndarray]
    cycle: int
    steps: int


def setting(loaded: LoadedScenario, state: State) -> Setting:
    """Records of ``loaded`` with copies of the state."""
    tables = records.build_tables(loaded.truth)
    fixed = {
        "case": records.build_case(loaded.truth, tables),
        "onboard": records.build_onboard(loaded.scenario),
    }
    moving = {name: getattr(state, name).copy() for name in ("plant", "peaks", "sensors", "fsw")}
    moving |= {"outputs": np.zeros(1, OUTPUTS), "work": np.zeros(1, WORKSPACE)}
    return Setting({**fixed, "tables": tables, **moving}, state.cycle, loaded.scenario.steps_per_cycle)


def fly_cycles(s: Setting, cycles: int) -> dict[str, np.ndarray]:
    """Fly base cycles from a setting, compiled or plain as the process is; returns the changed records and
    the log.
    """
    from edl6dof.sim.functions import functions_of
    from edl6dof.sim.loop import fly

    log = np.zeros(cycles + 2, TICK)
    functions = functions_of(s.arrays["case"], s.arrays["onboard"][0])
    arrays: list[Any] = [s.arrays[name] for name in LAYOUT]
    logs: list[Any] = [log, np.zeros(0, BRIEF)]
    if SETTINGS.DISABLE_JIT:
        arrays, logs = [Records(array) for array in arrays], [Records(array) for array in logs]
    _, _, rows = fly(functions, *arrays, s.cycle, s.cycle + cycles, 0, s.steps, *logs, 0)
    return {
        **{name: s.arrays[name] for name in ("plant", "outputs", "peaks", "sensors", "fsw")},
        "log": log[:rows],
    }


def integrate(s: Setting, seconds: float, tolerance: float) -> dict[str, np.ndarray]:
    """Integrate the right-hand side, with commands as they are, by scipy's DOP853; returns the end state and
    the evaluations.
    """
    from scipy.integrate import solve_ivp

    from edl6dof.vehicle.motion.runge_kutta import evaluate_at
    from edl6dof.vehicle.plant import POSITION
    from edl6dof.vehicle.surroundings import noncentral_I, planet_rotation

    case, tables, plant, outputs, work = (
        s.arrays[name][0] for name in ("case", "tables", "plant", "outputs", "work")
    )
    full, slopes, start = plant["y"], work["k"][0], float(plant["t"])
    count = STATES if plant["canopy"] in (1, 2) else STATES_VEHICLE
    given = [case, tables, plant, outputs, work, case["planet"]]
    *seen, planet = map(Record, given) if SETTINGS.DISABLE_JIT else given

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        full[:count], plant["t"] = y, t
        rotation = planet_rotation(planet, t)
        # held over a step by the simulator's own method, and not part of the right-hand side
        plant["inputs"]["noncentral_I"] = noncentral_I(planet, rotation, tuple(full[POSITION : POSITION + 3]))
        evaluate_at(*seen, rotation)  # as flights call it: compiled for them already
        return slopes[:count].copy()

    begin = full[:count].copy()
    scale = tolerance * np.maximum(np.abs(begin), 1.0)
    found = solve_ivp(rates, (start, start + seconds), begin, "DOP853", rtol=tolerance, atol=scale)
    return {"y": found.y[:, -1], "evaluations": np.array(found.nfev)}


def in_plain_python(s: Setting, task: str, *numbers: float) -> dict[str, np.ndarray]:
    """Run ``fly_cycles`` or ``integrate`` in a process with numba off.

    Raises:
        subprocess.CalledProcessError: the kernels do not run as plain Python; its ``stderr`` says why.
    """
    with tempfile.TemporaryDirectory() as folder:
        given, answer = Path(folder) / "given.npz", Path(folder) / "answer.npz"
        raw: dict[str, Any] = {
            name: np.frombuffer(array.tobytes(), np.uint8) for name, array in s.arrays.items()
        }
        np.savez(given, cycle=s.cycle, steps=s.steps, task=task, numbers=np.array(numbers), **raw)
        command = [sys.executable, __file__, str(given), str(answer)]
        subprocess.run(
            command, env={**os.environ, "NUMBA_DISABLE_JIT": "1"}, check=True, capture_output=True, text=True
        )
        layout = {**LAYOUT, "log": TICK}
        with np.load(answer) as file:
            return {
                name: np.frombuffer(file[name].tobytes(), layout[name]) if name in layout else file[name]
                for name in file.files
            }


def differing(a: np.ndarray, b: np.ndarray, prefix: str = "") -> list[str]:
    """Names of the fields of two structured arrays whose bits differ; padding does not count."""
    names: list[str] = []
    for name in a.dtype.names or ():
        if a[name].dtype.names:
            names += differing(a[name], b[name], f"{prefix}{name}.")
        elif a[name].tobytes() != b[name].tobytes():
            names.append(prefix + name)
    return names


def main(given: str, answer: str) -> None:
    """Read a setting, do the task, write what came of it as raw bytes or arrays."""
    if not SETTINGS.DISABLE_JIT:
        raise RuntimeError("numba is not switched off: set NUMBA_DISABLE_JIT=1")
    with np.load(given) as file:
        arrays = {name: np.frombuffer(file[name].tobytes(), dtype).copy() for name, dtype in LAYOUT.items()}
        s, task, numbers = (
            Setting(arrays, int(file["cycle"]), int(file["steps"])),
            str(file["task"]),
            file["numbers"],
        )
    with np.errstate(all="ignore"):
        result = (
            fly_cycles(s, int(numbers[0]))
            if task == "fly_cycles"
            else integrate(s, *(float(x) for x in numbers))
        )
    raw: dict[str, Any] = {
        name: np.frombuffer(a.tobytes(), np.uint8) if a.dtype.names else a for name, a in result.items()
    }
    np.savez(answer, **raw)


if __name__ == "__main__":
    main(*sys.argv[1:])
