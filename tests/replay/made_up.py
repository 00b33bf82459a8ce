"""A made-up flight with everything in it, and a reader of recordings."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np

from edl6dof.replay.pages import TIMELINE
from edl6dof.scenario.loading import load_scenario
from edl6dof.telemetry.channels import CHANNELS

MORTAR, FAILURE, DIAGNOSIS, SHIELD, SHELL, END = 6.0, 8.0, 9.0, 10.0, 14.0, 20.0
FOUND = {"thruster": "D7", "isolated": "D7 stuck off"}
#: A branch of the mission for a failure that the flight does not have.
NOT_ENTERED = ("alpha_held", "coast", "last_burn")
RELEASES = {"canopy": (MORTAR, SHELL), "heat_shield": (SHIELD, END), "backshell": (SHELL, END)}


#: What a flight on instruments is flown with.
INSTRUMENTS = (
    "sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches]",
    "flight_software.navigation.filter=error_state",
)
#: From when to when all gyros are saturated, when the third is excluded, from when on the beams have an echo,
#: and when the filter refuses the second and the fourth is excluded.
SATURATED, GYRO_EXCLUDED, LOCK, REFUSED, BEAM_EXCLUDED = (6.1, 7.1), 9.5, 11.0, 13.0, 15.0


def flight_on_instruments() -> SimpleNamespace:
    """The made-up flight with an inertial unit of six gyros and accelerometers, and a radar of four beams,
    down to the last second.
    """
    flight = synthetic_flight(INSTRUMENTS)
    tm, t = flight.telemetry, flight.telemetry["t_s"]
    tm["sensed.gyros_saturated"] = np.where((t >= SATURATED[0]) & (t < SATURATED[1]), 0b111111, 0)
    tm["sensed.accelerometers_saturated"] = np.zeros(len(t))
    tm["nav.gyros_in_use"] = np.where(t < GYRO_EXCLUDED, 0b11111111, 0b11111011)
    tm["nav.accelerometers_in_use"] = np.full(len(t), 0b11111111)
    tm["nav.beams_in_use"] = np.where(t < BEAM_EXCLUDED, 0b11111111, 0b11110111)
    tm["nav.beams_used"] = np.where(t < LOCK, 0, np.where(t < REFUSED, 0b1111, 0b1101))
    tm["nav.beams_used"] = np.where(t < BEAM_EXCLUDED, tm["nav.beams_used"], 0b0101)
    excluded = {"t_s": GYRO_EXCLUDED, "key": "exclusion", "name": "gyro g3 excluded", "detail": ""}
    flight.events.insert(4, excluded)
    for k, beam in enumerate(flight.scenario.beam_names):
        tm[f"range.{beam}_m"] = np.where((t >= LOCK) & (t < 19.0), tm["truth.height_m"] + 10.0 * k, 0.0)
    return flight


def synthetic_flight(overrides: tuple[str, ...] = ("sensors.set=perfect",)) -> SimpleNamespace:
    """20 s of made-up telemetry over the Tianwen-1 site, with every separation in it."""
    scenario = load_scenario("tianwen1", overrides).scenario
    t = np.arange(0.0, END + 0.01, 0.02)
    rng = np.random.default_rng(3)
    tm = {"t_s": t}
    for k, channel in enumerate(CHANNELS):
        tm[channel.name] = np.sin(0.1 * (k + 1) * t) + 0.01 * k
    for axis, place in zip("xyz", (-1.5, 0.0, 0.0), strict=True):
        tm[f"truth.centre_{axis}_m"] = np.full_like(t, place)
    tm["truth.height_m"] = np.maximum(900.0 - 45.0 * t, 0.7)
    tm["truth.altitude_m"] = tm["truth.height_m"] - 4099.4
    tm["truth.site_east_m"], tm["truth.site_north_m"], tm["truth.site_up_m"] = (
        3.0 * t,
        200.0 - 10.0 * t,
        tm["truth.height_m"],
    )
    q = rng.normal(size=4) + 0.1 * np.outer(np.sin(t), rng.normal(size=4))
    for axis, column in zip("wxyz", (q / np.linalg.norm(q, axis=1, keepdims=True)).T, strict=True):
        tm[f"truth.q_I2B_{axis}"] = column
    for name, (start, stop) in RELEASES.items():
        on = (t >= start) & ((t < stop) | (stop == END))
        for axis, offset in zip(("east", "north", "up"), (5.0, 5.0, 30.0), strict=True):
            tm[f"truth.{name}_{axis}_m"] = np.where(on, tm[f"truth.site_{axis}_m"] + offset, np.nan)
    names = [phase.name for phase in scenario.mission.phases]
    flown = np.array([float(k) for k, name in enumerate(names) if name not in NOT_ENTERED])
    tm["guide.phase"] = flown[np.floor(t / END * (len(flown) - 0.01)).astype(int)]
    tm["truth.engine_thrust_n"] = np.where(t > SHELL, 3000.0, 0.0)
    tm["truth.footpads"] = np.where(t > 19.5, 4.0, 0.0)
    tm["truth.trim_wing"] = np.clip((t - 4.0) / 0.7, 0.0, 1.0)
    for k, jet in enumerate(scenario.vehicle.rcs.thrusters):
        tm[f"rcs.{jet.name}"] = np.clip(np.sin(t + k), 0.0, 1.0)
        tm[f"fault.{jet.name}"] = np.where((jet.name == "D7") & (t >= FAILURE), 1, 0)
    keys = {
        "mortar": MORTAR,
        "heat_shield": SHIELD,
        "landing_legs": 12.0,
        "backshell": SHELL,
        "trim_wing": 4.0,
        "end": END,
    }
    order = sorted(keys.items(), key=lambda item: item[1])
    events = [{"t_s": when, "key": key, "name": key, "detail": "detail"} for key, when in order]
    events.insert(
        2, {"t_s": DIAGNOSIS, "key": "diagnosis", "name": "diagnosed: D7 stuck off", "detail": "", **FOUND}
    )
    return SimpleNamespace(
        telemetry=tm,
        events=events,
        landing_map=None,
        phase_names=names,
        scenario=scenario,
        outcome="landed within limits",
        success=True,
        name="synthetic",
    )


def read(path: Path, entity: str) -> tuple[np.ndarray, dict[str, list]]:
    """Times (s) and component values of all rows of an entity that are not static."""
    from rerun.chunk import RrdReader

    rows: list[tuple[float, dict]] = []
    for chunk in RrdReader(path).stream().filter(content=[entity], is_static=False).to_chunks():
        batch = chunk.to_record_batch()
        times = (
            batch.column(TIMELINE).to_numpy(zero_copy_only=False).astype("timedelta64[ns]").astype(np.int64)
            / 1e9
        )
        columns = {n: batch.column(n).to_pylist() for n in batch.schema.names if ":" in n}
        rows += [(t, {n: values[i] for n, values in columns.items()}) for i, t in enumerate(times)]
    rows.sort(key=lambda row: row[0])
    names = sorted({n for _, row in rows for n in row})
    return np.array([t for t, _ in rows]), {n: [row.get(n) for _, row in rows] for n in names}


def entities(path: Path) -> set[str]:
    """Paths of all entities of a recording."""
    from rerun.chunk import RrdReader

    return {str(one.entity_path) for one in RrdReader(path).stream().collect().schema().component_columns()}
