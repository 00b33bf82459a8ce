"""Compiled code contains the values of the globals that it reads, and is kept for other processes.  So each
must follow from the sources alone, which are the key of the cache: from no processor, library, time or file.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from frozen_globals import frozen

PROGRAM = Path(__file__).with_name("frozen_globals.py")
#: Another processor, other hashes, another folder.
ELSEWHERE = {
    "OPENBLAS_CORETYPE": "Prescott",
    "NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3 AVX512F",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-AVX2,-FMA",
    "PYTHONHASHSEED": "5",
    "TZ": "Asia/Tokyo",
}


def values(folder, **environment):
    command = [sys.executable, str(PROGRAM)]
    path = os.pathsep.join([str(PROGRAM.parents[2]), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": path} | environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)


def test_every_value_that_a_kernel_freezes_is_the_same_in_every_process(tmp_path):
    here, elsewhere = values(Path.cwd(), PYTHONHASHSEED="1"), values(tmp_path, **ELSEWHERE)
    assert len(here) > 900
    assert [name for name in here if here[name] != elsewhere.get(name)] == []
    assert here.keys() == elsewhere.keys()


SIZE, TABLE = 0.1 + 0.2, np.array([1.0, 2.0])


def reads(x):
    def inside(y):
        return y * TABLE[0]

    return inside(x) + SIZE


def test_a_value_is_found_to_its_last_bit():
    found = frozen(reads)
    assert found.keys() == {"SIZE", "TABLE"} and found["SIZE"] == SIZE.hex() != (0.3).hex()
    TABLE[1] = np.nextafter(2.0, 3.0)
    assert frozen(reads)["TABLE"] != found["TABLE"]


def test_a_value_of_no_known_kind_is_refused(monkeypatch):
    monkeypatch.setitem(globals(), "SIZE", object())
    with pytest.raises(TypeError, match="a kernel reads"):
        frozen(reads)
