"""Margins and limit cycles of the attitude loops of a scenario, for every phase and axis, at some moments of
its own flight or of the flights of dispersed vehicles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from math import degrees, inf, isnan, nan

from edl6dof.campaign.design.case import Variant, Variants
from edl6dof.campaign.design.plan import Plan
from edl6dof.config.errors import refusal
from edl6dof.config.wording import unknown
from edl6dof.scenario.loaded import LoadedScenario
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.attitude_loop import linearise
from edl6dof.sim.flight_state import NO_TICKS, RunningFlight, Snapshot
from edl6dof.sim.frozen import FrozenFlight
from edl6dof.sim.measured_loop import limit_cycles, measured
from edl6dof.sim.outcome import FLYING

#: Names of the axes x, y, z of B.
AXES = ("roll", "pitch", "yaw")
#: Time between two looks at the phase of a flight, s.
_LOOK_S = 0.2

#: Called with the number of moments analysed, and with their number.
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class AxisMargins:
    """Smallest margins of an axis in a phase, over all moments and vehicles: a row of the results.

    Attributes:
        phase, axis: name of the phase; roll, pitch or yaw.
        gain_db, gain_down_db, phase_deg, delay_s, disk: as in
            :class:`edl6dof.sim.attitude_loop.Margins`; infinite without a limit, NaN for an axis that rests.
        crossover_rad_s: largest frequency of unit gain.
        added_rate_deg_s: largest additional rate at which the law was linearised, beyond its deadband.
        at_s: time of the smallest phase margin.
        vehicle: case of the campaign with that margin; ``None``: the scenario itself.
        predicted_deg, predicted_s, flown_deg, flown_s: amplitude and period of the limit cycle of an axis
            that rests; NaN without one.
        measured_gain_db, measured_delay_s: largest gain and delay of all axes at once at which a push decays.
        linear_gain_db, linear_delay_s: those of the linear loop.
    """

    phase: str
    axis: str
    gain_db: float = inf
    gain_down_db: float = inf
    phase_deg: float = inf
    delay_s: float = inf
    disk: float = inf
    crossover_rad_s: float = nan
    added_rate_deg_s: float = nan
    at_s: float = nan
    vehicle: int | None = None
    predicted_deg: float = nan
    predicted_s: float = nan
    flown_deg: float = nan
    flown_s: float = nan
    measured_gain_db: float = nan
    measured_delay_s: float = nan
    linear_gain_db: float = nan
    linear_delay_s: float = nan

    @property
    def rests(self) -> bool:
        """True if the law answers to no small change of attitude or rate."""
        return isnan(self.added_rate_deg_s)


_SMALLEST = (
    "gain_db",
    "gain_down_db",
    "phase_deg",
    "delay_s",
    "disk",
    "measured_gain_db",
    "measured_delay_s",
)


@dataclass(frozen=True)
class Request:
    """Scope of an analysis.

    Attributes:
        phases: names of the phases; all that have attitude control if empty.
        moments: number of moments of each phase.
        vehicles: number of dispersed vehicles of a campaign; 0: the scenario itself, with limit cycles.
        measure: True to measure margins as well, in the middle of each phase.
    """

    phases: Sequence[str] = ()
    moments: int = 3
    vehicles: int = 0
    measure: bool = False


def analyse(
    loaded: LoadedScenario, request: Request, plan: Plan | None = None, progress: Progress | None = None
) -> list[AxisMargins]:
    """Compute the margins of a scenario, or of the vehicles of a campaign's ``plan``.

    Raises:
        ConfigError: the scenario has no attitude control or no such phase.
    """
    chosen, variants = _phases(loaded.scenario, request.phases), Variants(loaded)
    vehicles: list[tuple[int | None, Variant]] = [(None, variants.nominal)]
    if plan is not None:
        cases = plan.cases(0, min(request.vehicles, plan.count))
        vehicles = [(case.index, variants.build(case)) for case in cases]
    found: dict[tuple[str, str], AxisMargins] = {}
    done, total = 0, len(vehicles) * len(chosen) * request.moments
    for vehicle, variant in vehicles:
        for phase, snapshots in _moments(variant, chosen, request.moments).items():
            for number, snapshot in enumerate(snapshots):
                cycles = vehicle is None and number == 0
                measure = request.measure and number == len(snapshots) // 2
                frozen = FrozenFlight(variant.loaded, variant.parts, snapshot)
                for row in _rows(frozen, phase, cycles, measure):
                    key = row.phase, row.axis
                    row = replace(row, vehicle=vehicle)
                    found[key] = _worse(found[key], row) if key in found else row
                done += 1
                if progress is not None:
                    progress(done, total)
    return list(found.values())


def _phases(scenario: Scenario, names: Sequence[str]) -> list[str]:
    """Phases with attitude control, or those with these names."""
    controlled = [phase.name for phase in scenario.mission.phases if phase.control != "off"]
    if scenario.dynamics != "six_dof" or not controlled or not scenario.thruster_names:
        raise refusal(scenario.name, "has no phase in which thrusters control the attitude")
    for name in names:
        if name not in controlled:
            raise refusal("--phases", unknown("phase with attitude control", name, controlled))
    return [name for name in controlled if not names or name in names]


def _moments(variant: Variant, phases: Sequence[str], count: int) -> dict[str, list[Snapshot]]:
    """Snapshots in the middle of ``count`` equal parts of each phase that the flight reaches."""
    times: dict[str, list[int]] = {}
    flight = RunningFlight(variant.loaded, parts=variant.parts, log=NO_TICKS)
    look = max(round(_LOOK_S * variant.loaded.scenario.flight_software.rates.base_hz), 1)
    while flight.advance(look) == FLYING:
        times.setdefault(flight.phase, []).append(flight.cycle)
    found: dict[str, list[Snapshot]] = {phase: [] for phase in phases if phase in times}
    parts = [(2 * k + 1) / (2 * count) for k in range(count)]
    chosen = sorted((times[phase][int(part * len(times[phase]))], phase) for phase in found for part in parts)
    flight = RunningFlight(variant.loaded, parts=variant.parts, log=NO_TICKS)
    for cycle, phase in chosen:
        flight.advance(cycle - flight.cycle)
        found[phase].append(flight.snapshot())
    return found


def _rows(frozen: FrozenFlight, phase: str, cycles: bool, measure: bool) -> Iterator[AxisMargins]:
    """Yield the margins of each axis at a moment, and its limit cycle with ``cycles``."""
    loop = linearise(frozen)
    every = [loop.margins(i) for i in range(3)]
    by_push = measured(frozen, loop) if measure else None
    for i, (axis, one) in enumerate(zip(AXES, every, strict=True)):
        row = AxisMargins(phase, axis, at_s=float(frozen.start.plant["t"][0]))
        if by_push is not None:
            row = replace(row, measured_gain_db=by_push.gain_db, measured_delay_s=by_push.delay_s)
            row = replace(row, linear_gain_db=by_push.linear_gain_db, linear_delay_s=by_push.linear_delay_s)
        if one is not None:
            shown = {name: value for name, value in one._asdict().items() if name != "turnover_rad_s"}
            row = replace(row, **shown, added_rate_deg_s=degrees(loop.added_rate_rad_s[i]))
        elif cycles and loop.largest_nm[i] > 0.0:
            predicted, flown = limit_cycles(frozen, i)
            row = replace(row, predicted_deg=predicted.amplitude_deg, predicted_s=predicted.period_s)
            row = replace(row, flown_deg=flown.amplitude_deg, flown_s=flown.period_s)
        yield row


def _worse(one: AxisMargins, two: AxisMargins) -> AxisMargins:
    """Combine rows of an axis at two moments: the smaller of each margin, the other where one has none."""
    first = two if two.phase_deg < one.phase_deg else one
    values = {}
    for name in (field.name for field in fields(AxisMargins)):
        if name in ("phase", "axis", "at_s", "vehicle"):
            values[name] = getattr(first, name)
            continue
        present = [value for value in (getattr(one, name), getattr(two, name)) if not isnan(value)]
        values[name] = (min if name in _SMALLEST else max)(present, default=nan)
    return AxisMargins(**values)
