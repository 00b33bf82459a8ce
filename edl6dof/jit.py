"""See :mod:`edl6dof.kernels`."""

from edl6dof.kernels.jit import inlined_kernel, kernel

__all__ = ["inlined_kernel", "kernel"]
