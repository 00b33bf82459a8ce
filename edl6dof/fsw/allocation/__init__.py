"""Thruster allocation: duties for a demanded force and torque, and what stays unallocated."""
