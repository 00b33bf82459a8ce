"""Attitude control: from attitude error to demanded torque.  The controllers are a family, see
``registry``.
"""
