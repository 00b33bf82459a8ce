"""Machine code that a wheel brings: numba's files of all kernels that the shipped scenarios fly.

``tools/wheel_with_code.py`` makes the archive.  It is unpacked once into the user's folder for machine code;
code that the archive lacks, or that another version of numba made, is compiled as usual.
"""

from __future__ import annotations

import os
import tarfile
from lzma import LZMAError
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp

#: Processors that the code is for, by numba's name, and instructions that they have, by those of Linux.
TARGET, _INSTRUCTIONS = "x86-64-v3", {"avx2", "bmi1", "bmi2", "fma", "f16c", "movbe"}
ARCHIVE = Path(__file__).with_name("code.tar.xz")


def is_usable() -> bool:
    """Return True if there is code for this processor."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            flags = next((line for line in file if line.startswith("flags")), "")
    except OSError:
        return False
    return ARCHIVE.exists() and set(flags.split()) >= _INSTRUCTIONS


def unpack(place: Path) -> None:
    """Make the folder ``place`` and unpack the code into it, unless another process has done so.

    Raises:
        OSError: the folder cannot be written to, or the archive is damaged.
    """
    own = mkdtemp(dir=place.parent)
    try:
        with tarfile.open(ARCHIVE) as archive:
            for one in archive:  # Python below 3.11.4 has no filter for extractall
                if content := archive.extractfile(one):
                    Path(own, Path(one.name).name).write_bytes(content.read())
        os.rename(own, place)
    except (tarfile.TarError, LZMAError, EOFError) as error:
        raise OSError(str(error)) from error
    except OSError:
        if not place.exists():
            raise
    finally:
        rmtree(own, ignore_errors=True)
