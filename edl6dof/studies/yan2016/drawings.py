"""Figures 2 to 9 of the paper, redrawn."""

from __future__ import annotations

import numpy as np

from edl6dof.report.figure import Figure, Panel
from edl6dof.sim.flight import Flight
from edl6dof.studies import plots
from edl6dof.studies.yan2016.experiments import LAWS
from edl6dof.studies.yan2016.flights import downrange_m, observed


def drawings(nominal: Flight, shown: dict[str, Flight]) -> tuple[Figure, ...]:
    """Of one flight under each law beside the nominal."""
    return (*_tracking(nominal, shown), *_observer(shown["ftc_dob"]))


def _tracking(nominal: Flight, shown: dict[str, Flight]) -> tuple[Figure, ...]:
    def column(name: str, per: float = 1.0) -> dict[str, np.ndarray]:
        return {law: flight.telemetry[name] / per for law, flight in (*shown.items(), ("nominal", nominal))}

    times = column("t_s")
    drag = column("nav.drag_m_s2")
    rate = {law: np.gradient(drag[law], times[law]) for law in drag}
    ranges = {law: downrange_m(flight) / 1e3 for law, flight in (*shown.items(), ("nominal", nominal))}
    compared = (
        ("fig2_speed", "speed (m/s)", column("truth.speed_m_s")),
        ("fig3_longitude", "longitude (deg)", column("truth.longitude_deg")),
        ("fig4_drag", "drag (m/s2)", drag),
        ("fig5_drag_rate", "drag rate (m/s3)", rate),
        ("fig6_altitude", "altitude above the ellipsoid (km)", column("truth.altitude_m", 1e3)),
        ("fig7_range", "range (km)", ranges),
    )
    return tuple(
        plots.figure(name, tuple(_beside(label, times, curves, law) for law in ("pd_dob", "ftc_dob")))
        for name, label, curves in compared
    )


def _beside(label: str, times: dict[str, np.ndarray], curves: dict[str, np.ndarray], law: str) -> Panel:
    pair = (
        plots.curve(times[law], curves[law], "flown"),
        plots.reference(times["nominal"], curves["nominal"], "nominal"),
    )
    return plots.panel(LAWS[law], "time (s)", label, pair)


def _observer(flight: Flight) -> tuple[Figure, ...]:
    t, estimate, true = observed(flight)
    both = plots.curve(t, estimate, "estimate"), plots.reference(t, true, "true")
    return (
        plots.figure(
            "fig8_disturbance",
            (plots.panel("Disturbance of the flight-path rate", "time (s)", "d (rad/s)", both),),
        ),
        plots.figure(
            "fig9_estimate_error",
            (
                plots.panel(
                    "Error of the estimate",
                    "time (s)",
                    "d - estimate (rad/s)",
                    (plots.curve(t, true - estimate),),
                ),
            ),
        ),
    )
