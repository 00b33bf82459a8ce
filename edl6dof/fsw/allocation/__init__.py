"""Thruster allocation: duties for a demanded force and torque, and the part of the demand that stays
unallocated.
"""
