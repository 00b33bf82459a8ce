"""Drawings of the study: Figs. 7 to 12 of the paper from flights of this vehicle, and the experiments."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from edl6dof.campaign.rows import Row
from edl6dof.interface.roles import HAZARD_AVOIDANCE, span
from edl6dof.report.figure import Figure
from edl6dof.sim.flight import Flight
from edl6dof.studies import plots
from edl6dof.studies.hu2022.rigs import FORMULATIONS, thrust_error_deg

TIME = "time (s)"
#: Figure, axis of this body frame, rate, and what S1 calls the axis: its pitch is the channel of sideslip.
_AXES = (
    ("fig8", "roll", "p", "roll"),
    ("fig9", "yaw", "r", "pitch"),
    ("fig10", "pitch", "q", "yaw"),
)


def drawings(
    nominal: Flight,
    shown: Mapping[str, Flight],
    rows: list[Row],
    steps: Mapping[str, Flight],
    avoided: Mapping[str, Flight],
    wings: Mapping[str, Flight],
) -> tuple[Figure, ...]:
    """Every drawing."""
    return (
        *_attitude(nominal),
        _estimates(nominal),
        _avoidance(avoided),
        _formulations(shown, rows),
        _steps(steps),
        _wings(wings),
    )


def _attitude(flight: Flight) -> list[Figure]:
    """Figs. 8 to 10: error and rate of each axis over the whole flight."""
    table, before = flight.telemetry, flight.telemetry["t_s"] < flight.metrics["touchdown_s"]
    t = table["t_s"][before]
    return [
        plots.figure(
            f"{name}_{axis}",
            (
                plots.panel(
                    f"{axis.title()} angle error (S1: {called})",
                    TIME,
                    "error (deg)",
                    (plots.curve(t, table[f"control.error_{axis}_deg"][before]),),
                ),
                plots.panel(
                    f"{axis.title()} rate",
                    TIME,
                    "rate (deg/s)",
                    (plots.curve(t, table[f"truth.rate_{rate}_deg_s"][before]),),
                ),
            ),
        )
        for name, axis, rate, called in _AXES
    ]


def _estimates(flight: Flight) -> Figure:
    """Figs. 11 and 12: estimated disturbance torque in the powered descent, force in hazard avoidance."""
    table = flight.telemetry
    powered = (table["t_s"] > flight.metrics["backshell_s"]) & (table["t_s"] < flight.metrics["touchdown_s"])
    avoiding = powered & (table["guide.phase"] >= span(flight.scenario.phase_roles, HAZARD_AVOIDANCE)[0])
    torque = tuple(
        plots.curve(table["t_s"][powered], table[f"estimate.torque_{a}_nm"][powered], a) for a in "xyz"
    )
    force = tuple(
        plots.curve(table["t_s"][avoiding], table[f"estimate.force_{a}_n"][avoiding], a) for a in "yz"
    )
    return plots.figure(
        "fig11_12_estimates",
        (
            plots.panel("Estimated disturbance torque", TIME, "torque (N m)", torque),
            plots.panel("Estimated lateral disturbance force", TIME, "force (N)", force),
        ),
    )


def _avoidance(flights: Mapping[str, Flight]) -> Figure:
    """Fig. 7: roll and place in hazard avoidance."""
    roll, place = [], []
    for name, flight in flights.items():
        table = flight.telemetry
        rows = flight.during(HAZARD_AVOIDANCE)
        t = table["t_s"][rows]
        roll.append(plots.curve(t - t[0], table["control.error_roll_deg"][rows], name))
        place.append(
            plots.curve(
                t - t[0], table["truth.site_east_m"][rows] - table["truth.site_east_m"][rows][0], name
            )
        )
    after = "time into hazard avoidance (s)"
    return plots.figure(
        "fig7_avoidance",
        (
            plots.panel("Roll error", after, "error (deg)", tuple(roll)),
            plots.panel("Way to the east", after, "way (m)", tuple(place)),
        ),
    )


def _formulations(shown: Mapping[str, Flight], rows: list[Row]) -> Figure:
    """Section 6.2: thrust-direction error from the entry with the largest roll error, and the time to find it
    over that error.
    """
    curves, dots = [], []
    for name in FORMULATIONS:
        flight, word = shown[name], name.replace("_", " ")
        curves.append(
            plots.curve(flight.telemetry["t_s"] - flight.telemetry["t_s"][0], thrust_error_deg(flight), word)
        )
        mine = [row for row in rows if row["experiment"] == "entry" and row["variant"] == name]
        roll, found = (np.array([row[key] for row in mine]) for key in ("roll_deg", "settled_s"))
        dots.append(plots.dots(np.abs(roll), found, word))
    return plots.figure(
        "formulations",
        (
            plots.panel(
                "Largest roll error",
                "time after the start (s)",
                "thrust-direction error (deg)",
                tuple(curves),
                x_range=(0.0, 12.0),
            ),
            plots.panel(
                "Dispersed entries",
                "roll error at the start (deg)",
                "thrust direction found after (s)",
                tuple(dots),
            ),
        ),
    )


def _steps(flights: Mapping[str, Flight]) -> Figure:
    """Section 6.2: yaw error and estimate after a torque step."""
    error, estimate = [], []
    for name, flight in flights.items():
        table = flight.telemetry
        t = table["t_s"] - table["t_s"][0]
        error.append(plots.curve(t, table["control.error_yaw_deg"], name))
        estimate.append(plots.curve(t, table["estimate.torque_z_nm"], name))
    true = next(iter(flights.values())).telemetry
    estimate.append(plots.reference(true["t_s"] - true["t_s"][0], true["truth.disturbance_z_nm"], "true"))
    after = "time after the step (s)"
    return plots.figure(
        "torque_step",
        (
            plots.panel("Yaw error", after, "error (deg)", tuple(error), x_range=(0.0, 20.0)),
            plots.panel("Disturbance torque", after, "torque (N m)", tuple(estimate), x_range=(0.0, 3.0)),
        ),
    )


def _wings(flights: Mapping[str, Flight]) -> Figure:
    """Section 4.3: angle of attack and pitch thruster with a trim wing that stays shut."""
    alpha, duty = [], []
    for name, flight in flights.items():
        table = flight.telemetry
        start, end = flight.metrics["trim_wing_s"], flight.metrics["parachute_s"]
        rows = (table["t_s"] > start - 5.0) & (table["t_s"] < end)
        t = table["t_s"][rows] - start
        alpha.append(plots.curve(t, table["truth.total_alpha_deg"][rows], name))
        duty.append(plots.curve(t, table["control.torque_y_nm"][rows], name))
    alpha.append(plots.reference(np.array([-5.0, t[-1]]), np.array([7.0, 7.0]), "limit"))
    after = "time after the command (s)"
    return plots.figure(
        "failed_trim_wing",
        (
            plots.panel("Total angle of attack", after, "angle (deg)", tuple(alpha)),
            plots.panel("Demanded pitch torque", after, "torque (N m)", tuple(duty)),
        ),
    )
