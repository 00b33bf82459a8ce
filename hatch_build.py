"""Build hook: adds machine code to a wheel, where ``EDL6DOF_CODE`` names its archive."""

from __future__ import annotations

import os
import sys
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CodeHook(BuildHookInterface):
    """Adds the archive; the wheel is for one version of Python on Linux then."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the archive to what is built."""
        if code := os.environ.get("EDL6DOF_CODE"):
            python = f"cp{sys.version_info.major}{sys.version_info.minor}"
            build_data["force_include"][code] = "edl6dof/kernels/code.tar.xz"
            build_data["pure_python"] = False
            build_data["tag"] = f"{python}-{python}-manylinux_2_28_x86_64"
