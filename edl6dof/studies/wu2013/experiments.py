"""What is flown: the paper as printed, what may stand behind its figures, and this software's settings.

Table 1 gives means and 3-sigma errors; those of ballistic coefficient and reference density are put on mass
and density.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from edl6dof.campaign.design.case import Case
from edl6dof.studies.cases import Spread, draw

SEED = 2013
MASS, DENSITY = "vehicle.mass.entry_kg", "atmosphere.density_factor"
SPREADS = (
    Spread("initial.altitude_m", 60000.0, 1000.0),
    Spread("initial.speed_m_s", 5700.0, 20.0),
    Spread("initial.flight_path_angle_deg", -14.0, 0.1),
    Spread("initial.longitude_deg", 0.0, 0.05),
    Spread("initial.latitude_deg", 0.0, 0.05),
    Spread("initial.azimuth_deg", 0.0, 0.1),
    Spread("vehicle.aero.lift_drag.lift_to_drag", 0.24, 0.024),
    Spread(MASS, 2804.0, 280.4),
    Spread(DENSITY, 1.0, 0.15),
)
ENTRY = "flight_software.guidance.entry"
LAWS = {"ehgo_fl": "EHGO+FL", "fl": "FL"}
#: The paper stops its range update nowhere, and prints no limit of the bank angle: flown on to 100 m/s before
#: the terminal speed, and to 15 deg of lift down.
AS_PRINTED = (f"{ENTRY}.tracking.update_stop_m_s=600", f"{ENTRY}.bank_max_deg=105")
#: A true value by dotted path.
Truth = dict[str, Any]

_ERROR = "sensors.navigation_error"
#: Standard deviations of a navigated state, and the noise of one reading (20 ug/sqrt(Hz) at 50 Hz): those of
#: the instruments of this software, estimates.
POSITION_M, VELOCITY_M_S, SCALE, NOISE_M_S2 = (300.0, 500.0, 300.0), (0.4, 0.4, 0.4), 5e-5, 1.4e-3


@dataclass(frozen=True)
class Experiment:
    """One way to fly the dispersed entries.

    Attributes:
        name: as it heads its findings.
        belief: what the flight computer is told otherwise than in the scenario.
        error: of navigation, from the truth of a flight and seven standard normals.
        laws: which fly it.
        share: of the runs of the study.
    """

    name: str
    belief: Mapping[str, Any] = field(default_factory=dict)
    error: Callable[[Truth, np.ndarray], Truth] | None = None
    laws: tuple[str, ...] = tuple(LAWS)
    share: float = 1.0


def _for_both(**values: Any) -> dict[str, Any]:
    return {f"{ENTRY}.{law}.{name}": value for law in LAWS for name, value in values.items()}


def _navigation(truth: Truth, normal: np.ndarray) -> Truth:
    """A navigated state that is off, and an accelerometer with noise."""
    return {
        f"{_ERROR}.position_m": [float(x) for x in normal[:3] * POSITION_M],
        f"{_ERROR}.velocity_m_s": [float(x) for x in normal[3:6] * VELOCITY_M_S],
        f"{_ERROR}.force_scale": SCALE * float(normal[6]),
        f"{_ERROR}.force_noise_m_s2": NOISE_M_S2,
    }


def _drag_of_the_model(truth: Truth, normal: np.ndarray) -> Truth:
    """Drag is not measured: that of the mean density and ballistic coefficient is taken for it."""
    return {f"{_ERROR}.force_scale": truth[MASS] / 2804.0 / truth[DENSITY] - 1.0}


_AS_IN_THE_PRINT = {
    **_for_both(settings="flown", error_gain=0.4, rate_gain=0.04),
    f"{ENTRY}.ehgo_fl.epsilon_s": 0.1,
    f"{ENTRY}.ehgo_fl.share": 100.0,
}
_FILTER = "flight_software.navigation.drag_filter.time_constant_s"
#: As in the paper: drag as measured, and guidance in every base cycle, for its observer is continuous.
CONTINUOUS = {_FILTER: 0.0, "flight_software.rates.entry_guidance_every": 1}
_KEPT = {f"{ENTRY}.tracking.update": False}
_WITH_ERRORS = {"sensors.carried": ["perfect", "imu", "navigation_error"]}

PRINTED = Experiment("as printed")
ORDER = Experiment("as printed, K on [error, rate] as it stands", _AS_IN_THE_PRINT, share=0.1)
KEPT = Experiment("without the range update", _KEPT)
MODEL_DRAG = Experiment(
    "without the range update, drag not measured but of the onboard model",
    {**_KEPT, **_WITH_ERRORS},
    _drag_of_the_model,
    ("fl",),
    share=0.1,
)
NAVIGATED = Experiment("as printed, with errors of navigation", _WITH_ERRORS, _navigation, share=0.1)
FLOWN = Experiment(
    "flown: this software's settings, with errors of navigation",
    {**_WITH_ERRORS, **_for_both(settings="flown"), _FILTER: 1.0},
    _navigation,
    share=0.1,
)
EXPERIMENTS = (PRINTED, ORDER, KEPT, MODEL_DRAG, NAVIGATED, FLOWN)
#: Fewest runs of an experiment that flies a share.
FEWEST = 20


def cases(runs: int) -> list[Case]:
    """The cases of all experiments, in their order and that of their laws; the entries of a share are the
    first of the whole.
    """
    truths = draw(SPREADS, runs, SEED)
    normal = np.random.default_rng(SEED + 1).standard_normal((runs, 7))
    found: list[Case] = []
    for experiment in EXPERIMENTS:
        for law in experiment.laws:
            for truth, row in zip(truths[: count(experiment, runs)], normal, strict=False):
                off = experiment.error(truth, row) if experiment.error else {}
                found.append(
                    Case(
                        len(found),
                        truth={**truth, **off},
                        belief={f"{ENTRY}.law": law, **CONTINUOUS, **experiment.belief},
                        label={"law": law, "experiment": experiment.name},
                    )
                )
    return found


def count(experiment: Experiment, runs: int) -> int:
    """How many entries an experiment flies under each of its laws."""
    return min(runs, max(FEWEST, round(experiment.share * runs)))
