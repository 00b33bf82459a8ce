"""Convex optimal powered guidance: the fuel-optimal landing, solved in flight by projections alone."""
