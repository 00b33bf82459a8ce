"""A float becomes an index in one place only, where every float finds one within the table."""

from source_rules import breaches, modules, whole_numbers_in_kernels

FLYING = modules(
    "environment",
    "fsw",
    "interface",
    "metrics",
    "scenario",
    "sensors",
    "sim",
    "spatial",
    "telemetry",
    "vehicle",
)
LOOKUPS = "edl6dof.spatial.table_index"
#: Work on the bits of numbers, and index nothing but tables of their own.
BITS = ("edl6dof.spatial.random_numbers", "edl6dof.spatial.elementary", "edl6dof.spatial.arrays")


def test_no_kernel_makes_an_index_of_a_float_itself():
    others = [(name, source) for name, source in FLYING if name not in (LOOKUPS, *BITS)]
    assert breaches(lambda _, source: whole_numbers_in_kernels(source), others) == {}


def test_planted_conversions_are_found():
    for planted in (
        "i = int(x)",
        "i = table.searchsorted(x)",
        "i = np.int64(x) + 1",
        "i = math.floor(x)",
        "i = x.astype(int)[0]",
    ):
        assert (
            whole_numbers_in_kernels(f"@kernel\ndef look(table, x):\n    {planted}\n    return table[i]")
            != []
        )
    assert whole_numbers_in_kernels("def plan(x):\n    return int(x)") == []
    assert whole_numbers_in_kernels(dict(FLYING)[LOOKUPS]) != []
