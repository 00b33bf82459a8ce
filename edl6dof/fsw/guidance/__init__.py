"""Guidance: what the vehicle should do next, as bank angle or as thrust vector.

Entry laws and powered laws are families; see :mod:`edl6dof.fsw.guidance.entry` and
:mod:`edl6dof.fsw.guidance.powered`.
"""
