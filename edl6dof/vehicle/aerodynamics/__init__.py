"""Aerodynamics of the vehicle: the entry capsule, what is left after jettisons, simple bodies, surfaces."""
