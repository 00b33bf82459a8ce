"""Pressure ports against modified Newtonian pressure written out here."""

import numpy as np
import pytest
from instrument_bench import Bench

from edl6dof.vehicle.mass import CONFIG_BACKSHELL, CONFIG_CAPSULE


def ports(case=0, **params):
    bench = Bench("pressure_ports", {"bias_pa": 0.0, "scale_pct": 0.0, "noise_pa": 0.0} | params, case=case)
    bench.plant["shape"] = CONFIG_CAPSULE
    bench.outputs["pressure"], bench.outputs["dynamic_pressure"] = 30.0, 4000.0
    bench.outputs["v_air_B"] = (2000.0, 100.0, -300.0)
    return bench


def test_pressure_is_that_of_the_flow_met_by_the_normal():
    bench = ports(stagnation_coefficient=1.8)
    read = bench.measure()["pressure"]
    flow = np.array([2000.0, 100.0, -300.0]) / np.linalg.norm([2000.0, 100.0, -300.0])
    normals = bench.params["ports"]["axis"][: bench.params["n_ports"]]
    np.testing.assert_allclose(read[:7], 30.0 + 1.8 * 4000.0 * (normals @ flow) ** 2, rtol=1e-12)
    assert read[7] == 0.0 and np.ptp(read[:7]) > 500.0
    bench.outputs["v_air_B"] = (-2000.0, 0.0, 0.0)
    assert bench.measure()["pressure"][:7] == pytest.approx(30.0)


def test_errors_have_their_spread_and_nothing_is_read_without_the_heat_shield():
    true = ports().measure()["pressure"][:7].copy()
    noisy = ports(noise_pa=3.0)
    noise = np.array([noisy.measure()["pressure"][:7].copy() for _ in range(2000)]) - true
    assert noise.std() == pytest.approx(3.0, rel=5.0 / np.sqrt(28000.0))
    off = [
        ports(case, bias_pa=5.0, scale_pct=1.0).measure()["pressure"][:7].copy() - true for case in range(150)
    ]
    spread = np.hypot(5.0, 0.01 * true)
    assert np.std(off / spread) == pytest.approx(1.0, rel=5.0 / np.sqrt(2100.0))
    noisy.plant["shape"] = CONFIG_BACKSHELL
    assert not noisy.measure()["pressure"].any()
