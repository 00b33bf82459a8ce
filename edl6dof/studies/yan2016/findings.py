"""Figures of every experiment beside what the paper says."""

from __future__ import annotations

import numpy as np
import pyarrow as pa

from edl6dof.sim.flight import Flight
from edl6dof.studies.cases import values
from edl6dof.studies.study import Finding
from edl6dof.studies.yan2016.experiments import GAINS, LAWS, OTHERS, PRINTED, UNDISTURBED, WITHIN, Experiment
from edl6dof.studies.yan2016.flights import OBSERVED_S, authority_rad_s
from edl6dof.studies.yan2016.settling import settled_s

#: Errors beside the nominal, and their names; in those along the flight FTC+DOB is said to be the better law.
ERRORS = {
    "rms_altitude_error_km": "RMS altitude error",
    "rms_range_error_km": "RMS range error",
    "final_altitude_error_km": "final altitude error",
    "final_range_error_km": "final range error",
}
UNPRINTED = (
    "with these gains the finite-time law settles the sooner where lift suffices ('{alone}'), and in flight "
    "it does with every pair of gains flown here; the paper prints none"
)
ALONE, SOONER = "eq. 21 alone, without saturation", "drag settled, PD less FTC"


def findings(table: pa.Table, nominal: Flight, exponent: float) -> tuple[Finding, ...]:
    """All findings; ``table`` has the flights, ``exponent`` is alpha_1."""
    found = []
    for experiment in (PRINTED, WITHIN):
        found += [
            *_authority(experiment, nominal),
            *_saturation(table, experiment),
            _estimate(table, experiment),
            *_errors(table, experiment),
            *_settling(table, experiment),
        ]
    found += [*_saturation(table, UNDISTURBED), *_alone(table, exponent)]
    for experiment in OTHERS:
        found += _compared(table, experiment)
    return tuple(found)


def _authority(experiment: Experiment, nominal: Flight) -> list[Finding]:
    """What lift can do to the flight-path rate, beside what the disturbance does."""
    rate = authority_rad_s(nominal)
    return [
        Finding("largest L/V", "rad/s", float(rate.max()), experiment=experiment.name),
        Finding(
            "flight in which L/V is above the amplitude",
            "%",
            100.0 * float(np.mean(rate > experiment.amplitude_rad_s)),
            experiment=experiment.name,
        ),
    ]


def _saturation(table: pa.Table, experiment: Experiment) -> list[Finding]:
    return [
        Finding(
            f"bank saturated, {title}",
            "%",
            mean(table, experiment, law, "saturated_pct"),
            note="of the flight",
            experiment=experiment.name,
        )
        for law, title in LAWS.items()
    ]


def _estimate(table: pa.Table, experiment: Experiment) -> Finding:
    worst = max(float(np.max(column(table, experiment, law, "estimate_error_pct"))) for law in LAWS)
    return Finding(
        "disturbance estimate, largest error",
        "%",
        worst,
        4.0,
        "<=",
        f"after {OBSERVED_S:g} s",
        experiment=experiment.name,
    )


def _errors(table: pa.Table, experiment: Experiment) -> list[Finding]:
    """Both laws, and the ratio, which the paper says is below one; what is left of it at the end is metres
    of altitude.
    """
    found = []
    for name, label in ERRORS.items():
        error = {law: mean(table, experiment, law, name) for law in LAWS}
        found += [
            Finding(f"{label}, {title}", "km", error[law], experiment=experiment.name)
            for law, title in LAWS.items()
        ]
        found.append(
            Finding(
                f"{label}, FTC over PD",
                "",
                error["ftc_dob"] / error["pd_dob"],
                1.0 if name.startswith("rms") else None,
                "<=",
                "text: FTC is better" if name.startswith("rms") else "",
                experiment=experiment.name,
            )
        )
    return found


def _settling(table: pa.Table, experiment: Experiment) -> list[Finding]:
    """Drag, which the text says PD brings to the nominal sooner."""
    found = [
        Finding(
            f"drag settled, {title}",
            "s",
            _settled(table, experiment, law),
            note="2 % of the peak, all corners",
            experiment=experiment.name,
        )
        for law, title in LAWS.items()
    ]
    found.append(
        Finding(
            SOONER,
            "s",
            _sooner(table, experiment),
            0.0,
            "<=",
            "text: PD is sooner",
            why=UNPRINTED.format(alone=ALONE),
            experiment=experiment.name,
        )
    )
    return found


def _alone(table: pa.Table, exponent: float) -> list[Finding]:
    """Settling of the error dynamics from the mean drag error at the start."""
    start = mean(table, PRINTED, "ftc_dob", "start_error_m_s2")
    powers = {"ftc_dob": exponent, "pd_dob": 1.0}
    return [
        Finding(
            f"drag error below {100 * share:g} %, {title}",
            "s",
            settled_s(start, GAINS, powers[law], share),
            note=f"from {start:.2g} m/s2",
            experiment=ALONE,
        )
        for share in (0.01, 1e-6)
        for law, title in LAWS.items()
    ]


def _compared(table: pa.Table, experiment: Experiment) -> list[Finding]:
    """The comparison with other gains."""
    ratios = [
        Finding(
            f"{ERRORS[name]}, FTC over PD",
            "",
            mean(table, experiment, "ftc_dob", name) / mean(table, experiment, "pd_dob", name),
            experiment=experiment.name,
        )
        for name in ("rms_altitude_error_km", "rms_range_error_km")
    ]
    sooner = _sooner(table, experiment)
    return [*ratios, Finding(SOONER, "s", sooner, experiment=experiment.name)]


def _sooner(table: pa.Table, experiment: Experiment) -> float:
    """How much later drag settles under PD than under FTC, s."""
    ftc, pd = (_settled(table, experiment, law) for law in LAWS)
    return pd - ftc


def _settled(table: pa.Table, experiment: Experiment, law: str) -> float:
    """When drag has settled from every corner, s."""
    return float(np.max(column(table, experiment, law, "drag_settled_s")))


def mean(table: pa.Table, experiment: Experiment, law: str, name: str) -> float:
    """Mean of a column over the corners."""
    return float(np.mean(column(table, experiment, law, name)))


def column(table: pa.Table, experiment: Experiment, law: str, name: str) -> np.ndarray:
    """A column of the flights of one law in one experiment."""
    rows = zip(table["experiment"].to_pylist(), table["law"].to_pylist(), strict=True)
    return values(table, name)[np.array([row == (experiment.name, law) for row in rows])]
