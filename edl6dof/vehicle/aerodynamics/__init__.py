"""Aerodynamics of the vehicle: entry capsule, bluff body after a jettison, bodies of any shape, surfaces."""
