"""Rows follow from everything that is read: a campaign goes on only with the same plan, program and
tables.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from campaign_run import ROOT, write_drop

import edl6dof
from edl6dof.campaign import engines, run
from edl6dof.campaign import identity as origin
from edl6dof.campaign.design.plan import load_plan
from edl6dof.campaign.engines import Threads
from edl6dof.campaign.identity import input_files
from edl6dof.campaign.store import Store
from edl6dof.config.errors import ConfigError
from edl6dof.environment import atmosphere_table

DATA = ROOT / "edl6dof" / "data"
AIR = DATA / "atmosphere" / "marsgram2010_jezero_feb2021_winds.csv"
AERO = DATA / "aerodynamics" / "phoenix_70deg_static_aero.csv"


def names(plan):
    return [path.name for path in input_files(plan)]


def drop_with(folder: Path, *lines: str) -> str:
    path = Path(write_drop(folder))
    text = path.read_text()
    if any(line.startswith("atmosphere:") for line in lines):
        text = text.replace(f"atmosphere:\n  table: {AIR.name}\n", "")
    path.write_text(text + "\n".join(lines) + "\n")
    return str(path)


def test_shipped_tables_of_the_shipped_campaign():
    assert names(load_plan("tianwen1_mc")) == [
        AERO.name,
        "mars_gmm3_degree12.npy",
        "mars_gmm3_degree12.yaml",
        AIR.name,
        "gmm3_degree12_sha.tab",
        "mola_1deg_colat_lon.npy",
        "mola_1deg_colat_lon.yaml",
    ]


@pytest.mark.parametrize(
    "lines",
    [
        ["atmosphere: {{table: {air}}}"],
        ["truth: {{atmosphere.table: {air}}}"],
        [
            (
                "sweep: {{axes: [{{path: atmosphere.table, of: truth, values: [{air}, "
                "mars_cospar_nh_mean.csv]}}]}}"
            )
        ],
        ["sweep: {{axes: [{{path: atmosphere, values: [{{table: {air}}}]}}]}}"],
        ["    atmosphere.table: {{kind: discrete, choices: [{air}, mars_cospar_nh_mean.csv]}}"],
    ],
    ids=["scenario", "truth", "sweep", "sweep of a section", "dispersion"],
)
def test_files_of_the_user_wherever_they_are_named(tmp_path, lines):
    mine = shutil.copy(AIR, tmp_path / "mine.csv")
    assert Path(mine).resolve() in input_files(
        load_plan(drop_with(tmp_path, *(line.format(air=mine) for line in lines)))
    )


def test_vehicles_of_a_sweep_and_their_tables(tmp_path):
    """A vehicle that some cases have is not written out in the plan."""
    shutil.copy(AERO, tmp_path / "aero.csv")
    text = (ROOT / "vehicles" / "tianwen1.yaml").read_text()
    text = (ROOT / "vehicles" / "tianwen1.yaml").read_text()
    named = text.replace("  capsule:\n", f"  capsule:\n    static_table: {tmp_path / 'aero.csv'}\n", 1)
    (tmp_path / "capsule.yaml").write_text(named)
    file = Path(
        drop_with(tmp_path, "sweep: {axes: [{path: vehicle, of: truth, values: [capsule.yaml, tianwen1]}]}")
    )
    file.write_text(file.read_text().replace("    vehicle.", "    # vehicle."))
    found = input_files(load_plan(str(file)))
    named = {tmp_path / "capsule.yaml", tmp_path / "aero.csv", ROOT / "vehicles" / "tianwen1.yaml"}
    assert named | {AERO, AIR} <= set(found), "a vehicle that names no table takes the default"


class Changing(Threads):
    """Threads with which something happens after the last flight, when two of three parts are written."""

    def __init__(self, event):
        super().__init__(1)
        self.event = event

    def rows(self, plan, ranges):
        """Rows of all cases."""
        for number, row in enumerate(super().rows(plan, ranges)):
            if number == plan.count - 1:  # nothing flies any more, and the third part is not written
                self.event()
            yield row


def stop():
    raise KeyboardInterrupt


@pytest.fixture
def thin_air(tmp_path):
    """A campaign with an atmosphere table of the user, and what changes one density in it."""
    table = tmp_path / "mine.csv"
    shutil.copy(AIR, table)
    was = table.read_text()
    line = was.splitlines()[20]
    cells = line.split(",")
    column = [cell.strip().startswith("rho") for cell in was.splitlines()[0].split(",")].index(True)
    cells[column] = repr(float(cells[column]) * 1.5)
    changed = was.replace(line, ",".join(cells))
    plan = load_plan(drop_with(tmp_path, f"atmosphere: {{table: {table}}}"), cases=110)
    whole = Store(tmp_path / "whole")
    run.begin(plan, whole, None)
    run.fly(plan, whole, Threads())
    return plan, table, was, changed, (whole.folder / "cases.parquet").read_bytes()


def test_table_changed_between_kill_and_resume(tmp_path, thin_air):
    plan, table, was, changed, undisturbed = thin_air
    store = Store(tmp_path / "out")
    run.begin(plan, store, None)
    with pytest.raises(KeyboardInterrupt):
        run.fly(plan, store, Changing(stop))
    table.write_text(changed)
    first, second = (hashlib.sha256(text.encode()).hexdigest()[:12] for text in (was, changed))
    with pytest.raises(ConfigError, match=f"file {table}: was {first}, is {second}"):
        run.resumed_plan(store)
    table.unlink()
    with pytest.raises(ConfigError, match=f"file {table}: was {first}, is gone"):
        run.resumed_plan(store)
    table.write_text(was)
    run.fly(run.resumed_plan(store), store, Threads())
    assert (store.folder / "cases.parquet").read_bytes() == undisturbed


def test_scenario_edited_between_kill_and_resume(tmp_path, thin_air):
    """The folder's own copy counts: an edit of it is refused, one of the user's file changes nothing."""
    plan, _, _, _, undisturbed = thin_air
    store = Store(tmp_path / "out")
    run.begin(plan, store, None)
    with pytest.raises(KeyboardInterrupt):
        run.fly(plan, store, Changing(stop))
    (tmp_path / "drops.yaml").write_text("name: another\n")
    own = store.folder / "campaign.yaml"
    was = own.read_text()
    assert was.count("speed_m_s: 50.0") == 1
    own.write_text(was.replace("speed_m_s: 50.0", "speed_m_s: 51.0"))
    with pytest.raises(ConfigError, match="campaign.yaml"):
        run.fly(run.resumed_plan(store), store, Threads())
    own.write_text(was)
    os.utime(own, (0, 0))  # a clock that was set back in between has no say
    run.fly(run.resumed_plan(store), store, Threads())
    assert (store.folder / "cases.parquet").read_bytes() == undisturbed


def test_table_changed_while_it_flies(tmp_path, thin_air):
    plan, table, was, changed, undisturbed = thin_air
    store = Store(tmp_path / "out")
    run.begin(plan, store, None)
    with pytest.raises(ConfigError, match=f"{table} changed while it was flown"):
        run.fly(plan, store, Changing(lambda: table.write_text(changed)))
    assert len(store.parts.indices()) == 2 and not store.complete
    table.write_text(was)
    run.fly(run.resumed_plan(store), store, Threads())
    assert (store.folder / "cases.parquet").read_bytes() == undisturbed


def test_shipped_table_changed_between_kill_and_resume(tmp_path, monkeypatch):
    """The package's own tables count like those of a user; where the package lies does not."""
    plan, store = load_plan(write_drop(tmp_path), cases=60), Store(tmp_path / "out")
    run.begin(plan, store, None)
    shutil.copytree(DATA, tmp_path / "edl6dof" / "data")
    monkeypatch.setattr(atmosphere_table, "DATA", tmp_path / "edl6dof" / "data")
    monkeypatch.setattr(origin, "PACKAGE", tmp_path / "edl6dof")
    copy = tmp_path / "edl6dof" / "data" / "atmosphere" / AIR.name
    copy.write_bytes(AIR.read_bytes() + b"\n")
    with pytest.raises(
        ConfigError, match=(f"file edl6dof/data/atmosphere/{AIR.name}: was [0-9a-f]{{12}}, is [0-9a-f]{{12}}")
    ):
        run.resumed_plan(store)


@pytest.mark.parametrize("library, sampling", [("numpy", None), ("numba", None), ("scipy", "sobol")])
def test_other_versions_are_named_each(tmp_path, monkeypatch, library, sampling):
    plan, store = load_plan(write_drop(tmp_path), cases=60, sampling=sampling), Store(tmp_path / "out")
    run.begin(plan, store, None)
    monkeypatch.setattr(getattr(origin, library), "__version__", "0.7")
    monkeypatch.setattr(edl6dof, "__version__", "9.9")
    with pytest.raises(ConfigError, match=rf"edl6dof: was .*, is 9.9; {library}: was .*, is 0.7\)"):
        run.resumed_plan(store)


def test_what_moves_no_bit_is_in_no_identity(tmp_path, monkeypatch):
    plan = load_plan(write_drop(tmp_path), cases=60)
    assert set(origin.identity(plan).versions) == {"edl6dof", "numpy", "numba"}
    package = tmp_path / "edl6dof"
    for folder in ("fsw", "report"):
        (package / folder).mkdir(parents=True)
        (package / folder / "a.py").write_text("1")
    monkeypatch.setattr(origin, "PACKAGE", package)
    hashes = []
    for changed in ("fsw", "report"):
        origin.source_hash.cache_clear()
        hashes.append(origin.source_hash())
        (package / changed / "a.py").write_text("2")
    origin.source_hash.cache_clear()
    hashes.append(origin.source_hash())
    origin.source_hash.cache_clear()
    assert hashes[0] != hashes[1] == hashes[2]


def test_worker_of_a_cluster_is_compared_item_by_item(tmp_path, monkeypatch):
    plan = load_plan(write_drop(tmp_path), cases=60)
    ordered = origin.identity(plan)
    assert [row["case"] for row in engines.fly_range((plan.text, ordered), 20, 22)] == [20, 21]
    monkeypatch.setattr(engines, "_worker", lambda: "tcp://10.0.0.7:4321")
    other = ordered.model_copy(update={"versions": {**ordered.versions, "numpy": "1.0"}, "sources": "f" * 64})
    words = r"worker tcp://10.0.0.7:4321 .*sources of edl6dof: was f{12}, is .*; "
    words += rf"numpy: was 1.0, is {np.__version__}"
    with pytest.raises(OSError, match=words):
        engines.fly_range((plan.text, other), 0, 1)
