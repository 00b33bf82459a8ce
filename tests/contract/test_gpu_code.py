"""What a flight runs stays such that GPU code can be made of it; ``tools/gpu_code.py`` makes it."""

from source_rules import breaches, foreign_to_gpus, modules

FLYING = modules("environment", "fsw", "interface", "sensors", "sim", "spatial", "vehicle", "telemetry")


def test_kernels_of_a_flight_hold_nothing_that_no_gpu_has():
    assert breaches(lambda _, source: foreign_to_gpus(source), FLYING) == {}


def test_planted_statements_are_found():
    for planted in (
        "x = np.floor(y)",
        "x = np.zeros(3)",
        "a[:] = b",
        "a[0, :] = b[1]",
        "b = a.copy()",
        "print(y)",
        "raise ValueError",
    ):
        assert foreign_to_gpus(f"@kernel\ndef look(a, b, y):\n    {planted}\n") != []
    assert foreign_to_gpus("@kernel\ndef clear(a, b):\n    a[:] = 0.0\n    b[0] = a[1]\n") == []
    assert foreign_to_gpus("def plan(a, b):\n    a[:] = b\n") == []
