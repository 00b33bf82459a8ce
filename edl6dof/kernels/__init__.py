"""Compiled functions: the decorator, and the folders that keep their machine code."""

from edl6dof.kernels.jit import inlined_kernel, kernel

__all__ = ["inlined_kernel", "kernel"]
