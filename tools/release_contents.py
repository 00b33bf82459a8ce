"""What a release holds, held against the repository: nothing that is not tracked, and nothing missing.

    python -m build && python tools/release_contents.py dist

Exit status 1 where a file is missing or one too many.
"""

from __future__ import annotations

import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

#: Tracked files that no release holds.
OF_THE_REPOSITORY = (".github/", ".ci/")
#: Files that building makes.
BUILT = {"PKG-INFO"}
#: Where the wheel puts files of the repository that are not in the package.
SHARED = {"vehicles/": "edl6dof/share/vehicles/", "scenarios/": "edl6dof/share/scenarios/"}


def tracked() -> set[str]:
    """Files of the repository."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True)
    return set(listed.stdout.splitlines())


def in_sdist(path: Path) -> set[str]:
    """Files of a source distribution, without its folder."""
    with tarfile.open(path) as archive:
        return {name.partition("/")[2] for name in archive.getnames()} - BUILT


def in_wheel(path: Path) -> set[str]:
    """Files of a wheel, without its own records."""
    with zipfile.ZipFile(path) as archive:
        return {name for name in archive.namelist() if ".dist-info/" not in name}


def wanted_in_wheel(files: set[str]) -> set[str]:
    """What a wheel of these files holds."""
    shared = {
        new + file.removeprefix(old) for old, new in SHARED.items() for file in files if file.startswith(old)
    }
    return shared | {file for file in files if file.startswith("edl6dof/")}


def compare(name: str, found: set[str], wanted: set[str]) -> bool:
    """Print what is missing and what is too much; returns whether nothing is."""
    for word, files in (("missing", wanted - found), ("too much", found - wanted)):
        for file in sorted(files):
            print(f"{name}: {word}: {file}")
    print(f"{name}: {len(found)} files")
    return found == wanted


def main(folder: Path) -> int:
    """Look at what lies in ``folder``; returns the exit status."""
    files = tracked()
    source = {file for file in files if not file.startswith(OF_THE_REPOSITORY)}
    sdists, wheels = list(folder.glob("*.tar.gz")), list(folder.glob("*.whl"))
    same = [compare(path.name, in_sdist(path), source) for path in sdists]
    same += [compare(path.name, in_wheel(path), wanted_in_wheel(files)) for path in wheels]
    return 0 if same and all(same) else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else "dist")))
