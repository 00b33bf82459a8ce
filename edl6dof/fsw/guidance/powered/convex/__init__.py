"""Convex optimal powered guidance: the fuel-optimal landing, solved in flight by a
projected-gradient method.
"""
