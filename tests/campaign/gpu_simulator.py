"""A few flights of Tianwen-1 on numba's simulator of a GPU (NUMBA_ENABLE_CUDASIM=1), which calls the
processor's machine code; prints the rows and the flights of each batch.
"""

import json

import numpy as np

import edl6dof
from edl6dof.campaign.design.case import Case
from edl6dof.campaign.executor import CaseRunner
from edl6dof.telemetry.channels import BRIEF

CASES = [
    Case(0, truth={"vehicle.mass.entry_kg": 1290.0}),
    Case(1, truth={"vehicle.mass.entry_kg": 10.0}),
    Case(2, belief={"vehicle.mass.entry_kg": 1290.0}),
    Case(3, truth={"vehicle.parachutes.main.drag_factor": 0.05}),
    Case(4, truth={"initial.flight_path_angle_deg": -9.0}),
]
#: Of the GPU: this holds the tables and three flights.
MEMORY = 27_000_000


class Memory:
    """Memory of the GPU as the processor's machine code takes it: plain arrays."""

    def __init__(self, array: np.ndarray) -> None:
        self._array, self.shape = array, array.shape

    def __len__(self) -> int:
        return len(self._array)

    def __getitem__(self, index):
        return self._array[index]

    def __setitem__(self, index, value) -> None:
        self._array[index] = value


class Bare:
    """Makes that of each argument of the entry, as numba lets an extension do."""

    def prepare_args(self, kind, value, **_):
        return kind, Memory(value._ary) if hasattr(value, "_ary") else value


def main() -> None:
    from edl6dof.campaign.gpu import batch, layouts
    from edl6dof.campaign.gpu import engine as module
    from edl6dof.campaign.gpu.crew import Alone
    from edl6dof.campaign.gpu.entry import fly_flights

    fly_flights.extensions.append(Bare())
    # with images and maps: machine code for records without them would have to be compiled
    layouts.LEAN = layouts.LEAN._replace(own=layouts.WHOLE_LOG.own)
    batch.THREADS = (
        2  # of a block: the simulator starts them all, and asks all the time whether one still runs
    )
    batches = []

    class Watched(module.Batch):
        def __init__(self, starts, nominal):
            batches.append((len(starts), starts[0].layout.thinned))
            super().__init__(starts, nominal)

        def fly(self, kernel):
            for left in super().fly(kernel):
                longest.append(0 if left is None else len(left.log) // BRIEF.itemsize)
                yield left

    module.Batch, longest = Watched, []
    crew = Alone(CaseRunner(edl6dof.load("tianwen1")))
    gpu = module.Gpu("simulator", fly_flights, MEMORY)
    rows = list(gpu.fly(crew, CASES))
    found = {"rows": rows, "batches": list(batches), "telemetry": list(longest)}
    batches.clear()
    layouts.TELLING_ROWS = -1500  # too little room for the end of the trim phase
    found |= {"crowded": list(gpu.fly(crew, CASES[:1])), "then": batches}
    print(json.dumps(found))


if __name__ == "__main__":
    main()
