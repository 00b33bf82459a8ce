"""What rounds differently on another machine has no place in a kernel or between a file and a record.

C libraries, numpy and BLAS choose their code by processor, ``np.interp`` and ``np.arange`` of floats may be
compiled with fused multiply-add, and Python's ``sum`` adds floats in another way since 3.12.
``edl6dof/spatial`` has what takes their place: ``elementary`` for kernels, ``arrays`` for host code, and
``stream`` for random numbers.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import edl6dof

PACKAGE = Path(edl6dof.__file__).parent
#: All that lies between a file and a record, flies, or makes a figure of a flight.
ON_THE_WAY = (
    *("config", "interface", "spatial", "environment", "vehicle", "sensors", "fsw", "scenario", "sim"),
    *("telemetry", "metrics", "interchange", "campaign/design"),
)
TRANSCENDENTAL = {
    *("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "arcsin", "arccos", "arctan", "arctan2"),
    *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "arcsinh", "arccosh", "arctanh"),
    *("exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "logaddexp", "pow", "power", "float_power"),
    *("hypot", "dist", "cbrt", "erf", "erfc", "gamma", "lgamma", "sinc", "i0", "sumprod", "fma"),
}
PRODUCTS = {
    *("dot", "vdot", "inner", "matmul", "tensordot", "einsum", "convolve", "correlate", "linalg", "kron"),
    *("cov", "corrcoef", "polyfit", "interp", "leggauss", "fft2", "ifft2", "rfft", "ifft", "default_rng"),
    *("Generator", "matvec", "vecdot", "geomspace", "logspace"),
}
#: Exceptions, each with why it makes no record.
ALLOWED = {
    "sim/linear.py": "a linear analysis of a flight, which no flight reads",
    "sim/attitude_loop.py": "a linear analysis of a flight, which no flight reads",
    "sim/frozen.py": "a frozen flight, which makes no record",
    "sim/measured_loop.py": "an analysis of a frozen flight, which no flight reads",
    "spatial/rotations.py": "attitudes of pictures",
    "spatial/elementary.py:**": "integers, when the module is imported",
    "scenario/unusual.py:dist": "a warning; no record holds it",
    "vehicle/mass.py:eigvalsh": "the numbers of an error message",
    "vehicle/mass.py:linalg": "the numbers of an error message",
    "vehicle/aerodynamics/newtonian.py:ConvexHull": "a warning; no record holds it",
    "campaign/design/sampling.py:default_rng": "starts the scrambling of Sobol numbers, integers",
    "campaign/design/sampling.py:qmc": "Sobol numbers: integers, scaled by a power of two",
    "interface/effectors.py:sum": "integers",
    "campaign/design/dispersions.py:sum": "integers",
    "campaign/design/sampling.py:sum": "integers",
    "campaign/design/distributions.py:sum": "truth values, and compared with zero",
}


def violations(source: str) -> Iterator[tuple[int, str]]:
    """Line and name of everything in a module that may round differently elsewhere."""
    tree = ast.parse(source)
    kernels = {
        id(inside)
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef)
        and any("kernel" in ast.unparse(d) for d in function.decorator_list)
        for inside in ast.walk(function)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module in ("math", "cmath", "numpy"):
            yield from ((node.lineno, a.name) for a in node.names if a.name in TRANSCENDENTAL | PRODUCTS)
        elif isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "scipy":
            yield from ((node.lineno, a.name) for a in node.names)
        elif isinstance(node, ast.Attribute) and _inexact(ast.unparse(node.value), node.attr):
            yield node.lineno, node.attr
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            yield node.lineno, "@"
        elif (
            isinstance(node, ast.BinOp)
            and isinstance(node.op, ast.Pow)
            and not _exact(node, id(node) in kernels)
        ):
            yield node.lineno, "**"
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "sum":
            yield node.lineno, "sum"


def _inexact(of: str, name: str) -> bool:
    if of in ("np", "numpy", "math", "cmath"):
        return name in TRANSCENDENTAL | PRODUCTS
    return name == "dot" or of.endswith("linalg") or (of.startswith("np.") and name in PRODUCTS)


def _exact(power: ast.BinOp, in_kernel: bool) -> bool:
    """Whether a power is a product of integers or, in a kernel, one that numba writes out."""
    try:
        exponent = ast.literal_eval(power.right)
    except ValueError:
        return isinstance(power.left, ast.Constant) and isinstance(power.left.value, int)
    if not isinstance(exponent, int):
        return False
    return in_kernel or isinstance(power.left, ast.Constant)


@pytest.mark.parametrize("folder", ON_THE_WAY)
def test_nothing_rounds_differently_elsewhere(folder):
    found = []
    for path in sorted((PACKAGE / folder).rglob("*.py")):
        place = path.relative_to(PACKAGE).as_posix()
        if place not in ALLOWED:
            found += [
                f"{place}:{line}: {name}"
                for line, name in violations(path.read_text(encoding="utf-8"))
                if f"{place}:{name}" not in ALLOWED
            ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "line",
    [
        *("from math import sin", "np.exp(x)", "math.hypot(x, y)", "a @ b", "a.dot(b)", "np.dot(a, b)"),
        *("np.linalg.norm(x)", "np.einsum('i,i', a, b)", "x ** 2", "2.0 ** x", "np.random.default_rng(1)"),
        *("from scipy.special import ndtri", "sum(values)", "np.fft.fft2(x)", "np.interp(x, a, b)"),
        *("@kernel\ndef f(x):\n    return x ** 1.5", "def f(x):\n    return x ** 2"),
    ],
)
def test_the_rule_finds(line):
    assert list(violations(line))


@pytest.mark.parametrize(
    "line", ["2.0**-53", "2 ** len(x)", "@kernel\ndef f(x):\n    return x**2", "np.sqrt(x)", "dot(a, b)"]
)
def test_the_rule_lets_pass(line):
    assert not list(violations(line))
