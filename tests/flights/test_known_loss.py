"""A thruster that has lost part of its thrust stays in use: once the loss is known, it is no disturbance."""

import numpy as np
import pytest

import edl6dof

UNMETERED = "sensors.carried=[inertial_unit, star_tracker, ground_tracking, radar, switches]"


@pytest.mark.parametrize(
    ("thruster", "begin_s"), [("D7", 503.0), pytest.param("F3", 128.0, marks=pytest.mark.long)]
)
def test_a_known_loss_is_no_disturbance(thruster, begin_s):
    """Slope of the changes of the unexplained force and torque, along those of the thruster, over the changes
    of its commanded thrust: the share of the thrust that is missing.
    """
    lost = "degraded: {thrust_factor: 0.5, flow_factor: 1}"
    fault = f"faults=[{{thruster: {thruster}, kind: degraded, {lost}, at: {{time_s: {begin_s}}}}}]"
    flight = edl6dof.Simulation(edl6dof.load("tianwen1", [UNMETERED, fault]))
    number = flight.loaded.scenario.thruster_names.index(thruster)
    flight.step(cycles=round(begin_s / 0.02))
    fsw = flight.running.fsw[0]
    full, rows = fsw["effectiveness"]["matrix"][number].copy(), []
    while flight.step(cycles=2):
        unexplained = fsw["disturbance"]["unexplained"] @ full / (full @ full)
        rows.append((fsw["nav"]["t"], fsw["estimation"]["activity"]["share"][number], unexplained))
    t, share, unexplained = np.array(rows).T
    isolated = fsw["diagnosis"]["isolated"][: fsw["diagnosis"]["n_isolated"]]
    assert isolated["thruster"].tolist() == [number]
    assert fsw["health"]["thruster"][number] == 1
    assert fsw["health"]["loss"][number] == pytest.approx(0.5, abs=0.1)

    def missing(some):
        changes = np.diff(share[some])
        assert np.count_nonzero(changes) >= 4
        return -(changes @ np.diff(unexplained[some])) / (changes @ changes)

    begun = t > begin_s + 0.05  # what is measured before that fired without the fault
    assert missing(begun & (t < isolated["t"][0])) == pytest.approx(0.5, abs=0.1)
    assert missing(t > isolated["t"][0] + 0.3) == pytest.approx(0.0, abs=0.1)
