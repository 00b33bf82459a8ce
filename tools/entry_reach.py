"""Print which dispersed entries any law could bring to the aim point, and the share of these that laws do:

    python tools/entry_reach.py tianwen1 [--entries 100] [--seed 4402] [--wind 40] [--laws fnpeg etpc]

The first law's flight of an entry gives its true air, wind, drag, lift and state as lift control starts;
:mod:`entry_optimum` finds the nearest and the highest end in them.  With ``--wind`` (m/s) an
unexpected constant wind blows, entry after entry, from eight directions.  An entry counts as reachable if the
nearest end of the best lift is within the distance of the target: 2.5 km, with wind 3 km.
"""

from __future__ import annotations

import argparse

import numpy as np
from entry_laws import bounded
from entry_optimum import Entry, best, from_aim

from edl6dof import Case, fly_rows
from edl6dof.campaign.executor import Row
from edl6dof.campaign.statistics import Proportion
from edl6dof.fsw.guidance.entry.airframe import mach_nodes
from edl6dof.fsw.guidance.entry.predictor import acceleration, fixed_state, velocity_in_air
from edl6dof.fsw.navigation.derived import NAV
from edl6dof.interface.roles import LIFT
from edl6dof.scenario.records import build_onboard
from edl6dof.sim.flight import Flight
from edl6dof.spatial import arrays
from edl6dof.studies.guidance import DISPERSED, VEHICLES, Vehicle, entries, misses, wind, with_law
from edl6dof.studies.samples import column, percentage

#: Largest miss of a reached entry, km: without and with an unexpected wind.
CALM_KM, WINDY_KM = 2.5, 3.0
DIRECTIONS = 8


def states(flight: Flight, planet: np.void, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """True positions (m) and planet-relative velocities (m/s) in F, shapes (n, 3)."""
    truth = flight.telemetry
    lat, lon, path, course = (
        np.radians(truth[f"truth.{name}_deg"][rows])
        for name in ("latitude", "longitude", "flight_path_angle", "azimuth")
    )
    speed, height = truth["truth.speed_m_s"][rows], truth["truth.altitude_m"][rows]
    navs = np.zeros(len(speed), NAV)
    navs["latitude"], navs["longitude"], navs["altitude"] = lat, lon, height
    level = speed * np.cos(path)
    navs["v_N"] = np.transpose([level * np.cos(course), level * np.sin(course), -speed * np.sin(path)])
    pairs = [fixed_state(planet, nav) for nav in navs]
    return np.array([r for r, _ in pairs]), np.array([v for _, v in pairs])


def node_means(at: np.ndarray, values: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Means of the values nearest to each of the evenly spaced ``nodes``, linear between those that have
    values, constant beyond.
    """
    index = np.clip(np.rint((at - nodes[0]) / (nodes[1] - nodes[0])).astype(int), 0, len(nodes) - 1)
    count, total = np.bincount(index, minlength=len(nodes)), np.bincount(index, values, len(nodes))
    full = count > 0
    return np.interp(nodes, nodes[full], total[full] / count[full])


def true_model(flight: Flight) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Belief with the true air, wind and airframe of a flight, and its rows in lift control: positions and
    velocities (F, shapes (n, 3)) and bank angles (rad).
    """
    onboard = build_onboard(flight.scenario)
    record, truth = onboard[0], flight.telemetry
    rows = flight.during(LIFT) & (truth["t_s"] <= flight.figures["parachute_s"])
    r, v = states(flight, record["planet"], rows)
    t, height, density, east, north = (
        truth[name][rows]
        for name in (
            *("t_s", "truth.altitude_m", "truth.density_kg_m3"),
            *("truth.wind_east_m_s", "truth.wind_north_m_s"),
        )
    )
    air = record["atmosphere"]
    nodes = air["bottom"] + air["spacing"] * np.arange(len(air["ln_density"]))
    believed = np.interp(height, nodes, air["ln_density"])
    air["ln_density"] += node_means(height, arrays.log(density) - believed, nodes)
    air["wind_north"], air["wind_east"] = node_means(height, north, nodes), node_means(height, east, nodes)

    vehicle = record["vehicle"]
    moved = np.array(
        [
            acceleration(record, (0.0, 0.0, 0.0, 0.0), tuple(a), tuple(b), (1.0, 0.0))[0]
            for a, b in zip(r, v, strict=True)
        ]
    )
    force = np.gradient(v, t, axis=0) - moved
    through = np.array(
        [
            velocity_in_air(air, tuple(a), tuple(b), h, (0.0, 0.0))
            for a, b, h in zip(r, v, height, strict=True)
        ]
    )
    through /= np.linalg.norm(through, axis=1)[:, None]
    drag = -np.sum(force * through, axis=1)
    lift = np.linalg.norm(force + drag[:, None] * through, axis=1)
    pressure = 0.5 * density * np.square(truth["truth.airspeed_m_s"][rows])
    area = drag * vehicle["entry_mass"] / pressure / vehicle["drag_area"]
    mach = np.linalg.norm(v, axis=1) / np.interp(height, nodes, air["speed_of_sound"])
    machs, frame = np.log(mach_nodes()), vehicle["airframe"]
    open_ = (mach < frame["wing_mach"]) | (np.linalg.norm(v, axis=1) < frame["wing_speed"])
    frame["drag"] = node_means(np.log(mach[~open_]), area[~open_], machs)
    frame["lift"] = node_means(np.log(mach[~open_]), (lift / drag)[~open_] / vehicle["lift_to_drag"], machs)
    if open_.any():
        frame["drag_with_wing"] = node_means(np.log(mach[open_]), area[open_], machs)
    return onboard, r, v, np.radians(truth["truth.bank_deg"][rows])


def reach_of(flight: Flight) -> dict[str, float]:
    """Nearest and highest end of an entry, and the error (m) of its flown bank angle in the same model."""
    if "parachute_s" not in flight.figures:
        return {}
    onboard, r, v, bank = true_model(flight)
    entry = Entry(onboard[0], np.append(r[0], v[0]))
    found = best(onboard[0], entry.start)
    speed = np.minimum.accumulate(np.linalg.norm(v, axis=1))
    knots = np.linspace(entry.lowest, speed[0], 400)
    flown = np.transpose([np.interp(knots, speed[::-1], part[::-1]) for part in (np.cos(bank), np.sin(bank))])
    again = entry.ends(flown)
    here, there = (tuple(one / np.linalg.norm(one)) for one in (r[0], r[-1]))
    error = np.subtract(again[:2], from_aim(onboard[0], here, there))
    return {
        "nearest_m": found.miss_m,
        "highest_m": found.altitude_m,
        "model_error_m": float(np.hypot(*error)),
    }


def drawn(vehicle: Vehicle, count: int, seed: int, speed: float) -> list[Case]:
    """Dispersed entries, with a wind of ``speed`` (m/s) if it is not zero."""
    scenario, cases = vehicle.load().scenario, []
    for k, truth in enumerate(entries(vehicle, count, seed)):
        blows = wind(360.0 / DIRECTIONS * k, speed)(scenario, truth) if speed else {}
        cases.append(Case(k, {**truth, **blows}, profile=k, label={"condition": DISPERSED}))
    return cases


def summary(rows: list[Row], nearest: np.ndarray, limit: float) -> list[str]:
    """Cells of a law."""
    miss, reachable = misses(rows), nearest <= limit
    height = column(rows, "parachute_altitude_m") / 1e3
    reached = Proportion.of(list(miss[reachable] <= limit))
    low, high = reached.interval
    return [
        bounded(miss, 0.5),
        bounded(miss, 0.95),
        f"{miss.max():.2f}",
        f"{100.0 * np.mean(miss <= limit):.0f}",
        f"{100.0 * reached.value:.1f} ({100.0 * low:.1f} to {100.0 * high:.1f})",
        f"{np.nanmin(height):.1f}",
        f"{percentage(row['success'] for row in rows):.0f}",
    ]


def main() -> None:
    """Fly and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mission", choices=[vehicle.name for vehicle in VEHICLES])
    parser.add_argument("--entries", type=int, default=100)
    parser.add_argument("--seed", type=int, default=4402)
    parser.add_argument("--wind", type=float, default=0.0)
    parser.add_argument("--laws", nargs="+", default=["fnpeg", "stochastic_pc", "etpc"])
    given = parser.parse_args()
    vehicle = next(one for one in VEHICLES if one.name == given.mission)
    cases, limit = drawn(vehicle, given.entries, given.seed, given.wind), WINDY_KM if given.wind else CALM_KM
    first, *others = given.laws
    flown = {first: list(fly_rows(with_law(vehicle, first), cases, collect=reach_of))}
    flown |= {law: list(fly_rows(with_law(vehicle, law), cases)) for law in others}
    nearest, highest, error = (
        column(flown[first], name) / 1e3 for name in ("nearest_m", "highest_m", "model_error_m")
    )
    print(f"`{given.mission}`, {given.entries} entries, seed {given.seed}, wind {given.wind:g} m/s:")
    print(f"within {limit:g} km of the aim point at best: {int(np.sum(nearest <= limit))} entries;", end=" ")
    print(
        f"largest least miss {np.nanmax(nearest):.2f} km; highest parachute at the aim point: lowest", end=" "
    )
    print(f"{np.nanmin(highest):.1f}, median {np.nanmedian(highest):.1f} km; the flown bank angle ends in")
    print(f"this model off the flight by {np.nanmedian(error):.2f} km (median)", end=", ")
    print(f"{np.nanquantile(error, 0.95):.2f} km (95 %)\n")
    heads = ("median, km", "95 %, km", "largest, km", f"within {limit:g} km, %", "of the reachable, %")
    print("| law | " + " | ".join((*heads, "lowest altitude, km", "in the box, %")) + " |")
    print("|---" + "|---:" * 7 + "|")
    for law, rows in flown.items():
        print(f"| `{law}` | " + " | ".join(summary(rows, nearest, limit)) + " |")


if __name__ == "__main__":
    main()
