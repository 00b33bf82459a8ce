"""Size of edl6dof and of every package that it requires, as installed here; the getting started page has it.

python tools/installed_size.py
"""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import Distribution, distribution
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: Smaller ones are counted together.
SMALLEST_MB = 5.0


def required(names: list[str]) -> dict[str, Distribution]:
    """Packages of these names and those that they require, without extras and other systems' packages."""
    found: dict[str, Distribution] = {}
    while names:
        name = re.split(r"[^\w.-]", names.pop())[0].lower().replace("_", "-")
        if name not in found:
            found[name] = distribution(name)
            names += [text for text in found[name].requires or () if ";" not in text]
    return found


def size_mb(one: Distribution) -> float:
    """Size of the files of a package, without bytecode, MB."""
    files = (Path(str(one.locate_file(file))) for file in one.files or () if file.suffix != ".pyc")
    return sum(file.stat().st_size for file in files if file.is_file()) / 1e6


def main() -> None:
    """Print sizes, the largest first."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    sizes = {name: size_mb(one) for name, one in required(list(project["dependencies"])).items()}
    sources = [file for top in ("edl6dof", "vehicles", "scenarios") for file in (ROOT / top).rglob("*")]
    sizes["this package"] = sum(f.stat().st_size for f in sources if f.is_file() and f.suffix != ".pyc") / 1e6
    rest = {name for name, size in sizes.items() if size < SMALLEST_MB}
    for name in sorted(sizes.keys() - rest, key=lambda name: -sizes[name]):
        print(f"{name:<16} {sizes[name]:>6.0f} MB")
    print(f"{f'{len(rest)} others':<16} {sum(sizes[name] for name in rest):>6.0f} MB")
    print(f"{'all':<16} {sum(sizes.values()):>6.0f} MB")


if __name__ == "__main__":
    main()
